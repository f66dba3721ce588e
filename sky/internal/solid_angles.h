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
    if (series_) {
      const double v = side_.y * (static_cast<double>(y) + 0.5 - camera_.principal.y);
      const double u = side_.x * (static_cast<double>(first) + 0.5 - camera_.principal.x);
      const auto begin = static_cast<float>((1 + v * v + u * u) * per_square_ - 1);
      const auto step = static_cast<float>(2 * u * side_.x * per_square_);
      const auto bend = static_cast<float>(side_.x * side_.x * per_square_);
      const auto value = static_cast<float>(value_at_), rise = static_cast<float>(rise_);
      for (std::size_t i = 0; i < count; ++i) {
        const auto n = static_cast<float>(i);
        const float more = begin + n * (step + n * bend);
        use(i, value + value * (more * (rise + more * (0.375f - 0.0625f * more))));
      }
      return;
    }
    if (middles_) {
      const Middles row = middles_of(first, y);
      for (std::size_t i = 0; i < count; ++i) use(i, row.at(static_cast<double>(i)));
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

    double at(double i) const {
      const double u = first + i * side;
      const double s = above + u * u, square = s * s;
      return scale * (square * s) * std::sqrt(s) / (square + across * (u * u) + fixed - both * s);
    }
  };
  Middles middles_of(std::int64_t first, std::int64_t y) const;
  bool begin_series(const std::int64_t (&first)[2], const std::int64_t (&last)[2]);

  double exact(std::int64_t x, std::int64_t y) const;
  Vec3 row_of_nodes(std::int64_t y) const;

  const world::Camera& camera_;
  Vec2 side_;  // of a pixel
  bool middles_ = false;
  // In a small rectangle: Taylor's series of 1/g in s about its middle.
  bool series_ = false;
  double value_at_ = 0, per_square_ = 0, rise_ = 0;
  std::int64_t first_ = 0;
  std::int64_t node_[2][3] = {};
  double value_[3][3] = {};
  bool smooth_ = false;
  std::vector<Vec3> across_;  // weights of the columns
};

}  // namespace panwright::sky
