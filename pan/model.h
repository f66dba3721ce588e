// Compiled model: a pan file, mapped, checked, and read without copies.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/axis_box.h"
#include "base/diagnostic.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/job.h"
#include "base/math.h"
#include "base/result.h"
#include "geometry/kinematics/joint.h"
#include "materials/material.h"
#include "pan/generated/tables.h"
#include "schemas/generated/pan_layout.h"

namespace panwright::pan {

// Indices of one mesh, as stored. One of the two spans is empty.
struct Indices {
  std::span<const std::uint16_t> shorts;  // 3*T, or empty
  std::span<const std::uint32_t> longs;   // 3*T, or empty

  std::size_t size() const { return shorts.empty() ? longs.size() : shorts.size(); }
  std::uint32_t operator[](std::size_t i) const { return shorts.empty() ? longs[i] : shorts[i]; }
};

// Runs of one mesh in the big arrays.
struct MeshView {
  std::span<const layout::Float3> positions;  // V, metres, relative to the mesh's origin
  std::span<const layout::Float3> normals;    // V unit vectors
  std::span<const layout::Float2> texcoords;  // V, or empty
  std::span<const layout::Float3> colors;     // V linear RGB, or empty
  Indices indices;                            // 3*T, each < V
};

namespace internal {
struct Unpacked;
}

// A pan file in memory. Guarantees:
//
//   after open()   the header and the directory are sound: every span that takes no index has
//                  whole, aligned elements. Their contents are any bytes.
//   after check()  every rule of docs/pan-format.md holds: indices, offsets, numbers and strings
//                  need no further checks, and every function below is safe.
//
// Sections in this program's own layout are read in place. Compressed ones, and those with records
// of another size, are empty after open(): check() unpacks them into the model's own memory,
// bounded by 256 times the file and by kMaxUnpackedBytes. Mapped files of over a GiB are checked
// part by part, and each part's memory is given back.
//
// The spans live as long as the model; moving the model does not move them. After check() a model
// never changes: its const functions hold no hidden state and are thread-safe, and owners share it
// as std::shared_ptr<const Model>. The file may be renamed, replaced or deleted meanwhile.
class Model : public ModelTables {
 public:
  // Maps a file and reads its header and directory. Only those pages are touched.
  //
  // Fails: E0101, E0102, E4001 to E4008, E4012, E4015. Cost: O(sections), whatever the size of
  // the file.
  // note: a file that another program cuts short while it is mapped ends the process with SIGBUS,
  // as for any mapping; Panwright's writers replace files by rename and never do so. Use read()
  // for files that others write in place.
  static Result<Model> open(const std::filesystem::path& path, DiagnosticLog& log);

  // The same from a copy in memory. max_bytes: limit of the file's size, and of its decompressed
  // sections.
  //
  // Fails: also E0104.
  static Result<Model> read(const std::filesystem::path& path, std::uint64_t max_bytes,
                            DiagnosticLog& log);

  // The same from bytes, which are copied, or kept. name: the file name in diagnostics.
  static Result<Model> from_bytes(std::span<const std::byte> bytes, std::string name,
                                  DiagnosticLog& log);
  static Result<Model> from_bytes(std::vector<std::byte>&& bytes, std::string name,
                                  DiagnosticLog& log);

  // The same from a mapping. name: the file name in diagnostics.
  static Result<Model> from_mapping(MappedFile file, std::string name, DiagnosticLog& log);

  // Calls open() and check().
  static Result<Model> load(const std::filesystem::path& path, DiagnosticLog& log,
                            const Job& job = {});

  Model(Model&&) noexcept = default;
  Model& operator=(Model&&) noexcept = default;

  // Checks every byte: checksums, then every rule of docs/pan-format.md. Reports the first problem
  // of each kind in each section; the choice does not depend on the number of threads. Compressed
  // sections are unpacked when their checksum is right. A second call checks anew, and spans stay
  // where they are unless it fails.
  //
  //   left     kind of a section whose bytes are not read, as their reader checks them piece by
  //            piece: terrain::kTilesSection; 0: none
  //   returns  true if the file is valid
  // Fails: E0001, E4008 to E4015. Cost: one pass over the file, and over the unpacked bytes.
  bool check(DiagnosticLog& log, const Job& job = {}, std::uint32_t left = 0);

  const std::string& name() const { return name_; }
  std::span<const std::byte> bytes() const { return bytes_; }
  const layout::Header& header() const;
  std::span<const layout::DirectoryEntry> directory() const;  // sections of unknown kinds included
  const layout::DirectoryEntry* entry(layout::SectionKind kind) const;  // null: absent
  // Gives back the memory of a part that has been read, where the file is mapped and over a GiB:
  // its pages are read again when they are used again.
  void release(std::span<const std::byte> part) const;
  // Bytes allocated by check() for compressed sections and records of other sizes.
  std::uint64_t unpacked_bytes() const { return unpacked_bytes_; }
  // Returns true if this program reads a section of the directory.
  bool reads(const layout::DirectoryEntry& entry) const;
  bool compressed() const;  // true if any section is
  Hash128 build_id() const;

  std::span<const std::byte> stream_bytes() const;
  std::span<const layout::Float3> positions() const;
  std::span<const layout::Float3> normals() const;
  std::span<const layout::Float2> texcoords() const;
  std::span<const layout::Float3> colors() const;
  std::span<const std::byte> index_bytes() const;
  std::span<const std::byte> texel_bytes() const;
  std::span<const std::uint32_t> string_offsets() const;  // strings + 1
  std::span<const char> string_bytes() const;

  // Expects, all of these: checked(), and indices below their count.
  using ModelTables::levels;
  std::span<const layout::Level> levels(std::uint32_t instance) const;  // from the finest
  // Returns the material of an instance's back; −1: both sides are alike.
  std::int32_t back_of(std::uint32_t instance) const;
  // Places of a mesh's runs in the arrays; the records hold their low 32 bits.
  std::uint64_t first_vertex(std::size_t mesh) const;
  std::uint64_t first_texcoord(std::size_t mesh) const;
  std::uint64_t first_color(std::size_t mesh) const;
  MeshView mesh(std::size_t index) const;
  std::span<const std::uint8_t> texels(std::size_t texture) const;     // 4*W*H, row 0 the top row
  std::optional<std::size_t> find_frame(std::string_view name) const;  // the first of that name
  std::optional<std::size_t> find_joint(std::string_view name) const;
  std::string_view version() const;  // of the program that made the file
  std::string_view options() const;

  // "root/body/dish": the names from the root; a node without a name is shown as its [index].
  std::string node_path(std::size_t index) const;

  // Joints in the form of geometry/kinematics, and their initial values: within limits, followers
  // resolved.
  geometry::JointSet joint_set() const;
  std::vector<geometry::JointValues> initial_values() const;

  // World matrices with all joints at their initial values, one per node, root first; all finite.
  std::vector<Mat4> world_from_nodes() const;
  // world_from_node times node_from_frame.
  Mat4 world_from_frame(std::size_t index) const;

  // The axis-aligned box of all instances in world axes, from their transformed vertices; nothing
  // without instances. Cost: O(vertices, instances counted).
  std::optional<AxisBox> world_bounds() const;

 private:
  friend struct internal::Unpacked;
  Model() = default;
  bool parse(DiagnosticLog& log);
  bool take_section(const layout::DirectoryEntry& found, std::uint32_t number, DiagnosticLog& log);
  bool streams_fit(DiagnosticLog& log);
  void find_places();

  std::string name_;
  std::optional<MappedFile> mapped_;
  std::vector<std::byte> owned_;
  std::span<const std::byte> bytes_;
  std::array<std::uint32_t, layout::kLastKind + 1> entry_of_kind_{};  // 1-based; 0: absent
  std::array<std::unique_ptr<std::byte[]>, layout::kLastKind + 1> unpacked_;
  std::uint64_t unpacked_bytes_ = 0;
  struct Places {
    std::uint64_t vertex, texcoord, color;
  };
  std::vector<Places> places_;  // of the runs of meshes, with long runs
};

// Converts a stored material to parameters in double.
materials::Material material_from(const layout::Material& record, std::string_view name);
// The record of a material, rounded to float. The name is a string id.
layout::Material record_from(const materials::Material& material, std::uint32_t name);

// Returns the name of a section's kind: "positions", "tiles", "kind 1000".
std::string kind_name(std::uint32_t kind);

// Returns a value's name in the format: "flux", "pixels"….
std::string_view reason_name(layout::ToleranceReason reason);

geometry::Joint kinematic(const layout::Joint& joint);

// Node, frame and decal matrices. parent_from_node: with its joints at rest.
Mat4 parent_from_node(const layout::Node& node);
Mat4 node_from_frame(const layout::Frame& frame);
Mat4 mesh_from_decal(const layout::Decal& decal);

}  // namespace panwright::pan
