// Tiles of an image, and the box filter over the samples of a tile. Private to preview; nothing
// here needs OpenGL.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "image/image.h"
#include "preview/frame/projection.h"

namespace panwright::preview {

// Iterator over tiles of at most side × side pixels, row by row, that cover the image.
class Tiles {
 public:
  Tiles(std::uint32_t width, std::uint32_t height, std::uint32_t side)
      : width_(width), height_(height), side_(side) {}
  explicit operator bool() const { return y_ < height_; }  // true until the end
  Tile operator*() const {
    return {x_, y_, std::min(side_, width_ - x_), std::min(side_, height_ - y_)};
  }
  void next() {
    x_ += side_;
    if (x_ < width_) return;
    x_ = 0;
    y_ += side_;
  }

 private:
  std::uint32_t width_, height_, side_;
  std::uint32_t x_ = 0;
  std::uint32_t y_ = 0;
};

// Sets the radiance and coverage of a tile's pixels.
//
//   rgba  4*tile.height*tile.width linear, from the top left
void store_pixels(std::span<const float> rgba, const Tile& tile, image::Image& image);

// Pixel of an image, in the order of rows.
struct Pixel {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  friend bool operator==(const Pixel&, const Pixel&) = default;
  friend bool operator<(const Pixel& a, const Pixel& b) {
    return a.y != b.y ? a.y < b.y : a.x < b.x;
  }
};

// Adjacent pixels of one row.
struct PixelRun {
  Pixel first;
  std::uint32_t count = 0;
};

// Returns the runs of ascending pixels.
std::vector<PixelRun> runs(std::span<const Pixel> pixels);

// Set of pixels of a tile, for questions about rectangles.
class PixelSet {
 public:
  // pixels: those of the set, from the tile's upper left corner.
  void assign(const Tile& tile, std::span<const Pixel> pixels);
  // Returns true if a part of the tile holds one of them. Cost: O(1).
  bool any(const Tile& part) const;

 private:
  Tile tile_;
  std::vector<std::uint32_t> sums_;  // above and left of the corner (x, y): (width + 1)·y + x
};

// Covers all pixels by rectangles, each pixel in one, none empty. A further rectangle costs as much
// as `worth` pixels in one.
//
//   pixels  reordered: those of a group are adjacent, and keep ascending order
//   width, height  the largest of a rectangle
struct PixelGroup {
  Tile around;
  std::span<const std::uint32_t> pixels;  // into those given
};
std::vector<PixelGroup> group(std::span<const Pixel> all, std::vector<std::uint32_t>& pixels,
                              std::uint32_t width, std::uint32_t height, std::uint64_t worth);

// Clears the pixels of a tile outside a part to background. Empty part: all.
void clear_around(const Tile& whole, const Tile& part, image::Image& image);

}  // namespace panwright::preview
