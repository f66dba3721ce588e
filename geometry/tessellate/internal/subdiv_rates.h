// How many segments the sides of a cage's cells need.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/tessellate/internal/subdiv_cells.h"

namespace panwright::geometry::internal {

// The deviation of one chord from a cell's surface along u and along v, and that of a diagonal for
// its twist: with n by m segments they are u/n², v/m² and twist/(n·m).
struct CellBend {
  double u = 0;
  double v = 0;
  double twist = 0;
};

// Measured by second differences. Cost: O(cells).
std::vector<CellBend> bends_of(const CellSurface& surface);

// The most segments of a side: at the depth of LimitSurface::kMaxDepth all their ends are on
// regular patches, but for the corners of cells.
inline constexpr std::uint32_t kMostSegments = 1024;

// Segments of each rail with which the bends, each cell's times its factor, stay within the
// tolerance: those cells with the fewest triangles that do, and the most that one of two cells at a
// rail asks for. Up to kMostSegments + 1, which is too many.
std::vector<std::uint32_t> rates_for(const Cells& cells, const std::vector<CellBend>& bends,
                                     const std::vector<double>& factors, double tolerance);

}  // namespace panwright::geometry::internal
