// Storage forms of meshes: on a grid of few bits, and as streams of a codec.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "pan/writer.h"

namespace panwright::pan {

// Storage form, as of `--compress`.
struct StorageForm {
  enum class Kind {
    plain,     // sections as they are: floats
    lossless,  // sections compressed by WriteOptions::compress
    lossy,     // the same; meshes as streams of meshoptimizer's codecs
  };
  Kind kind = Kind::plain;
  std::uint32_t bits = 0;  // of a coordinate along the longest side of a mesh; 0: floats

  bool streams() const { return kind == Kind::lossy; }
};

inline constexpr std::uint32_t kLeastStorageBits = 8;
inline constexpr std::uint32_t kMostStorageBits = 24;

// Parses "none", "lossless", "lossy" (16 bits), "lossy:14". Nothing: another text.
std::optional<StorageForm> storage_form(std::string_view text);
std::string storage_name(const StorageForm& form);
// Texts accepted by storage_form(), for messages.
inline constexpr std::string_view kStorageForms =
    "none, lossless or lossy; lossy with 8 to 24 bits, as lossy:14";

// Returns the bits of each of the two octahedral codes of a normal, by those of a coordinate.
std::uint32_t normal_bits(std::uint32_t bits);

// Returns the fewest bits, at least `bits`, that move no vertex of a mesh further than `most`
// metres; 0: floats are needed.
std::uint32_t bits_within(const PackedMesh& mesh, std::uint32_t bits, double most);

// Moves positions to the nearest point of a grid of 2^bits - 1 steps along the longest side of the
// bounds. Moves normals to the nearest octahedral codes. The displacement is measured: mesh.stream
// holds it, and mesh.error grows by it. Equal positions stay equal.
//
//   exact  V, or empty: vertices whose positions stay as they are
// Cost: O(V).
void snap(PackedMesh& mesh, std::uint32_t bits, std::uint32_t normal_bits,
          std::span<const char> exact);
// Snaps the normals alone.
void snap_normals(PackedMesh& mesh, std::uint32_t normal_bits);

// Makes the stream of a mesh. Its triangles begin where the codec has them begin; numbers stay the
// same, off-grid ones too.
//
// Cost: O(V + T). Calls on different meshes may run in parallel.
void encode(PackedMesh& mesh);

}  // namespace panwright::pan
