// Standard errors of pixels, from their own batches and those around. Private to preview/reference.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/job.h"
#include "preview/reference/internal/cells.h"
#include "preview/reference/internal/running_statistics.h"

namespace panwright::preview::reference {

// Estimates standard errors. A pixel's own samples miss rare contributions: an edge, a gap between
// cells, a bright path not yet sampled. So the variance of its mean is the larger of its batches'
// and of a mixture with its neighbours':
//
//   max(own, 0.35 own + 0.2 line + 0.02 ring + 0.42 √(side·wide) +
//            (0.09 near + 0.02 wide) (1 + 3 discord) 3/√N)
//
//   own   of the pixel's batches
//   line  the largest, over four directions, of the smaller one of both neighbours: edges and
//         struts go on
//   ring  the smallest, over eight directions, of the largest among the five neighbours not behind
//   side  the smallest, over four directions, of the mean of 7 × 4 pixels that are not behind
//   near, wide   means of 3 × 3 and of 7 × 7 pixels without the one in the middle; wide and side of
//         those that have light
//   N     samples of a pixel
//   discord   from 0 to 1, s²/(s² + (0.3 mean)²) of the variance s² of a sample: the disagreement
//             of the pixel's samples; 1 where all are black
//
// In a clean surface beside a clean edge line, ring and side are small: the edge's variance is not
// its own. The last two terms cover features seen only in adjacent pixels; they shrink with more
// samples. Pixels with nothing around them have Student's width; no error is below the rounding to
// float.
//
// The weights are the smallest that keep 99 % of pixels within three errors on the scenes of
// panwright-bench error_bars. They are relative to variances of means, so they hold for any unit
// and any number of batches.
//
//   cells       by rows, from the left
//   statistics  one per cell
//   batches     >= 4; each has batch_samples in every cell
//
// returns one error per cell, RGB. Cost: O(cells), some hundred operations each.
std::vector<Vec3> pixel_errors(std::span<const Cell> cells, const RunningStatistics& statistics,
                               std::uint32_t batches, std::uint32_t batch_samples, const Job& job);

}  // namespace panwright::preview::reference
