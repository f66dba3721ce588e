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

InverseAngles::InverseAngles(const world::Camera& camera) : camera_(camera) {
  constexpr double kLong = 64;  // pixels
  middles_ = camera.distortion == nullptr && std::min(camera.focal.x, camera.focal.y) >= kLong;
}

void InverseAngles::begin(const std::int64_t (&first)[2], const std::int64_t (&last)[2]) {
  first_ = first[0];
  smooth_ = false;
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

InverseAngles::Middles InverseAngles::middles_of(std::int64_t first, std::int64_t y,
                                                 std::size_t count) const {
  const Vec2 side = Vec2(1) / camera_.focal;
  const Vec2 squares = side * side / 24.0;
  const double v = (static_cast<double>(y) + 0.5 - camera_.principal.y) * side.y;
  Middles row;
  row.first = (static_cast<double>(first) + 0.5 - camera_.principal.x) * side.x;
  row.side = side.x;
  row.above = 1 + v * v;
  row.scale = camera_.focal.x * camera_.focal.y;
  row.across = 15 * squares.x;
  row.fixed = 15 * squares.y * v * v;
  row.both = 3 * (squares.x + squares.y);
  constexpr double kShort = 0.02;  // of a line that a cubic follows within 2e-9
  const auto steps = static_cast<double>(count - 1);
  row.is_short = steps >= 2 && steps * side.x <= kShort;
  if (!row.is_short) return row;
  const double last = row.first + steps * side.x;
  const double high = std::sqrt(row.above + last * last);
  row.step = 1 / steps;
  row.low = std::sqrt(row.above + row.first * row.first);
  row.rise = steps * side.x * row.first / row.low;
  const double end = steps * side.x * last / high;
  row.second = 3 * (high - row.low) - 2 * row.rise - end;
  row.third = 2 * (row.low - high) + row.rise + end;
  return row;
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
