// Context of reading a file: its problems, and the resulting scene. Private to importers: for mesh
// files and robot descriptions.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "geometry/tessellate/polygon.h"
#include "importers/import.h"
#include "importers/internal/input_file.h"
#include "importers/internal/lost.h"
#include "importers/internal/named_file.h"

namespace panwright::importers::meshes {

inline constexpr std::uint32_t kNoIndex = 0xffffffffu;

// Inputs of a reading, and problems of the file. Each kind of problem is reported once, at its
// first place, with its count.
class ReaderContext {
 public:
  // text: places are lines and columns; else messages must give the byte
  ReaderContext(Files& files, const InputFile& file, const Options& options, bool text,
                DiagnosticLog& log);

  Files& files;
  const InputFile& file;
  const Options& options;
  DiagnosticLog& log;
  std::vector<scene::Input> inputs;  // files beside the model
  Code tolerated = Code("W6502");    // code of deviations that are tolerated
  bool full = false;                 // a limit is reached: E6002 is reported, and nothing is added

  SourceSpan at(std::size_t begin, std::size_t end) const;
  SourceSpan at(std::string_view part) const;  // of the file's bytes; elsewhere: the whole file
  bool is_text() const { return text_; }

  // kind: a literal that names the problem. message: a function that gives the text, called once.
  template <class Message>
  void trouble(Code code, std::string_view kind, SourceSpan where, const Message& message) {
    const auto [place, is_new] = kinds_.try_emplace(kind, troubles_.size());
    if (is_new)
      troubles_.push_back({code, where, message(), 0});
    else
      ++troubles_[place->second].more;
  }
  void limit(const std::string& message, SourceSpan where);  // E6002
  // Counts bytes towards Limits::memory; false past it.
  bool charge(std::uint64_t bytes);

  // Releases the memory of the file's bytes before `offset`, which are no longer read.
  void served(std::size_t offset);

  void skipped(const std::string& what, std::uint64_t count = 1) { add(skipped_, what, count); }
  void lost(std::string_view what, SourceSpan where) { lost_.add(what, where); }

  // Reads a file named by the model, and counts it among its inputs. Nothing: reported, as E6010
  // for a part, else W6004, W6005. Another name than the written one is a tolerated deviation.
  std::optional<NamedFile> read_named(const FileName& name, SourceSpan where);
  // Reports the deviation of a file that was found.
  void accept(const NamedFile& found, SourceSpan where);
  void report_missing(const NamedFile& found, bool part, SourceSpan where);

  // Reports the collected problems: troubles, N6007, W6008.
  void tell();

 private:
  struct Trouble {
    Code code;
    SourceSpan where;
    std::string message;
    std::uint64_t more;
  };
  using Counts = std::map<std::string, std::uint64_t>;
  // Limits distinct entries: those past the first are counted together.
  static void add(Counts& counts, const std::string& what, std::uint64_t count);

  FileId source_;
  bool text_;
  std::map<std::string_view, std::size_t> kinds_;
  std::vector<Trouble> troubles_;
  Counts skipped_;
  LostProperties lost_;
  std::uint64_t memory_ = 0;
  std::uint32_t named_ = 0;  // files asked for
  std::size_t served_ = 0;
};

// Returns true if a place can be a vertex.
bool is_usable(const Vec3& p);

// Cutter of faces of any size.
class FaceCutter {
 public:
  // Appends the triangles of a face of three corners or more. Expects: indices in range.
  void cut(std::span<const std::uint32_t> face, const std::vector<Vec3>& positions,
           std::vector<geometry::Triangle>& triangles);

 private:
  geometry::PolygonCutter cutter_;
  std::vector<Vec3> outline_;
  std::vector<geometry::Triangle> cut_;
};

// Removes unused vertices; others keep their order.
void drop_unused(geometry::Mesh& mesh);

// Normalises the file's normals; one without length or not finite becomes that of its faces. A mesh
// without normals gets them by crease angle.
void finish_normals(geometry::Mesh& mesh, double crease_angle);

// Welder of vertices at exactly equal positions.
class Welder {
 public:
  std::uint32_t vertex(const Vec3& p, std::vector<Vec3>& positions);
  void clear();

 private:
  void grow(const std::vector<Vec3>& positions);
  std::vector<std::uint32_t> slots_;  // a power of two; kNoIndex: free
  std::size_t used_ = 0;
};

// Scene of a mesh file, under construction.
class Assembly {
 public:
  Assembly(ReaderContext& context, Format format);

  // Adds a node, unnamed ones by kind and number. kNone past the limit.
  std::int32_t add_node(std::int32_t parent, std::string_view name, std::string_view kind,
                        SourceSpan where);
  // Returns true if further triangles are within the limit; else E6002.
  bool has_room_for(std::uint64_t triangles, SourceSpan where);
  void add_part(std::int32_t node, geometry::Mesh mesh, std::int32_t material, SourceSpan where);
  std::int32_t add_material(materials::Material material, CadMaterial cad);
  // Returns the default material; white if the vertices have colours.
  std::int32_t plain_material(bool colored);

  // Reads a texture, once for each way of decoding; kNone if unusable: W6004, W6005.
  std::int32_t texture(const FileName& name, bool linear, SourceSpan where);

  scene::Source source_of(SourceSpan where);

  // The result so far, for additions beyond the functions above.
  Imported& out() { return out_; }

  // Reports all problems and returns the result. Fails: E6501 without any triangle.
  Result<Imported> finished();

 private:
  ReaderContext& context_;
  Imported out_;
  std::map<std::string, std::uint32_t, std::less<>> kinds_;
  std::array<std::int32_t, 2> plain_{scene::kNone, scene::kNone};
  std::map<std::pair<std::string, bool>, std::int32_t> texture_cache_;  // by name as written
  std::uint64_t triangles_ = 0;
  std::uint64_t texture_bytes_ = 0;
};

}  // namespace panwright::importers::meshes
