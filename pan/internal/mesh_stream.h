// Streams of meshes (docs/pan-format.md, Mesh streams).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/math.h"
#include "schemas/generated/pan_layout.h"

namespace panwright::pan::internal {

// Sizes of a mesh, from the tables.
struct StreamShape {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::uint32_t index_size = 2;
};

// Byte lengths of the three runs of a mesh; of indices with padding.
std::uint64_t index_run(const StreamShape& shape);
std::uint64_t streamed_bytes(const StreamShape& shape);

// Returns the coordinate of a code.
inline float position_of(double low, double step, std::uint32_t code) {
  return static_cast<float>(low + step * code);
}
// Decodes a unit vector from its two codes, and finds the codes nearest to it in their square.
void normal_of(std::uint32_t u, std::uint32_t v, std::uint32_t bits, float* to);
void codes_of(const float* normal, std::uint32_t bits, std::uint32_t* to);

// Output arrays of a decoded stream.
struct StreamTarget {
  float* positions;    // 3*V
  float* normals;      // 3*V
  std::byte* indices;  // index_run() bytes
};

// Decodes a stream. Any bytes are safe: allocations are bounded by the shape, and the result is
// false unless every index is within the mesh.
//
// Expects: a record within its rules, streamed_bytes() at most kMaxStreamed times the stream.
// Cost: O(V + T + bytes).
bool decode(const layout::MeshStream& record, const StreamShape& shape,
            std::span<const std::byte> stream, const StreamTarget& to);

struct StreamCodes {
  std::vector<std::uint32_t> positions;  // 3*V; empty: floats
  std::vector<std::uint32_t> normals;    // 2*V; empty: floats
};

// Decodes a Draco stream, which older programs wrote. False: damaged, or of another shape.
//
//   indices  3*T
bool draco_decoded(std::span<const std::byte> bytes, const StreamShape& shape, StreamCodes& to,
                   std::vector<std::uint32_t>& indices);

}  // namespace panwright::pan::internal
