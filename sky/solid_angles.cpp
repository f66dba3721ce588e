#include "sky/internal/solid_angles.h"

#include <algorithm>

namespace panwright::sky {
namespace {

// Lagrange's polynomials of three nodes.
Vec3 weights(const std::int64_t (&node)[3], double at) {
  const auto a = static_cast<double>(node[0]), b = static_cast<double>(node[1]),
             c = static_cast<double>(node[2]);
  return {(at - b) * (at - c) / ((a - b) * (a - c)), (at - a) * (at - c) / ((b - a) * (b - c)),
          (at - a) * (at - b) / ((c - a) * (c - b))};
}

}  // namespace

InverseAngles::InverseAngles(const world::Camera& camera)
    : camera_(camera), side_(Vec2(1) / camera.focal) {
  constexpr double kLong = 64;  // pixels
  middles_ = camera.distortion == nullptr && std::min(camera.focal.x, camera.focal.y) >= kLong;
}

void InverseAngles::begin(const std::int64_t (&first)[2], const std::int64_t (&last)[2]) {
  first_ = first[0];
  smooth_ = false;
  series_ = middles_ && begin_series(first, last);
  if (middles_) return;
  constexpr std::int64_t kFew = 6;  // on a side: not worth it
  if (last[0] - first[0] < kFew || last[1] - first[1] < kFew) return;
  for (int k = 0; k < 2; ++k) {
    node_[k][0] = first[k];
    node_[k][1] = (first[k] + last[k]) / 2;
    node_[k][2] = last[k];
  }
  bool all = true;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) all = all && (value_[j][i] = exact(node_[0][i], node_[1][j])) > 0;
  constexpr double kSmooth = 1e-7;  // relative: about that of a float
  const std::int64_t x = first[0] + 1, y = first[1] + 1;
  const double between = exact(x, y);
  const double by_nodes = glm::dot(row_of_nodes(y), weights(node_[0], static_cast<double>(x)));
  smooth_ = all && std::fabs(by_nodes - between) <= kSmooth * between;
  if (!smooth_) return;
  across_.clear();
  for (std::int64_t column = first[0]; column <= last[0]; ++column)
    across_.push_back(weights(node_[0], static_cast<double>(column)));
}

InverseAngles::Middles InverseAngles::middles_of(std::int64_t first, std::int64_t y) const {
  const Vec2 squares = side_ * side_ / 24.0;
  const double v = (static_cast<double>(y) + 0.5 - camera_.principal.y) * side_.y;
  Middles row;
  row.first = (static_cast<double>(first) + 0.5 - camera_.principal.x) * side_.x;
  row.side = side_.x;
  row.above = 1 + v * v;
  row.scale = camera_.focal.x * camera_.focal.y;
  row.across = 15 * squares.x;
  row.fixed = 15 * squares.y * v * v;
  row.both = 3 * (squares.x + squares.y);
  return row;
}

// False: the rectangle is too large.
bool InverseAngles::begin_series(const std::int64_t (&first)[2], const std::int64_t (&last)[2]) {
  constexpr double kReach = 0.012;  // from the middle: the term left out is within 3e-9
  const Vec2 half = Vec2(last[0] - first[0] + 1, last[1] - first[1] + 1) * 0.5;
  if (!(half.x * side_.x <= kReach && half.y * side_.y <= kReach)) return false;
  const std::int64_t x = (first[0] + last[0]) / 2, y = (first[1] + last[1]) / 2;
  const Middles row = middles_of(x, y);
  value_at_ = row.at(0);
  const double s = row.above + row.first * row.first;
  per_square_ = 1 / s;
  // as s changes, so do the second derivatives: those of a square pixel
  const double square = side_.x * side_.y / 24;
  rise_ = 1.5 + square * (15 * (s - 2) / s - 6) / s;
  return true;
}

double InverseAngles::exact(std::int64_t x, std::int64_t y) const {
  return world::pixel_solid_angle(camera_, static_cast<std::uint32_t>(x),
                                  static_cast<std::uint32_t>(y));
}

Vec3 InverseAngles::row_of_nodes(std::int64_t y) const {
  const Vec3 down = weights(node_[1], static_cast<double>(y));
  Vec3 row(0);
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) row[i] += down[j] * value_[j][i];
  return row;
}

}  // namespace panwright::sky
