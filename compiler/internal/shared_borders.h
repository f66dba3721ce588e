// Borders shared by meshes of different instances, which simplification and rounding must not move.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "base/job.h"
#include "base/math.h"
#include "geometry/mesh.h"
#include "pan/writer.h"

namespace panwright::compiler::internal {

// View of a mesh, which must outlive it.
struct Surface {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::function<Vec3(std::size_t)> position;  // metres, in its frame
  std::function<geometry::Triangle(std::size_t)> triangle;
};
Surface surface_of(const geometry::Mesh& mesh);
Surface surface_of(const pan::PackedMesh& mesh);

// Returns for each vertex the first one at its position.
std::vector<std::uint32_t> first_at_place(const Surface& mesh);

// A mesh placed by an instance: its own, or one of its levels.
struct PlacedSurface {
  std::uint32_t mesh = 0;
  std::uint32_t instance = 0;
};

// Vertices to compare.
enum class Compared { borders, all };

// Marks for each mesh (V) the vertices on an open border shared with another instance, to some 1e-6
// of the model's diagonal; with `all`, the vertices on those of another instance. Nothing: more
// than 16 million vertices to compare, instances counted.
//
//   world  world_from_mesh of each instance
// Cost: O(V log V) of the meshes, O(placed vertices).
std::optional<std::vector<std::vector<char>>> shared_borders(
    const std::vector<Surface>& meshes, const std::vector<PlacedSurface>& placed,
    const std::vector<Mat4>& world, Compared compared, const Job& job);

}  // namespace panwright::compiler::internal
