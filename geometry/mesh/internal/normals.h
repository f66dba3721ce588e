// Normals where it is known which vertices stand at one place.
#pragma once

#include <cstdint>
#include <span>

#include "geometry/mesh.h"

namespace panwright::geometry {

// As compute_normals() of geometry/mesh/strip.h; place: V, the first vertex at each one's place.
void compute_normals(Mesh& mesh, double crease_angle, std::span<const std::uint32_t> place);

}  // namespace panwright::geometry
