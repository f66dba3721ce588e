// Protocol between the importers and panwright-step, the program with OpenCASCADE.
//
// Request:  kRequestMark, a head (lengths, limits, names), the bytes of the file.
// Answer:   kAnswerMark, then records: kind (u32), size (u64), bytes. Diagnostics come as
//           they are found, the scene in pieces, finally one `end`. Later bytes are not read.
// Both programs run on one machine and come from one build: numbers are in native layout. The
// answer is untrusted: OpenCASCADE may have overwritten any memory of its sender.
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
// Exit code of a reader out of memory.
inline constexpr int kOutOfMemory = 3;

class Values;

// Returns the material for a name and colour.
materials::Material lambert_of(const CadMaterial& cad);

// ---- request

struct Request {
  std::string path;  // of the file, for the sources of nodes
  std::string name;  // for messages
  Limits limits;
  double deflection = 0;
  std::uint64_t bytes = 0;  // of the file, which follow
};

std::string request_head(const Request& request);

// Parses the request at the beginning of `bytes`, and removes it. Nothing if invalid.
std::optional<Request> request_from(std::string_view& bytes);

// ---- answer

// Sends bytes to the requesting program. False: the receiver is gone.
using Send = std::function<bool(std::string_view)>;

// Sends the entries of a log from the `first` on. Returns the total number.
std::size_t send_diagnostics(const DiagnosticLog& log, std::size_t first, const Send& send);

// Sends a scene of read_in_process(): of its materials name, colour and opacity.
void send_scene(const Imported& imported, const Send& send);

// complete: a scene was sent.
void send_end(bool complete, const Send& send);

// Reader of an answer, which checks every part of it.
class AnswerReader {
 public:
  enum class State { open, complete, damaged };

  // file: of the log, which places point into; bytes: its length
  AnswerReader(const Request& request, FileId file, DiagnosticLog& log)
      : request_(request), file_(file), log_(log) {
    out_.format = Format::step;
    out_.in_metres = true;
  }

  // Takes the next bytes; reports the diagnostics among them. Cost: O(bytes); memory of the scene
  // and one record.
  State take(std::string_view bytes);

  State state() const { return state_; }
  const std::string& damage() const { return damage_; }  // the problem, if damaged

  // Returns the scene; nothing if the answer has none. Expects: complete.
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
  std::string waiting_;  // bytes of an incomplete record
  std::string damage_;
  std::uint64_t taken_ = 0;  // bytes
  std::uint64_t triangles_ = 0;
  State state_ = State::open;
  bool begun_ = false;
  bool has_scene_ = false;
};

}  // namespace panwright::importers::step
