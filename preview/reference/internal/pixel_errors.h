// The standard errors of pixels, from their own batches and those around. Private to
// preview/reference.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/job.h"
#include "preview/reference/internal/cells.h"
#include "preview/reference/internal/running_statistics.h"

namespace panwright::preview::reference {

// What a pixel's own samples tell of their error is too little where most agree and a rare one
// would not: an edge, a gap between cells, a bright path that none has met. So the variance of each
// mean is the larger of what its samples say and of a mixture with what those around it say:
//
//   u     variance of a pixel's mean, from its own batches
//   line  the largest, over four directions, of the smaller u of both neighbours: edges and struts
//         go on
//   ring  the smallest, over eight directions, of the largest u among the five neighbours that are
//         not behind: 0 beside a straight edge
//   side  the smallest, over four directions, of the mean u of 7 × 4 pixels that are not behind
//   near, wide   mean u of 3 × 3 and of 7 × 7 pixels, the pixel itself apart
//
//   max(u, 0.35 u + 0.22 line + 0.05 ring + 0.45 √(side·wide) + 3/√N (0.1 near + 0.02 wide))
//
// N: samples of a pixel. line, ring and side stay small in a clean surface beside a clean edge,
// whose variance is not its own; the last two terms are for what shows nowhere else, and count the
// less the more samples there are. Where all samples are black, what is around counts four times.
// Weights: measured on fifteen scenes (docs/reference-renderer.md). Pixels without neighbours have
// Student's width, others that of the rounding to float at least.
//
//   cells       by rows, from the left
//   statistics  one per cell
//   width, height   of the image that cells lie in; beyond it nothing is known
//   batches, batch_samples   each batch has batch_samples in every cell
//
// returns one per cell, of the channels.
// Cost: O(cells), some hundred operations each.
std::vector<Vec3> pixel_errors(std::span<const Cell> cells, const RunningStatistics& statistics,
                               std::uint32_t width, std::uint32_t height, std::uint32_t batches,
                               std::uint32_t batch_samples, const Job& job);

}  // namespace panwright::preview::reference
