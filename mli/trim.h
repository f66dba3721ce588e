// Trim of a sheet of foil: tape along its borders, and cut edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace panwright::mli {

// Visible part of a triangle of a sheet or a blanket.
enum class Cover : std::uint8_t { foil, tape, edge };
inline constexpr std::size_t kCovers = 3;

struct Trim {
  double tape = 0;       // metres from borders and joints; at most an eighth of the root of the
                         // sheet's area; 0: no tape
  double thickness = 0;  // metres of the stack of layers, visible at cuts; 0: no edge
};

// Trims a sheet in a form. Tape lies along the borders and joints, as of the sides of a tube;
// triangles are cut there. Edges go down from open borders, against the normal of the form, by the
// sheet's thickness; a box has none. Texture coordinates of edges continue beyond the sheet's, in
// metres.
//
//   mesh     of formed(), with normals and texture coordinates
//   surface  the same triangles without heights, with normals
//   returns  of the mesh's triangles
// Cost: O(vertices).
std::vector<Cover> trimmed(geometry::Mesh& mesh, const geometry::Mesh& surface, const Trim& trim);

// Returns the triangles of one kind, with their vertices.
geometry::Mesh part_of(const geometry::Mesh& mesh, std::span<const Cover> covers, Cover cover);

}  // namespace panwright::mli
