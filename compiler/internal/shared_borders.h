// Borders where the meshes of several instances meet.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/job.h"
#include "pan/writer.h"

namespace panwright::compiler::internal {

// A mesh at the place of an instance: its own, or that of a level of it.
struct PlacedMesh {
  std::uint32_t mesh = 0;
  std::uint32_t instance = 0;
};

// Which vertices are compared.
enum class Compared { borders, all };

// Of each mesh V: whether a vertex is on an open border that lies on one of another instance, to
// 1e-6 of the model's diagonal; of all: whether a vertex lies on one of another instance. Nothing:
// there are too many vertices to compare.
//
//   world  world_from_node of each instance
// Cost: O(V log V) of the meshes, O(placed vertices).
std::optional<std::vector<std::vector<char>>> shared_borders(
    const std::vector<pan::PackedMesh>& meshes, std::span<const PlacedMesh> placed,
    std::span<const Mat4> world, Compared compared, const Job& job);

}  // namespace panwright::compiler::internal
