#include "terrain/internal/ray_grid.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace panwright::terrain::internal {

namespace {

typedef double D2 __attribute__((vector_size(16)));
typedef std::int64_t L2 __attribute__((vector_size(16)));

D2 load(const double* from) {
  D2 out;
  std::memcpy(&out, from, sizeof out);
  return out;
}

}  // namespace

bool RayGrid::set(const Vec3& origin, const Vec3& axis, std::span<const Vec3> directions,
                  std::span<const double> most) {
  pyramid_.origin = origin;
  pyramid_.axis = axis;
  // the first two are often neighbours of a row
  Vec3 along = directions.back() - directions.front();
  if (directions.size() > 1) along = directions[1] - directions[0];
  along -= glm::dot(along, axis) * axis;
  if (!(glm::dot(along, along) > 1e-30))
    along = std::fabs(axis.x) < 0.7 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  x_ = glm::normalize(along - glm::dot(along, axis) * axis);
  y_ = glm::cross(axis, x_);
  constexpr double kFar = std::numeric_limits<double>::infinity();
  double u0 = kFar, v0 = kFar, u1 = -kFar, v1 = -kFar;
  static thread_local std::vector<Vec2> places;
  places.clear();
  for (const Vec3& d : directions) {
    const double ahead = glm::dot(d, axis);
    constexpr double kLeast = 0.5;
    if (!(ahead > kLeast)) return false;
    const Vec2 at(glm::dot(d, x_) / ahead, glm::dot(d, y_) / ahead);
    places.push_back(at);
    u0 = std::min(u0, at.x);
    u1 = std::max(u1, at.x);
    v0 = std::min(v0, at.y);
    v1 = std::max(v1, at.y);
  }
  const auto widen = [](double& low, double& high) {
    const double by = 1e-6 * (high - low) + 1e-9;
    low -= by;
    high += by;
  };
  widen(u0, u1);
  widen(v0, v1);
  pyramid_.inwards = {glm::normalize(x_ - u0 * axis), glm::normalize(u1 * axis - x_),
                      glm::normalize(y_ - v0 * axis), glm::normalize(v1 * axis - y_)};
  u0_ = u0;
  v0_ = v0;
  u_scale_ = kSide / (u1 - u0);
  v_scale_ = kSide / (v1 - v0);
  // by buckets, row by row
  static thread_local std::vector<std::uint16_t> buckets;
  buckets.clear();
  first_.assign(kSide * kSide + 1, 0);
  for (const Vec2& at : places) {
    const int column = std::min(static_cast<int>((at.x - u0_) * u_scale_), kSide - 1),
              row = std::min(static_cast<int>((at.y - v0_) * v_scale_), kSide - 1);
    buckets.push_back(static_cast<std::uint16_t>(row * kSide + column));
    ++first_[buckets.back() + std::size_t{1}];
  }
  for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
  const std::size_t count = directions.size();
  order_.resize(count);
  most_.resize(count);
  cell_.assign(count, {});
  for (auto& part : direction_) part.resize(count);
  static thread_local std::vector<std::uint32_t> next;
  next.assign(first_.begin(), first_.end());
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t at = next[buckets[i]]++;
    order_[at] = static_cast<std::uint32_t>(i);
    most_[at] = most[i];
    for (int k = 0; k < 3; ++k) direction_[static_cast<std::size_t>(k)][at] = directions[i][k];
  }
  return true;
}

double RayGrid::farthest() const { return *std::ranges::max_element(most_); }

SeenPost RayGrid::seen(const Vec3& post) const {
  SeenPost out;
  out.at = post - pyramid_.origin;
  out.ahead = glm::dot(out.at, pyramid_.axis);
  const double inverse = 1 / out.ahead;
  out.u = (glm::dot(out.at, x_) * inverse - u0_) * u_scale_;
  out.v = (glm::dot(out.at, y_) * inverse - v0_) * v_scale_;
  return out;
}

// Buckets that the outline of a triangle may touch.
bool RayGrid::range_of(const SeenPost& a, const SeenPost& b, const SeenPost& c, Range& out) const {
  // note: false of a void post
  if (!(a.ahead + b.ahead + c.ahead > -std::numeric_limits<double>::infinity())) return false;
  const double nearest = std::min({a.ahead, b.ahead, c.ahead});
  if (!(nearest > 0)) {
    // beside the origin, or across its plane: all rays that look ahead
    out = {0, 0, kSide - 1, kSide - 1};
    return std::max({a.ahead, b.ahead, c.ahead}) >= 0;
  }
  constexpr double kSlack = 1e-3;  // buckets: far past widened edges and rounding
  const double left = std::min({a.u, b.u, c.u}) - kSlack,
               right = std::max({a.u, b.u, c.u}) + kSlack, top = std::min({a.v, b.v, c.v}) - kSlack,
               bottom = std::max({a.v, b.v, c.v}) + kSlack;
  if (!(right >= 0 && bottom >= 0 && left < kSide && top < kSide)) return false;
  out.left = static_cast<int>(std::max(left, 0.0));
  out.top = static_cast<int>(std::max(top, 0.0));
  out.right = static_cast<int>(std::min(right, kSide - 1.0));
  out.bottom = static_cast<int>(std::min(bottom, kSide - 1.0));
  return true;
}

void RayGrid::meet(const SeenPost& a, const SeenPost& b, const SeenPost& c, double edge,
                   const Cell& cell, const AcceptPoint* accepts) {
  Range range;
  if (!range_of(a, b, c, range)) return;
  // twice the volumes of the direction with each side, in shares of their sum; by the side itself,
  // as products of two far posts lose its digits
  const auto side = [](const SeenPost& p, const SeenPost& q) {
    return glm::cross(p.at + q.at, q.at - p.at);
  };
  const Vec3 sides[3] = {side(b, c), side(c, a), side(a, b)};
  const double whole = glm::dot(a.at, sides[0]);
  const auto look = [&](std::uint32_t i, double x, double y, double z) {
    const double e0 = x * sides[0].x + y * sides[0].y + z * sides[0].z,
                 e1 = x * sides[1].x + y * sides[1].y + z * sides[1].z,
                 e2 = x * sides[2].x + y * sides[2].y + z * sides[2].z;
    const double sum = e0 + e1 + e2, least = -edge * std::fabs(sum);
    const double sign = sum < 0 ? -1 : 1;
    if (!(e0 * sign >= least && e1 * sign >= least && e2 * sign >= least) || sum == 0) return;
    const double distance = whole / sum;
    if (!(distance >= 0 && distance < most_[i])) return;
    if (accepts != nullptr && !(*accepts)(pyramid_.origin + distance * Vec3(x, y, z))) return;
    most_[i] = distance;
    cell_[i] = cell;
  };
  for (int row = range.top; row <= range.bottom; ++row) {
    const auto* starts = &first_[static_cast<std::size_t>(row * kSide)];
    std::uint32_t i = starts[range.left];
    const std::uint32_t end = starts[range.right + 1];
    for (; i + 1 < end; i += 2) {
      const D2 x = load(&direction_[0][i]), y = load(&direction_[1][i]),
               z = load(&direction_[2][i]);
      const D2 e0 = x * sides[0].x + y * sides[0].y + z * sides[0].z,
               e1 = x * sides[1].x + y * sides[1].y + z * sides[1].z,
               e2 = x * sides[2].x + y * sides[2].y + z * sides[2].z;
      const D2 sum = e0 + e1 + e2, size = sum < 0 ? -sum : sum;
      const D2 least = -edge * size;
      const D2 s0 = sum < 0 ? -e0 : e0, s1 = sum < 0 ? -e1 : e1, s2 = sum < 0 ? -e2 : e2;
      const L2 inside = (s0 >= least) & (s1 >= least) & (s2 >= least);
      for (std::uint32_t k = 0; k < 2; ++k)
        if (inside[k]) look(i + k, x[k], y[k], z[k]);
    }
    if (i < end) look(i, direction_[0][i], direction_[1][i], direction_[2][i]);
  }
}

void RayGrid::cells(std::span<Cell> out) const {
  for (std::size_t i = 0; i < order_.size(); ++i) out[order_[i]] = cell_[i];
}

}  // namespace panwright::terrain::internal
