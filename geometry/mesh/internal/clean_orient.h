// Orientation of the components of a mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/mesh/internal/edges.h"

namespace panwright::geometry {

struct Component {
  std::uint32_t first = 0;  // its first triangle
  std::uint64_t triangles = 0;
  bool closed = true;         // every side has a twin
  bool one_sided = false;     // its windings contradict each other
  std::uint64_t flipped = 0;  // triangles to flip
  double area = 0;            // m²
};

struct Orientation {
  std::vector<std::uint32_t> component_of;  // T
  std::vector<Component> components;        // in order of their first triangles
  std::vector<char> flip;                   // T: true for each triangle to flip
};

// See clean().
Orientation orientation_of(const Mesh& mesh, std::span<const std::uint32_t> unique_position,
                           const Edges& edges);

}  // namespace panwright::geometry
