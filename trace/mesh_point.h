// Points of a pan's mesh: interpolation within a triangle, in double.
#pragma once

#include <array>
#include <cstdint>

#include "base/math.h"
#include "pan/model.h"

namespace panwright::trace {

// Place in a triangle.
struct Place {
  std::array<std::uint32_t, 3> corner{};  // vertices of the mesh
  Vec3 weight{0};                         // of the corners; they add up to 1
};

// Point of a mesh, in its own frame.
struct MeshPoint {
  Vec3 position;  // metres, relative to the mesh's origin
  Vec3 facet;     // the triangle's normal, unit
  Vec3 smooth;    // interpolated normal, any length; the facet if flat
};

// barycentric: weights of the second and third corner. Expects: a triangle of the mesh.
Place place_of(const pan::MeshView& mesh, std::uint32_t triangle, const Vec2& barycentric);
MeshPoint point_of(const pan::MeshView& mesh, const Place& place, bool flat);
// Expects: a mesh with texture coordinates.
Vec2 texcoord_of(const pan::MeshView& mesh, const Place& place);

// Returns a vector of length 1; `otherwise` for 0 and what is not finite.
Vec3 unit_or(const Vec3& v, const Vec3& otherwise);

}  // namespace panwright::trace
