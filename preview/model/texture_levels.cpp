#include <algorithm>
#include <array>
#include <cassert>

#include "base/parallel.h"
#include "image/image.h"
#include "preview/model/texture_levels.h"

namespace panwright::preview {
namespace {

TextureLevel halved(const TextureLevel& above, const Job& job) {
  TextureLevel level;
  level.width = std::max(1u, above.width / 2);
  level.height = std::max(1u, above.height / 2);
  level.rgba.resize(std::size_t{4} * level.width * level.height);
  std::vector<Footprint> columns;
  for (std::uint32_t i = 0; i < level.width; ++i)
    columns.push_back(footprint(i, above.width, level.width));
  parallel_for(
      level.height,
      [&](std::size_t j) {
        const Footprint rows = footprint(static_cast<std::uint32_t>(j), above.height, level.height);
        if (2 * level.width == above.width && 2 * level.height == above.height) {
          const float* upper = above.rgba.data() + std::size_t{4} * rows.first * above.width;
          const float* lower = upper + std::size_t{4} * above.width;
          float* to = level.rgba.data() + 4 * j * level.width;
          for (std::size_t i = 0; i < level.width; ++i, upper += 8, lower += 8, to += 4)
            for (int k = 0; k < 4; ++k)
              to[k] = static_cast<float>(0.25 * upper[k] + 0.25 * upper[k + 4] + 0.25 * lower[k] +
                                         0.25 * lower[k + 4]);
          return;
        }
        for (std::size_t i = 0; i < level.width; ++i)
          for (std::size_t channel = 0; channel < 4; ++channel) {
            double sum = 0;
            for (std::uint32_t y = 0; y < rows.count; ++y)
              for (std::uint32_t x = 0; x < columns[i].count; ++x) {
                const std::size_t texel =
                    std::size_t{rows.first + y} * above.width + columns[i].first + x;
                sum += rows.share[y] * columns[i].share[x] * above.rgba[4 * texel + channel];
              }
            level.rgba[4 * (j * level.width + i) + channel] = static_cast<float>(sum);
          }
      },
      job);
  return level;
}

}  // namespace

Footprint footprint(std::uint32_t index, std::uint32_t from, std::uint32_t to) {
  // in units of 1/to of a source texel everything is an integer
  const std::uint64_t begin = std::uint64_t{index} * from;
  const std::uint64_t end = begin + from;
  Footprint result;
  result.first = static_cast<std::uint32_t>(begin / to);
  for (std::uint64_t i = result.first; i * to < end; ++i) {
    const std::uint64_t low = std::max(begin, i * to);
    const std::uint64_t high = std::min(end, (i + 1) * to);
    assert(result.count < result.share.size());
    result.share[result.count++] = static_cast<double>(high - low) / from;
  }
  return result;
}

TextureLevel decoded_level(std::span<const std::uint8_t> rgba, std::uint32_t width,
                           std::uint32_t height, bool linear, const Job& job) {
  assert(width > 0 && height > 0 && rgba.size() == std::size_t{4} * width * height);
  std::array<float, 256> value{};
  for (std::size_t code = 0; code < value.size(); ++code)
    value[code] = static_cast<float>(linear ? static_cast<double>(code) / 255
                                            : image::srgb_decoded(static_cast<std::uint8_t>(code)));
  TextureLevel level;
  level.width = width;
  level.height = height;
  level.rgba.resize(rgba.size());
  const std::size_t row = std::size_t{4} * width;
  parallel_for(
      height,
      [&](std::size_t j) {
        const std::uint8_t* from = rgba.data() + (height - 1 - j) * row;
        float* to = level.rgba.data() + j * row;
        for (std::size_t i = 0; i < row; ++i)
          to[i] = i % 4 == 3 ? static_cast<float>(from[i]) / 255 : value[from[i]];
      },
      job);
  return level;
}

std::vector<TextureLevel> with_levels_below(TextureLevel first, const Job& job) {
  std::vector<TextureLevel> levels;
  levels.push_back(std::move(first));
  while (levels.back().width > 1 || levels.back().height > 1)
    levels.push_back(halved(levels.back(), job));
  return levels;
}

}  // namespace panwright::preview
