// What the importers and panwright-step, the program that holds OpenCASCADE, say to each other.
//
// Request:  kRequestMark, a head (lengths, limits, names), the bytes of the file.
// Answer:   kAnswerMark, then records: kind (u32), size (u64), so many bytes. Diagnostics come as
// they
//           are found, the scene in pieces, at last one `end`. Whatever follows is not read.
// Both programs run on one machine and come from one build: numbers are as they lie in memory. The
// answer is not trusted: OpenCASCADE may have written anywhere in the memory that it comes from.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "importers/import.h"

namespace panwright::importers::step {

inline constexpr std::string_view kRequestMark = "PWSTEPQ1";
inline constexpr std::string_view kAnswerMark = "PWSTEPA1";
// The exit code of a reader whose memory ran out.
inline constexpr int kOutOfMemory = 3;

class Values;

// The material that name, colour and opacity become; what it does not have is noted in `lost`.
materials::Material lambert_of(CadMaterial& cad);

// ---- request

struct Request {
  std::string path;  // of the file, for the sources of nodes
  std::string name;  // as the user would type it
  Limits limits;
  double deflection = 0;
  std::uint64_t bytes = 0;  // of the file, which follow
};

std::string request_head(const Request& request);

// The request at the beginning of `bytes`, which then stand behind it. Nothing for another one.
std::optional<Request> request_from(std::string_view& bytes);

// ---- answer

// Takes bytes towards the program that asked. False: nobody listens any more.
using Send = std::function<bool(std::string_view)>;

// Sends the entries of a log from the `first` on. Returns their number in all.
std::size_t send_diagnostics(const DiagnosticLog& log, std::size_t first, const Send& send);

// Sends a scene that read_in_process() made: of its materials name, colour and opacity.
void send_scene(const Imported& imported, const Send& send);

// complete: a scene was sent.
void send_end(bool complete, const Send& send);

// Puts an answer together, and checks every part of it.
class AnswerReader {
 public:
  enum class State { open, complete, damaged };

  // file: of the log, which places point into; bytes: its length
  AnswerReader(const Request& request, FileId file, DiagnosticLog& log)
      : request_(request), file_(file), log_(log) {
    out_.format = Format::step;
    out_.in_metres = true;
  }

  // Takes the bytes that came next; reports the diagnostics among them.
  // Cost: O(bytes); memory of the scene and one record.
  State take(std::string_view bytes);

  State state() const { return state_; }
  const std::string& damage() const { return damage_; }  // what is wrong, where damaged

  // The scene; nothing where the answer has none. Expects: complete.
  std::optional<Imported> finished();

 private:
  State damaged(std::string what);
  bool take_record(std::uint32_t kind, std::string_view payload);
  bool take_diagnostic(Values& record);
  bool take_nodes(Values& record);
  bool take_shape(Values& record);
  bool take_mesh(Values& record);
  bool take_materials(Values& record);
  bool take_instances(Values& record);

  const Request& request_;
  const FileId file_;
  DiagnosticLog& log_;
  Imported out_;
  std::string waiting_;  // bytes of a record that is not whole
  std::string damage_;
  std::uint64_t taken_ = 0;  // bytes
  std::uint64_t triangles_ = 0;
  State state_ = State::open;
  bool begun_ = false;
  bool has_scene_ = false;
};

}  // namespace panwright::importers::step
