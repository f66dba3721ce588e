#include "preview/model/map_levels.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/parallel.h"
#include "preview/model/slope_levels.h"

namespace panwright::preview {
namespace {

// what rounding leaves of the difference of equal slopes, with room
constexpr double kSlopeRounding = 1e-12;

void for_texels(TextureLevel& level, auto&& change) {
  parallel_for(level.height, [&](std::size_t row) {
    float* texel = level.rgba.data() + 4 * row * level.width;
    for (std::size_t i = 0; i < level.width; ++i, texel += 4) change(texel);
  });
}

void make_unit(float* texel) {
  double n[3];
  for (int k = 0; k < 3; ++k) n[k] = 2.0 * texel[k] - 1;
  n[2] = std::max(n[2], 0.0);
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (length > 0) {
    for (int k = 0; k < 3; ++k) texel[k] = static_cast<float>(n[k] / length);
  } else {
    texel[0] = texel[1] = 0;
    texel[2] = 1;
  }
  texel[3] = 0;
}

// What interpolation between the texels of a repeating level takes from the covariance of their
// means, in the mean over all places: each texel's share, so that nothing is lost on the whole. Two
// neighbours in a row or column lose 1/9 of the square of their difference, those across a corner
// 1/36; half of it at each.
SlopeMoments interpolated_away(const SlopeLevel& level, std::size_t x, std::size_t y) {
  const std::size_t w = level.width;
  const std::size_t h = level.height;
  const SlopeMoments& here = level.texels[y * w + x];
  SlopeMoments sum;
  for (const std::size_t down : {0, 1, 2})
    for (const std::size_t left : {0, 1, 2}) {
      const SlopeMoments& there = level.texels[(y + h - 1 + down) % h * w + (x + w - 1 + left) % w];
      const double share = left != 1 && down != 1 ? 1.0 / 72 : 1.0 / 18;
      const double a = there.x - here.x;
      const double b = there.y - here.y;
      if (a * a + b * b < kSlopeRounding * kSlopeRounding) continue;
      sum.xx += share * a * a;
      sum.xy += share * a * b;
      sum.yy += share * b * b;
    }
  return sum;
}

// Sets the channels of the role in all levels but the first.
void set_slopes(std::vector<TextureLevel>& levels, TextureRole role, const Job& job) {
  const std::vector<SlopeLevel> slopes = slope_levels(levels[0], job);
  for (std::size_t level = 1; level < levels.size(); ++level) {
    const SlopeLevel& from = slopes[level - 1];
    parallel_for(
        from.height,
        [&](std::size_t y) {
          for (std::size_t x = 0; x < from.width; ++x) {
            const SlopeMoments& own = from.texels[y * from.width + x];
            const SlopeMoments more = interpolated_away(from, x, y);
            float* texel = levels[level].rgba.data() + 4 * (y * from.width + x);
            if (role == TextureRole::normal) {
              texel[3] = static_cast<float>(2 * (own.xy + more.xy));
            } else {
              texel[0] = static_cast<float>(2 * (own.xx + more.xx));
              texel[1] = static_cast<float>(2 * (own.yy + more.yy));
            }
          }
        },
        job);
  }
}

// The first level of slopes, and the others before set_slopes().
std::vector<TextureLevel> slopes_below(TextureLevel normals, const Job& job) {
  std::vector<TextureLevel> levels;
  levels.push_back(std::move(normals));
  for (std::uint32_t w = levels[0].width, h = levels[0].height; w > 1 || h > 1;) {
    w = std::max(1u, w / 2);
    h = std::max(1u, h / 2);
    levels.push_back({w, h, std::vector<float>(std::size_t{4} * w * h)});
  }
  set_slopes(levels, TextureRole::slopes, job);
  std::fill(levels[0].rgba.begin(), levels[0].rgba.end(), 0.0f);
  return levels;
}

// The share of a triangle where a linear function with these values at its corners is at least 0.
double share_of_triangle(double a, double b, double c) {
  const int there = (a >= 0) + (b >= 0) + (c >= 0);
  if (there == 0 || there == 3) return there / 3;
  // a: the corner on its own
  const bool alone = there == 1;
  if ((b >= 0) == alone) std::swap(a, b);
  if ((c >= 0) == alone) std::swap(a, c);
  const double corner = a / (a - b) * (a / (a - c));
  return alone ? corner : 1 - corner;
}

// Where alpha − threshold, bilinear between texel centres, is at least 0: the share of one texel's
// square. around: the 3×3 texels, rows upwards.
float share_there(const std::array<float, 9>& around) {
  const auto there = [](float value) { return value >= 0; };
  if (std::all_of(around.begin(), around.end(), there)) return 1;
  if (std::none_of(around.begin(), around.end(), there)) return 0;
  // each quarter in squares, cut both ways into two triangles: exact but for what the twist within
  // a square does not cancel
  constexpr int kSquares = 4;
  double sum = 0;
  for (const int x : {-1, 1})
    for (const int y : {-3, 3}) {
      const auto at = [&](int offset) {
        return static_cast<double>(around[static_cast<std::size_t>(4 + offset)]);
      };
      const auto value = [&](int i, int j) {
        const double s = 0.5 * i / kSquares;
        const double low = at(0) + s * (at(x) - at(0));
        return low + 0.5 * j / kSquares * (at(y) + s * (at(x + y) - at(y)) - low);
      };
      for (int j = 0; j < kSquares; ++j)
        for (int i = 0; i < kSquares; ++i) {
          const double a = value(i, j);
          const double b = value(i + 1, j);
          const double c = value(i, j + 1);
          const double d = value(i + 1, j + 1);
          sum += share_of_triangle(a, b, d) + share_of_triangle(a, c, d) +
                 share_of_triangle(a, b, c) + share_of_triangle(b, c, d);
        }
    }
  return static_cast<float>(sum / (16 * kSquares * kSquares));
}

void find_shares(TextureLevel& level) {
  const std::size_t width = level.width;
  const std::size_t height = level.height;
  parallel_for(height, [&](std::size_t j) {
    const std::array<std::size_t, 3> rows{(j + height - 1) % height, j, (j + 1) % height};
    for (std::size_t i = 0; i < width; ++i) {
      const std::array<std::size_t, 3> columns{(i + width - 1) % width, i, (i + 1) % width};
      std::array<float, 9> around;
      for (std::size_t k = 0; k < 9; ++k)
        around[k] = level.rgba[4 * (rows[k / 3] * width + columns[k % 3])];
      level.rgba[4 * (j * width + i) + 1] = share_there(around);
    }
  });
}

}  // namespace

unsigned channels(TextureRole role) {
  switch (role) {
    case TextureRole::roughness:
      return 1;
    case TextureRole::cutout:
    case TextureRole::slopes:
      return 2;
    default:
      return 4;
  }
}

std::vector<TextureLevel> map_levels(std::span<const std::uint8_t> rgba, std::uint32_t width,
                                     std::uint32_t height, bool linear, TextureRole role,
                                     float threshold, const Job& job) {
  const bool numbers =
      role == TextureRole::normal || role == TextureRole::slopes || role == TextureRole::roughness;
  TextureLevel first = decoded_level(rgba, width, height, linear || numbers, job);
  switch (role) {
    case TextureRole::color:
      for_texels(first, [](float* texel) { texel[3] = 1; });
      break;
    case TextureRole::premultiplied:
      for_texels(first, [](float* texel) {
        for (int k = 0; k < 3; ++k) texel[k] *= texel[3];
      });
      break;
    case TextureRole::normal:
    case TextureRole::slopes:
      for_texels(first, make_unit);
      break;
    case TextureRole::roughness:
      break;
    case TextureRole::cutout:
      for_texels(first, [&](float* texel) { texel[0] = texel[3] - threshold; });
      find_shares(first);
      break;
  }
  job.poll();
  if (role == TextureRole::slopes) return slopes_below(std::move(first), job);
  std::vector<TextureLevel> levels = with_levels_below(std::move(first), job);
  if (role == TextureRole::normal) set_slopes(levels, role, job);
  return levels;
}

}  // namespace panwright::preview
