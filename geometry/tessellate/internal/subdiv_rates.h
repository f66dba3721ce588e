// Segment counts of the sides of a cage's cells.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/tessellate/internal/subdiv_cells.h"

namespace panwright::geometry::internal {

// Deviation of one chord from a cell's surface along u and along v, and that of a diagonal for its
// twist: with n by m segments they are u/n², v/m² and twist/(n·m).
struct CellBend {
  double u = 0;
  double v = 0;
  double twist = 0;
};

// Measures bends by second differences. Cost: O(cells).
std::vector<CellBend> bends_of(const CellSurface& surface);

// Limit of segments of a side: at the depth of LimitSurface::kMaxDepth all their ends are on
// regular patches, except corners of cells.
inline constexpr std::uint32_t kMostSegments = 1024;

// Returns the segments of each rail that keep the bends, each cell's times its factor, within the
// tolerance. Cells take the fewest triangles, a rail the larger need of its two cells. Up to
// kMostSegments + 1, which is too many.
std::vector<std::uint32_t> rates_for(const Cells& cells, const std::vector<CellBend>& bends,
                                     const std::vector<double>& factors, double tolerance);

}  // namespace panwright::geometry::internal
