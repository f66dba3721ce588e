// Streams of meshes (docs/pan-format.md, Mesh streams).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/math.h"
#include "schemas/generated/pan_layout.h"

namespace panwright::pan::internal {

// What the tables say of a mesh.
struct StreamShape {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::uint32_t index_size = 2;
};

// Bytes of the three runs of a mesh; of indices with padding.
std::uint64_t index_run(const StreamShape& shape);
std::uint64_t streamed_bytes(const StreamShape& shape);

// The float that a code of a coordinate stands for.
inline float position_of(double low, double step, std::uint32_t code) {
  return static_cast<float>(low + step * code);
}
// A unit vector by its two codes, and the codes that are nearest to it in their square.
void normal_of(std::uint32_t u, std::uint32_t v, std::uint32_t bits, float* to);
void codes_of(const float* normal, std::uint32_t bits, std::uint32_t* to);

// Where a stream is decoded to.
struct StreamTarget {
  float* positions;    // 3*V
  float* normals;      // 3*V
  std::byte* indices;  // index_run() bytes
};

// Decodes a stream. Any bytes are safe: what is allocated is bounded by the shape, and every index
// is one of the mesh or the result is false.
//
// Expects: a record within its rules, streamed_bytes() at most kMaxStreamed times the stream.
// Cost: O(V + T + bytes).
bool decode(const layout::MeshStream& record, const StreamShape& shape,
            std::span<const std::byte> stream, const StreamTarget& to);

// ---- Draco

struct DracoArrays {
  std::vector<std::uint32_t> positions;  // 3*V codes
  std::vector<std::uint32_t> normals;    // 2*V codes
  std::vector<std::uint32_t> ids;        // V, or empty
  std::vector<std::uint32_t> indices;    // 3*T
};

// Edgebreaker: triangles and vertices in another order. Nothing: the library refuses.
std::vector<std::byte> draco_encoded(const DracoArrays& arrays, bool edgebreaker);
// False: damaged, or of another shape.
bool draco_decoded(std::span<const std::byte> bytes, const StreamShape& shape, bool ids,
                   DracoArrays& to);

}  // namespace panwright::pan::internal
