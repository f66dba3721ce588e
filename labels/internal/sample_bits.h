// Samples of pixels as bits: 8×8 a pixel, of the rows of a word's bytes from the lowest.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/math.h"
#include "labels/internal/image_plane.h"

namespace panwright::labels {

inline constexpr int kSampleSide = 8;

// Columns are shifted from row to row, so that upright edges are resolved to 1/64 of a pixel.
inline constexpr std::array<double, 8> kColumnShift = {0.0625, 0.5625, 0.3125, 0.8125,
                                                       0.1875, 0.6875, 0.4375, 0.9375};

// Place of a bit in its pixel.
inline Vec2 sample_place(unsigned bit) {
  const unsigned row = bit / 8, column = bit % 8;
  return {(column + kColumnShift[row]) / 8, (row + 0.5) / 8};
}

// Rectangle of pixels, or of their squares 1/scale wide.
struct Region {
  double left = 0, top = 0;  // pixels, multiples of 1/scale
  double scale = 1;          // a power of two
  int width = 0, height = 0;

  Vec2 local(const Vec2& place) const { return (place - Vec2(left, top)) * scale; }
  Vec2 place(int x, int y, unsigned bit) const {
    return Vec2(left, top) + (Vec2(x, y) + sample_place(bit)) / scale;
  }
};

// Bits of a rectangle in a region.
struct SampleBits {
  int left = 0, top = 0, width = 0, height = 0;
  std::vector<std::uint64_t> words;  // height*width

  bool has(int x, int y) const {
    return x >= left && y >= top && x < left + width && y < top + height;
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - top) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x - left);
  }
  std::uint64_t at(int x, int y) const { return has(x, y) ? words[index(x, y)] : 0; }
};

// Calls visit(row, begin, end) for the samples within a triangle, of the rectangle of the bits:
// rows and columns of samples from those of the region's pixel 0. A sample on an edge belongs to
// one of the triangles at it.
template <class Visit>
void for_spans(PlacedTriangle p, const SampleBits& bits, Visit&& visit) {
  const auto later = [](const Vec2& a, const Vec2& b) {
    return a.y > b.y || (a.y == b.y && a.x > b.x);
  };
  if (later(p[0], p[1])) std::swap(p[0], p[1]);
  if (later(p[1], p[2])) std::swap(p[1], p[2]);
  if (later(p[0], p[1])) std::swap(p[0], p[1]);
  const auto clamped = [](double v, int low, int high) {
    return static_cast<int>(std::clamp(std::ceil(v), double(low), double(high)));
  };
  const int top = 8 * bits.top, bottom = 8 * (bits.top + bits.height);
  const int left = 8 * bits.left, right = 8 * (bits.left + bits.width);
  const int first = clamped(8 * p[0].y - 0.5, top, bottom);
  const int last = clamped(8 * p[2].y - 0.5, top, bottom);
  if (first >= last) return;
  const double whole = (p[2].x - p[0].x) / (p[2].y - p[0].y);
  const double upper = (p[1].x - p[0].x) / (p[1].y - p[0].y);
  const double lower = (p[2].x - p[1].x) / (p[2].y - p[1].y);
  for (int row = first; row < last; ++row) {
    const double y = (row + 0.5) / 8;
    double a = p[0].x + (y - p[0].y) * whole;
    double b = y < p[1].y ? p[0].x + (y - p[0].y) * upper : p[1].x + (y - p[1].y) * lower;
    if (b < a) std::swap(a, b);
    const double shift = kColumnShift[static_cast<std::size_t>(row & 7)];
    const int begin = clamped(8 * a - shift, left, right);
    const int end = clamped(8 * b - shift, left, right);
    if (begin < end) visit(row, begin, end);
  }
}

// Sets the samples of a span.
inline void set_span(SampleBits& bits, int row, int begin, int end) {
  const int shift = 8 * (row & 7);
  const int first = begin >> 3, last = (end - 1) >> 3;
  std::uint64_t* words = bits.words.data() + bits.index(first, row >> 3);
  const std::uint64_t from = (0xffu << (begin & 7)) & 0xffu;
  const std::uint64_t to = 0xffu >> (7 - ((end - 1) & 7));
  if (first == last) {
    words[0] |= (from & to) << shift;
    return;
  }
  words[0] |= from << shift;
  for (int k = 1; k < last - first; ++k) words[k] |= std::uint64_t{0xff} << shift;
  words[last - first] |= to << shift;
}

}  // namespace panwright::labels
