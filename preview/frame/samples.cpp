#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "preview/frame/samples.h"

namespace panwright::preview {

std::vector<Tile> tiles(std::uint32_t width, std::uint32_t height, std::uint32_t side) {
  std::vector<Tile> result;
  for (std::uint32_t y = 0; y < height; y += side)
    for (std::uint32_t x = 0; x < width; x += side)
      result.push_back({x, y, std::min(side, width - x), std::min(side, height - y)});
  return result;
}

void average_samples(std::span<const float> rgba, const Tile& tile, unsigned samples,
                     Image& image) {
  const std::size_t row_floats = std::size_t{4} * tile.width * samples;
  parallel_for(tile.height, [&](std::size_t row) {
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
  });
}

}  // namespace panwright::preview
