// Tangent frames for normal maps. Private to preview; nothing here needs OpenGL.
#pragma once

#include <cstdint>
#include <vector>

#include "pan/model.h"

namespace panwright::preview {

// Directions of u along a mesh's surface, at its vertices. Triangles with clockwise texture
// coordinates (a mirrored texture) and those with counter-clockwise ones never share a vertex:
// shared ones are repeated behind the mesh's own.
struct Tangents {
  std::vector<float> tangents;  // 4*(V+R): unit, perpendicular to the normal; w: +1, or −1 mirrored
  std::vector<std::uint32_t> repeats;  // R: the vertices repeated by V, V+1, …
  std::vector<std::uint32_t> indices;  // 3*T for the repeats; empty without any
};

// Computes tangents. A vertex takes the mean of its triangles' directions in its tangent plane,
// weighted by the angles there; vertices of one place, normal and texel, whole repeats of the
// texture apart, share theirs, so that a closed body has no seam. Triangles without an area in the
// texture have no direction; a vertex with only such triangles takes any direction in its plane. As
// Mikkelsen, "Simulation of wrinkled surfaces revisited", 2008, but for the seam.
//
// Expects: a mesh with texture coordinates. Cost: O(V log V + T).
Tangents tangents(const pan::MeshView& mesh);

}  // namespace panwright::preview
