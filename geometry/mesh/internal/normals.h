// Normals of a mesh whose unique positions are known.
#pragma once

#include <cstdint>
#include <span>

#include "geometry/mesh.h"

namespace panwright::geometry {

// Computes normals as compute_normals() of geometry/mesh/strip.h; position_of: V, the first vertex
// at the same position.
void compute_normals(Mesh& mesh, double crease_angle, std::span<const std::uint32_t> position_of);

}  // namespace panwright::geometry
