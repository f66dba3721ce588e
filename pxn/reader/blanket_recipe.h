// Recipe of a blanket's sheets: operations, and the size of cells. Private to pxn.
#pragma once

#include <cstdint>
#include <vector>

#include "mli/wrap.h"
#include "pxn/reader/blankets.h"

namespace panwright::pxn {

// Triangles of a blanket per cell, an estimate: 2 and what faces are cut into at their borders.
inline constexpr double kPerCell = 2.4;

// Returns the operations of a sheet of a height, metres. Of a blanket that leaves its cells open,
// what is too fine for them is left out: slope_rms keeps the slopes that the others have.
std::vector<mli::Operation> operations_for(const Blanket& how, double height, double cell);

// Returns the recipe of a blanket's sheets. Expects: how outlives it.
mli::RecipeFor recipe_for(const Blanket& how, double cell, std::uint32_t seed);

// Returns the cells of a blanket, metres: the given ones; else the preset's, smaller on small
// shapes, larger where it would have too many triangles and its operations allow that.
//
//   least      what all blankets of the model together allow
//   coarsened  set to the cells if they are larger than the preset's
double cell_of(const Blanket& how, double diagonal, double area, double least, double& coarsened);

}  // namespace panwright::pxn
