// What closes a sheet of foil: tape along its borders, and the edges where it is cut.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace panwright::mli {

// What a triangle of a sheet or a blanket shows.
enum class Cover : std::uint8_t { foil, tape, edge };
inline constexpr std::size_t kCovers = 3;

struct Trim {
  double tape = 0;       // metres from borders and joints; at most an eighth of the root of the
                         // sheet's area; 0: no tape
  double thickness = 0;  // metres of the stack of layers, seen where it is cut; 0: no edge
};

// Trims a sheet in a form. Tape lies along the borders, and along joints: where two places of the
// flat sheet meet, as the sides of a tube do; triangles are cut there. Edges go down from open
// borders, against the normal of the form, as far as the sheet is thick; a box has none. Texture
// coordinates of edges go on beyond the sheet's, in metres.
//
//   mesh     of formed(), with normals and texture coordinates
//   surface  the same triangles without heights, with normals
//   returns  of the mesh's triangles
// Cost: O(vertices).
std::vector<Cover> trimmed(geometry::Mesh& mesh, const geometry::Mesh& surface, const Trim& trim);

// The triangles of one kind, with the vertices that they use.
geometry::Mesh part_of(const geometry::Mesh& mesh, std::span<const Cover> covers, Cover cover);

}  // namespace panwright::mli
