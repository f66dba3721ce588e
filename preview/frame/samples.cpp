#include <algorithm>
#include <functional>

#include "base/parallel.h"
#include "preview/frame/samples.h"

namespace panwright::preview {

void store_pixels(std::span<const float> rgba, const Tile& tile, image::Image& image) {
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

void clear_around(const Tile& whole, const Tile& part, image::Image& image) {
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

namespace {

Tile tile_around(std::span<const Pixel> all, std::span<const std::uint32_t> pixels) {
  std::uint32_t low[2] = {~0u, ~0u};
  std::uint32_t high[2] = {0, 0};
  for (const std::uint32_t index : pixels) {
    const Pixel& pixel = all[index];
    low[0] = std::min(low[0], pixel.x);
    low[1] = std::min(low[1], pixel.y);
    high[0] = std::max(high[0], pixel.x);
    high[1] = std::max(high[1], pixel.y);
  }
  return {low[0], low[1], high[0] - low[0] + 1, high[1] - low[1] + 1};
}

std::uint64_t area(const Tile& tile) { return std::uint64_t{tile.width} * tile.height; }

}  // namespace

std::vector<PixelGroup> group(std::span<const Pixel> all, std::vector<std::uint32_t>& pixels,
                              std::uint32_t width, std::uint32_t height, std::uint64_t worth) {
  std::vector<PixelGroup> done;
  if (pixels.empty()) return done;
  struct Part {
    Tile around;
    std::size_t first;
    std::size_t end;
  };
  std::vector<Part> todo{{tile_around(all, pixels), 0, pixels.size()}};
  while (!todo.empty()) {
    const Part whole = todo.back();
    todo.pop_back();
    const Tile& box = whole.around;
    const bool too_large = box.width > width || box.height > height;
    const bool across = too_large ? box.width > width : box.width >= box.height;
    const std::uint32_t middle = across ? box.x + box.width / 2 : box.y + box.height / 2;
    const auto begin = pixels.begin();
    const auto at = [&](std::size_t i) { return begin + static_cast<std::ptrdiff_t>(i); };
    if (too_large || area(box) > worth) {
      const auto split = std::stable_partition(
          at(whole.first), at(whole.end),
          [&](std::uint32_t index) { return (across ? all[index].x : all[index].y) < middle; });
      const auto half = static_cast<std::size_t>(split - begin);
      const std::span<const std::uint32_t> both(pixels);
      // note: a box is as tight as can be, so neither half is empty
      const Part first{tile_around(all, both.subspan(whole.first, half - whole.first)), whole.first,
                       half};
      const Part second{tile_around(all, both.subspan(half, whole.end - half)), half, whole.end};
      if (too_large || area(first.around) + area(second.around) + worth < area(box)) {
        todo.push_back(second);
        todo.push_back(first);
        continue;
      }
      std::sort(at(whole.first), at(whole.end));
    }
    done.push_back({box, std::span<const std::uint32_t>(pixels).subspan(whole.first,
                                                                        whole.end - whole.first)});
  }
  return done;
}

void PixelSet::assign(const Tile& tile, std::span<const Pixel> pixels) {
  tile_ = tile;
  const std::size_t row = std::size_t{tile.width} + 1;
  sums_.assign(row * (std::size_t{tile.height} + 1), 0);
  for (const Pixel& pixel : pixels) ++sums_[row * (pixel.y + 1) + pixel.x + 1];
  for (std::size_t y = 1; y <= tile.height; ++y)
    for (std::size_t x = 1; x <= tile.width; ++x)
      sums_[row * y + x] +=
          sums_[row * y + x - 1] + sums_[row * (y - 1) + x] - sums_[row * (y - 1) + x - 1];
}

bool PixelSet::any(const Tile& part) const {
  const std::size_t row = std::size_t{tile_.width} + 1;
  const std::size_t left = part.x - tile_.x, right = left + part.width;
  const std::size_t top = part.y - tile_.y, bottom = top + part.height;
  return sums_[row * bottom + right] + sums_[row * top + left] !=
         sums_[row * top + right] + sums_[row * bottom + left];
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

}  // namespace panwright::preview
