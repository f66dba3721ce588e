// Parallel maximum of many numbers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/parallel.h"

namespace panwright::geometry::internal {

// elements per task; small meshes stay on the calling thread
inline constexpr std::size_t kChunk = std::size_t{1} << 16;

// Returns the maximum of body(begin, end) over chunks of [0, count): the same whatever the threads.
template <class Body>
double maximum(std::size_t count, const Body& body) {
  std::vector<double> parts((count + kChunk - 1) / kChunk, 0.0);
  parallel_for(parts.size(), [&](std::size_t i) {
    parts[i] = body(i * kChunk, std::min(count, (i + 1) * kChunk));
  });
  double worst = 0;
  for (const double part : parts) worst = std::max(worst, part);
  return worst;
}

}  // namespace panwright::geometry::internal
