// Heights during the operations of a recipe.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/job.h"
#include "base/parallel.h"
#include "base/random.h"
#include "mli/recipe.h"

namespace panwright::mli {

struct Grid {
  std::size_t columns = 0, rows = 0;  // vertices
  double cell = 0;                    // metres
  std::uint32_t seed = 0;
  std::uint32_t index = 0;  // of the operation
  std::vector<double>* heights = nullptr;

  double* row(std::size_t j) const { return heights->data() + j * columns; }
  double width() const { return cell * static_cast<double>(columns - 1); }
  double height() const { return cell * static_cast<double>(rows - 1); }
  std::array<std::uint32_t, 4> words(std::uint32_t a, std::uint32_t b, std::uint32_t c = 0,
                                     std::uint32_t d = 0) const {
    return philox({a, b, c, d}, {seed, index});
  }
};

inline constexpr std::size_t kBand = 64;  // rows taken by a thread at once

// Calls body(first, end) for bands of rows.
template <class Body>
void for_bands(const Grid& grid, const Job& job, const Body& body) {
  parallel_for(
      (grid.rows + kBand - 1) / kBand,
      [&](std::size_t band) { body(band * kBand, std::min(grid.rows, (band + 1) * kBand)); }, job);
}

// Returns 3t² − 2t³, t clamped to [0, 1].
inline double smooth_step(double t) {
  t = std::min(1.0, std::max(0.0, t));
  return t * t * (3 - 2 * t);
}

void apply(const Random&, const Grid&, const Job&);
void apply(const Smooth&, const Grid&, const Job&);
void apply(const Constant&, const Grid&, const Job&);
void apply(const Taper&, const Grid&, const Job&);
void apply(const Wrinkle&, const Grid&, const Job&);
void apply(const Crease&, const Grid&, const Job&);
void apply(const Fractal&, const Grid&, const Job&);
void apply(const Emboss&, const Grid&, const Job&);
void apply(const Seam&, const Grid&, const Job&);
void apply(const Button&, const Grid&, const Job&);
void apply(const Crush&, const Grid&, const Job&);

}  // namespace panwright::mli
