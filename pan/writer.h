// Writer of pan files: whole models, and the stream of sections below them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "base/diagnostic.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/job.h"
#include "base/math.h"
#include "base/result.h"
#include "geometry/kinematics/joint.h"
#include "geometry/mesh.h"
#include "materials/material.h"
#include "pan/generated/tables.h"
#include "schemas/generated/pan_layout.h"

namespace panwright::pan {

// ---- whole models

// A mesh rounded to float about a double origin.
struct PackedMesh {
  std::string name;
  Vec3 origin{0};                      // metres, added to every position
  double error = 0;                    // metres: tessellation and rounding together
  bool closed = false;                 //
  std::vector<float> positions;        // 3*V, relative to origin
  std::vector<float> normals;          // 3*V, unit
  std::vector<float> texcoords;        // 2*V, or empty
  std::vector<float> colors;           // 3*V, or empty
  std::vector<std::uint32_t> indices;  // 3*T, each < V; stored in 2 bytes where V <= 65535
  // Storage of positions, normals and indices, if storage.h has made a stream of them. Of all
  // meshes of a file, or of none.
  layout::MeshStream stream{};
  std::vector<std::byte> stream_bytes;

  std::size_t vertex_count() const { return positions.size() / 3; }
  std::size_t triangle_count() const { return indices.size() / 3; }
};

struct InstanceContent {
  std::uint32_t node = 0;
  std::uint32_t mesh = 0;
  std::uint32_t material = 0;
  std::int32_t texture = -1;  // -1: none
  std::int32_t back = -1;     // material of the back; -1: both sides are alike
};

struct TextureContent {
  std::string name;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  bool linear = false;
  std::span<const std::uint8_t> rgba;  // 4*W*H, row 0 the top row; not owned
};

// Joint, as in the format.
struct JointContent {
  std::string name;  // unique
  std::uint32_t node = 0;
  geometry::Joint joint;
  geometry::JointValues value{};  // initial, within the limits
  std::optional<Vec3> pointing;   // in the node's coordinates, unit
  std::int32_t gimbal = -1;       // outer joint that aims together with this one
  bool points_at_sun = false;
};

// A model from the compiler: also the tables of pan/generated/tables.h.
struct Contents : TableContents {
  std::string version;                         // "panwright 0.1.0"
  std::string options;                         // "max_error=0.001 …", a fixed order
  std::vector<PackedMesh> meshes;              //
  std::vector<InstanceContent> instances;      //
  std::vector<materials::Material> materials;  //
  std::vector<TextureContent> textures;        //
  std::vector<JointContent> joints;            // by node
};

// Rounds a mesh to float about the centre of its bounds. The error of the result holds the
// mesh's own and the largest distance that rounding moved a vertex.
//
// Expects: at least one triangle; normals for every vertex; finite numbers; no extent over 1e38 m.
// Cost: O(vertices + triangles). Calls on different meshes may run in parallel.
PackedMesh packed(const geometry::Mesh& mesh, std::string name);
// The same, consuming the mesh: each of its arrays is freed once it is rounded.
PackedMesh packed(geometry::Mesh&& mesh, std::string name);

// Hash of the inputs of a file (docs/pan-format.md, Build identity).
Hash128 build_identity(std::span<const InputContent> inputs, std::string_view version,
                       std::string_view options);

struct WriteReport {
  std::uint64_t bytes = 0;
  double seconds_sync = 0;
};

struct WriteOptions {
  // Compresses sections that shrink by at least an eighth. Readers of format 1.0 refuse such a
  // file; ours unpack it in check().
  bool compress = false;
};

// Writes a model atomically ("-": to standard output). Equal contents and options give equal
// bytes, whatever the number of threads; the build identity does not depend on the options.
//
// Expects: contents as documented above and as scene::check ensures.
// Fails: E0001; E0103, also for counts that the format does not hold; for other contents the codes
// of Model::check(). Writes no file that readers
// refuse; an old one stays. Cost: O(bytes); memory of one block beyond the contents; with
// compression, of one section, plain and packed.
Result<WriteReport> write(const Contents& contents, const std::filesystem::path& path,
                          DiagnosticLog& log, const WriteOptions& options = {},
                          const Job& job = {});
// The same, consuming the contents: written meshes free their memory, so that the file is checked
// without them.
Result<WriteReport> write(Contents&& contents, const std::filesystem::path& path,
                          DiagnosticLog& log, const WriteOptions& options = {},
                          const Job& job = {});

// Meshes that are made one after the other, for models larger than memory.
struct MeshProducer {
  struct Shape {
    std::uint64_t vertices = 0;
    std::uint64_t triangles = 0;
    bool texcoords = false;
    bool colors = false;
  };
  std::vector<Shape> shapes;  // of all of them, before the first is made
  // Fills mesh i, whose arrays may hold those of the one before. Called for 0, 1, 2…; false: it
  // broke off.
  std::function<bool(std::size_t i, PackedMesh& mesh)> make;
};

// Writes a model with meshes from a producer, in the memory of one mesh and a few blocks. The
// arrays come first in the file, the tables behind them; nothing is compressed.
//
// Expects: contents as above, without meshes; those that are made are as PackedMesh says, without
// streams.
// Fails: as write(); E0103 also for a mesh of another shape, and a producer that breaks off.
Result<WriteReport> write(const Contents& contents, const MeshProducer& producer,
                          const std::filesystem::path& path, DiagnosticLog& log,
                          const Job& job = {});

// The same bytes as write(), in memory.
//
// Expects: counts that the format holds.
std::vector<std::byte> write_to_memory(const Contents& contents, const WriteOptions& options = {});
std::vector<std::byte> write_to_memory(Contents&& contents, const WriteOptions& options = {});

// ---- sections

// Numbers of texts: 0 is the empty one, then the order of first use. A table is full once a text
// would take it over its most bytes; the numbers of such texts are 0.
class StringTable {
 public:
  // most: by default as far as offsets of 32 bits go
  explicit StringTable(std::uint32_t most = 0xffffffffu) : most_(most) { id(""); }
  std::uint32_t id(std::string_view text);
  std::span<const std::uint32_t> offsets() const { return offsets_; }  // strings + 1
  std::string_view bytes() const { return bytes_; }
  bool full() const { return full_; }

 private:
  std::unordered_map<std::string, std::uint32_t> ids_;
  std::vector<std::uint32_t> offsets_{0};
  std::string bytes_;
  std::uint32_t most_;
  bool full_ = false;
};

// Stream of sections into a file, hashed on the way; the directory and the header follow. Nothing
// appears under the file's name before finish(), and nothing is left without it.
//
// After a failed, reported call, all calls do nothing and return false.
class Writer {
 public:
  // Fails: E0103.
  static Result<Writer> create(const std::filesystem::path& path, DiagnosticLog& log,
                               const WriteOptions& options = {});
  // expected: bytes for which memory is set aside
  static Writer in_memory(const WriteOptions& options = {}, std::size_t expected = 0);

  Writer(Writer&&) noexcept;
  ~Writer();

  // Opens a section, appends to it, and closes it. kind and version may be any; optional marks a
  // section that readers may ignore. stride: bytes of an element.
  //
  // Expects: sections one after the other; whole elements. Fails: E0103.
  bool begin(std::uint32_t kind, std::uint32_t stride, bool optional, DiagnosticLog& log);
  bool append(std::span<const std::byte> bytes, DiagnosticLog& log);
  bool end(DiagnosticLog& log);

  // Writes a section of a known kind in one call.
  bool section(layout::SectionKind kind, std::span<const std::byte> bytes, DiagnosticLog& log);

  // Sets a section of a known kind aside, `count` elements long; fill() appends to it while others
  // are filled or open. It is stored as it is, with compression too.
  //
  // Fails: E0103, also where the disk has no room for it. Memory: a block a section.
  bool reserve(layout::SectionKind kind, std::uint64_t count, DiagnosticLog& log);
  // Expects: whole elements, no more than are left.
  bool fill(layout::SectionKind kind, std::span<const std::byte> bytes, DiagnosticLog& log);

  // Declares a section derived from other sections: count elements, no bytes.
  bool derived(layout::SectionKind kind, std::uint64_t count, DiagnosticLog& log);

  // Adds `features` (layout::kFeature…) to those that readers need, besides those of compression
  // and of records of other sizes.
  //
  // Expects: known features; before finish().
  void require(std::uint64_t features);

  // Writes the directory, then the header with the complete mark, syncs and renames. The minor
  // version is the lowest that has all written features.
  //
  // sync_seconds: increased by the time of fsync, when given. check: runs Model::check() before the
  // file takes its name, when given.
  //
  // Fails: E0103, also for a reserved section that is not full; with check, the codes of
  // Model::check(), and an old file stays.
  bool finish(Hash128 build_id, DiagnosticLog& log, double* sync_seconds = nullptr,
              const Job* check = nullptr);

  std::uint64_t bytes() const;       // written so far; of the file after finish()
  std::vector<std::byte> take() &&;  // the file. Expects: in_memory(), finish() returned true

 private:
  struct State;
  explicit Writer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace panwright::pan
