// Texture coordinates by projection.
#pragma once

#include "geometry/mesh.h"

namespace panwright::geometry {

// Gives a mesh texture coordinates by longitude and latitude seen from the texture's origin:
// u = longitude/2π eastward from +x, in [0, 1); v = 1/2 + latitude/π, 0 at −z and 1 at +z.
//
//   mesh               texcoords are replaced; vertices are added, never moved or renumbered
//   texture_from_mesh  affine
//
// A triangle takes the smallest arc that holds its corners; if it crosses the meridian u = 0, the
// corners east of it get vertices of their own, with u + 1. A vertex on the axis has no longitude:
// each triangle gets its own, with the mean u of the other corners. Added vertices stand behind the
// others in order of first use. Expects: indices in range. Cost: O(V + T).
void apply_sphere_mapping(Mesh& mesh, const Mat4& texture_from_mesh);

// Gives a mesh texture coordinates as a Box has them, over the bounds of the mesh: each triangle
// takes the face that it looks at most (of equals x, then y, then z), seen upright from outside:
// for ±x and ±y with +z up, for ±z with +y up; 0 to 1 across the bounds.
//
//   mesh  texcoords are replaced; vertices are added, never moved or renumbered
//
// Added vertices stand behind the others in order of first use. Expects: indices in range.
// Cost: O(V + T).
void apply_box_mapping(Mesh& mesh);

}  // namespace panwright::geometry
