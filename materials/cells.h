// Pattern of solar cells, on the CPU; shaders have the same text (materials/formulas/cells.glsl).
#pragma once

#include <array>
#include <string>

#include "materials/material.h"

namespace panwright::materials {

// Shares of a footprint; they add up to 1.
struct CellShares {
  double cell = 1;
  double finger = 0;  // grid lines, on the cell and under its cover glass
  double gap = 0;     // between cells, without cover glass
};

// Averages the pattern over a footprint, a box.
//
//   texcoord   of the middle
//   footprint  size of the box along u and v, in texture coordinates, >= 0
//   returns    exact for a box. A skewed footprint is replaced by its bounding box: the mean over
//              a panel stays, edges get up to twice as broad.
CellShares cells_at(const Cells& cells, const Vec2& texcoord, const Vec2& footprint);

// Returns the materials of the three parts: a cell, a grid line on it, and a gap. Mixed by their
// shares, they reproduce the pattern.
std::array<Material, 3> cell_parts(const Material& material);

// Returns the text as GLSL, as of glsl_formulas(), with `vec3 cell_shares(u, v, size_u, size_v,
// gap_u, gap_v, fingers, finger_width)` in units of the cells' pitches.
[[nodiscard]] std::string glsl_cells();

}  // namespace panwright::materials
