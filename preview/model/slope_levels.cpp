#include "preview/model/slope_levels.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace panwright::preview {
namespace {

// what rounding leaves of the covariance of equal slopes, with room
constexpr double kVarianceRounding = 1e-24;

SlopeMoments moments_of(const float* normal) {
  SlopeMoments result;
  const double x = -static_cast<double>(normal[0]);
  const double y = -static_cast<double>(normal[1]);
  const double along = std::sqrt(x * x + y * y);
  // parts of a slope no longer than the steepest
  const double z = std::max(static_cast<double>(normal[2]), along / kSteepestSlope);
  if (z > 0) {
    result.x = x / z;
    result.y = y / z;
  }
  return result;
}

// One level below another. texel(x, y): the moments of a texel above
template <class Texel>
SlopeLevel below(std::uint32_t width, std::uint32_t height, const Texel& texel, const Job& job) {
  SlopeLevel level;
  level.width = std::max(1u, width / 2);
  level.height = std::max(1u, height / 2);
  level.texels.resize(std::size_t{level.width} * level.height);
  std::vector<Footprint> columns;
  for (std::uint32_t i = 0; i < level.width; ++i)
    columns.push_back(footprint(i, width, level.width));
  parallel_for(
      level.height,
      [&](std::size_t j) {
        const Footprint rows = footprint(static_cast<std::uint32_t>(j), height, level.height);
        for (std::size_t i = 0; i < level.width; ++i) {
          const auto each = [&](auto&& add) {
            for (std::uint32_t y = 0; y < rows.count; ++y)
              for (std::uint32_t x = 0; x < columns[i].count; ++x)
                add(texel(columns[i].first + x, rows.first + y),
                    rows.share[y] * columns[i].share[x]);
          };
          SlopeMoments sum;
          each([&](const SlopeMoments& above, double share) {
            sum.x += share * above.x;
            sum.y += share * above.y;
          });
          each([&](const SlopeMoments& above, double share) {
            const double x = above.x - sum.x;
            const double y = above.y - sum.y;
            sum.xx += share * (above.xx + x * x);
            sum.xy += share * (above.xy + x * y);
            sum.yy += share * (above.yy + y * y);
          });
          if (sum.xx < kVarianceRounding) sum.xx = 0;
          if (sum.yy < kVarianceRounding) sum.yy = 0;
          const double most = std::sqrt(sum.xx * sum.yy);
          sum.xy = std::clamp(sum.xy, -most, most);
          level.texels[j * level.width + i] = sum;
        }
      },
      job);
  return level;
}

}  // namespace

std::vector<SlopeLevel> slope_levels(const TextureLevel& normals, const Job& job) {
  std::vector<SlopeLevel> levels;
  if (normals.width == 1 && normals.height == 1) return levels;
  levels.push_back(below(
      normals.width, normals.height,
      [&](std::size_t x, std::size_t y) {
        return moments_of(&normals.rgba[4 * (y * normals.width + x)]);
      },
      job));
  while (levels.back().width > 1 || levels.back().height > 1) {
    const SlopeLevel& above = levels.back();
    SlopeLevel next = below(
        above.width, above.height,
        [&](std::size_t x, std::size_t y) -> const SlopeMoments& {
          return above.texels[y * above.width + x];
        },
        job);
    levels.push_back(std::move(next));
  }
  return levels;
}

}  // namespace panwright::preview
