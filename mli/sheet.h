// Sheets of foil: heights over a flat rectangle, made from a recipe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/job.h"
#include "base/result.h"
#include "mli/recipe.h"
#include "mli/statistics.h"

namespace panwright::mli {

struct Sheet {
  std::uint32_t columns = 0;  // of vertices: cells + 1
  std::uint32_t rows = 0;
  Vec2 spacing{0, 0};           // metres between columns, rows
  std::vector<double> heights;  // rows*columns, metres; row 0 at the lower edge, y = 0
  Statistics statistics;        // of these heights
  // Covariance of the facets' slopes of the recipe's own grid less that of these: the loss of
  // coarser detail.
  Covariance removed_slope_covariance;

  double at(std::uint32_t column, std::uint32_t row) const {
    return heights[std::size_t{row} * columns + column];
  }
};

struct SheetOptions {
  // Cells across the width; 0, or the recipe's xgrid and more: the recipe's.
  std::uint32_t cells = 0;
};

// Makes the sheet of a recipe. The same bits whatever compiler, optimisation and number of threads.
//
// Random numbers are Philox4x32-10, key (seed, index of the operation): other seeds give other
// sheets of the same distribution. Sheets of other detail are filtered(), always from the recipe's
// own grid, so that each is the same foil. Fails: E7001 for a recipe that check() refuses, or
// slope_rms of a level sheet; E0001. Cost: two copies of the recipe's own grid, 8 bytes a vertex
// each.
Result<Sheet> made(const Recipe& recipe, const SheetOptions& options, DiagnosticLog& log,
                   const RecipePlaces& places = {}, const Job& job = {});

// Returns a coarser sheet: the height at a vertex is the mean of the finer one over a box of a
// coarse cell; linear between vertices, mirrored at the edges. Rows keep the cells nearest to
// square. The mean height by area stays the same; statistics are recomputed, and the lost slopes
// added to the removed ones.
//
// Expects: cells > 0. With as many or more cells than the sheet's, returns it unchanged.
Sheet filtered(const Sheet& sheet, std::uint32_t cells, const Job& job = {});

// Returns a hash of the bits of numbers: for each of them as a word of 64 bits, FNV-1a's step, then
// the upper half folded onto the lower.
std::uint64_t checksum(std::span<const double> numbers);

}  // namespace panwright::mli
