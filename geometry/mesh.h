// Indexed triangle meshes in double precision.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/math.h"

namespace panwright::geometry {

using Triangle = std::array<std::uint32_t, 3>;

// Mesh in its own frame, metres. Triangles are counter-clockwise seen from outside.
struct Mesh {
  std::vector<Vec3> positions;      // V
  std::vector<Vec3> normals;        // V unit vectors, or empty
  std::vector<Vec2> texcoords;      // V, (0,0) the image's bottom left, or empty
  std::vector<Vec3> colors;         // V linear RGB that multiply the diffuse colour, or empty
  std::vector<Triangle> triangles;  // T, each index < V
  double error = 0;                 // metres: no point of the mesh lies further from the shape
  bool closed = false;              // every edge is shared by two triangles in opposite directions
};

}  // namespace panwright::geometry
