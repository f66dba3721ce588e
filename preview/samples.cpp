#include <algorithm>
#include <array>
#include <functional>

#include "base/parallel.h"
#include "preview/internal/samples.h"

namespace panwright::preview {

std::vector<Tile> tiles(std::uint32_t width, std::uint32_t height, std::uint32_t side) {
  std::vector<Tile> result;
  for (Tiles tile(width, height, side); tile; tile.next()) result.push_back(*tile);
  return result;
}

void average_samples(std::span<const float> rgba, const Tile& tile, unsigned samples,
                     Image& image) {
  const std::size_t row_floats = std::size_t{4} * tile.width * samples;
  const auto average_row = [&](std::size_t row) {
    const std::size_t first = (tile.y + row) * image.width + tile.x;
    float* radiance = image.radiance.data() + 3 * first;
    float* coverage = image.coverage.data() + first;
    const float* from = rgba.data() + row * samples * row_floats;
    if (samples == 1) {
      for (std::size_t i = 0; i < tile.width; ++i) {
        for (std::size_t k = 0; k < 3; ++k) radiance[3 * i + k] = from[4 * i + k];
        coverage[i] = from[4 * i + 3];
      }
      return;
    }
    const double weight = 1.0 / (static_cast<double>(samples) * samples);
    for (std::size_t i = 0; i < tile.width; ++i) {
      std::array<double, 4> sum{};
      for (unsigned y = 0; y < samples; ++y) {
        const float* line = from + y * row_floats + 4 * i * samples;
        for (unsigned x = 0; x < samples; ++x)
          for (std::size_t k = 0; k < 4; ++k) sum[k] += line[4 * x + k];
      }
      for (std::size_t k = 0; k < 3; ++k) radiance[3 * i + k] = static_cast<float>(weight * sum[k]);
      coverage[i] = static_cast<float>(weight * sum[3]);
    }
  };
  parallel_for(tile.height, std::ref(average_row));
}

void clear_around(const Tile& whole, const Tile& part, Image& image) {
  const bool none = part.width == 0 || part.height == 0;
  const auto clear = [&](std::size_t y, std::size_t first, std::size_t end) {
    const std::size_t row = y * image.width;
    std::fill(image.coverage.begin() + static_cast<std::ptrdiff_t>(row + first),
              image.coverage.begin() + static_cast<std::ptrdiff_t>(row + end), 0.0f);
    std::fill(image.radiance.begin() + static_cast<std::ptrdiff_t>(3 * (row + first)),
              image.radiance.begin() + static_cast<std::ptrdiff_t>(3 * (row + end)), 0.0f);
  };
  for (std::uint32_t y = whole.y; y < whole.y + whole.height; ++y) {
    const bool crosses = !none && y >= part.y && y < part.y + part.height;
    clear(y, whole.x, crosses ? part.x : whole.x + whole.width);
    if (crosses) clear(y, part.x + part.width, whole.x + whole.width);
  }
}

}  // namespace panwright::preview
