// Inverse solid angles of neighbouring pixels. Private to sky.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "world/camera.h"

namespace panwright::sky {

// Of the pixels of a rectangle in an image, 1/sr; 0: a pixel of a lens that shows nothing there.
//
// Without distortion by the middle of each pixel and a term of second order: within 1e-8 for focal
// lengths of 64 pixels and more. With distortion, a tenth pixel decides whether a surface of second
// order through nine of them has them. If neither serves, each is computed.
class InverseAngles {
 public:
  // camera: outlives this.
  explicit InverseAngles(const world::Camera& camera);

  // Begins a rectangle: pixels from `first` to `last`, these included.
  void begin(const std::int64_t (&first)[2], const std::int64_t (&last)[2]);

  // Calls use(i, value) for `count` pixels of a row of the rectangle. They are in no array: waiting
  // for its stores took most of the time.
  template <class Use>
  void for_row(std::int64_t first, std::int64_t y, std::size_t count, const Use& use) const {
    if (middles_) {
      const Middles row = middles_of(first, y, count);
      if (row.is_short)
        for (std::size_t i = 0; i < count; ++i) use(i, row.by_cubic(static_cast<double>(i)));
      else
        for (std::size_t i = 0; i < count; ++i) use(i, row.by_root(static_cast<double>(i)));
      return;
    }
    const Vec3 nodes = smooth_ ? row_of_nodes(y) : Vec3(0);
    const auto skipped = static_cast<std::size_t>(first - first_);
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = smooth_ ? glm::dot(nodes, across_[skipped + i])
                                   : exact(first + static_cast<std::int64_t>(i), y);
      use(i, angle > 0 ? 1 / angle : 0);
    }
  }

 private:
  // Pixels of a row of a lens without distortion: the mean of g = s^(-3/2), s = 1 + u² + v². It is
  // that of a pixel's middle, and the second derivatives there, g·(15·u²/s² − 3/s), times the
  // squares of its sides / 24.
  struct Middles {
    double first = 0, side = 0;  // u
    double above = 0;            // 1 + v²
    double scale = 0, across = 0, fixed = 0, both = 0;
    bool is_short = false;
    double step = 0, low = 0, rise = 0, second = 0, third = 0;  // Hermite's cubic of √s

    double by_root(double i) const {
      const double u = first + i * side;
      return at(u, std::sqrt(above + u * u));
    }
    double by_cubic(double i) const {
      const double t = i * step;
      return at(first + i * side, low + t * (rise + t * (second + t * third)));
    }
    double at(double u, double root) const {
      const double s = above + u * u, square = s * s;
      return scale * (square * s) * root / (square + across * (u * u) + fixed - both * s);
    }
  };
  Middles middles_of(std::int64_t first, std::int64_t y, std::size_t count) const;

  double exact(std::int64_t x, std::int64_t y) const;
  Vec3 row_of_nodes(std::int64_t y) const;

  const world::Camera& camera_;
  bool middles_ = false;
  std::int64_t first_ = 0;
  std::int64_t node_[2][3] = {};
  double value_[3][3] = {};
  bool smooth_ = false;
  std::vector<Vec3> across_;  // weights of the columns
};

}  // namespace panwright::sky
