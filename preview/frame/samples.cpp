#include <algorithm>
#include <functional>

#include "base/parallel.h"
#include "preview/frame/samples.h"

namespace panwright::preview {

void store_pixels(std::span<const float> rgba, const Tile& tile, Image& image) {
  const auto store_row = [&](std::size_t row) {
    const std::size_t first = (tile.y + row) * image.width + tile.x;
    float* radiance = image.radiance.data() + 3 * first;
    float* coverage = image.coverage.data() + first;
    const float* from = rgba.data() + row * 4 * tile.width;
    for (std::size_t i = 0; i < tile.width; ++i) {
      for (std::size_t k = 0; k < 3; ++k) radiance[3 * i + k] = from[4 * i + k];
      coverage[i] = from[4 * i + 3];
    }
  };
  parallel_for(tile.height, std::ref(store_row));
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

std::vector<PixelRun> runs(std::span<const Pixel> pixels) {
  std::vector<PixelRun> result;
  for (const Pixel& pixel : pixels) {
    if (!result.empty() && result.back().first.y == pixel.y &&
        result.back().first.x + result.back().count == pixel.x)
      ++result.back().count;
    else
      result.push_back({pixel, 1});
  }
  return result;
}

std::vector<Tile> tiles_of(const Tile& part, unsigned samples, std::uint64_t area,
                           std::uint32_t side) {
  const std::uint64_t pixels = area / (std::uint64_t{samples} * samples);
  const std::uint32_t most = std::max(1u, side / samples);
  const std::uint32_t width = std::max(1u, std::min(part.width, most));
  const auto rows = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(pixels / width, 1, most));
  const auto columns =
      static_cast<std::uint32_t>(std::clamp<std::uint64_t>(pixels / rows, 1, width));
  std::vector<Tile> result;
  for (std::uint32_t y = 0; y < part.height; y += rows)
    for (std::uint32_t x = 0; x < part.width; x += columns)
      result.push_back({part.x + x, part.y + y, std::min(columns, part.width - x),
                        std::min(rows, part.height - y)});
  return result;
}

}  // namespace panwright::preview
