#include "terrain/internal/blend.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/axis_box.h"

namespace panwright::terrain::internal {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

bool wraps(const ChartRecord& chart) { return (chart.flags & kChartWraps) != 0; }

// Place of a post; of a plane y and x.
LatLon place_of(const ChartRecord& chart, const Map& map, double x, double y) {
  if (map.kind == Map::Kind::none) return {chart.top - y * chart.dy, chart.left + x * chart.dx};
  return map.at(x + 0.5, y + 0.5);
}

Vec2 post_at(const ChartRecord& chart, const Map& map, const LatLon& place) {
  if (map.kind == Map::Kind::none)
    return {(place.longitude - chart.left) / chart.dx, (chart.top - place.latitude) / chart.dy};
  Vec2 post = map.pixel(place, chart.width - (wraps(chart) ? 1 : 0)) - Vec2(0.5);
  if (wraps(chart) && post.x < 0) post.x += chart.width - 1;
  return post;
}

// Metres from a post to the border of its chart.
double to_border(const ChartRecord& chart, const Vec2& spacing, std::uint32_t x, std::uint32_t y) {
  double out = std::min(y, chart.height - 1 - y) * spacing.y;
  if (!wraps(chart)) out = std::min(out, std::min(x, chart.width - 1 - x) * spacing.x);
  return out;
}

Vec3 vertical_of(const LatLon& place) {
  const auto [sy, cy] = det::sincos(place.latitude * kDegree);
  const auto [sx, cx] = det::sincos(place.longitude * kDegree);
  return {cy * cx, cy * sx, sy};
}

double radius_of(const ChartRecord& chart, const Vec3& v) {
  const double a = chart.radius, b = chart.polar_radius;
  if (a == b) return a;
  return a * b / std::sqrt(b * b * (v.x * v.x + v.y * v.y) + a * a * v.z * v.z);
}

}  // namespace

HeightWindow::HeightWindow(const ChartRecord& chart, const ChartRecord& upper, double band)
    : chart_(chart), map_(map_of(chart)) {
  const Map from = map_of(upper);
  AxisRectangle box;
  const auto add = [&](double x, double y) {
    box.add(post_at(chart_, map_, place_of(upper, from, x, y)));
  };
  // lines round the band, from its outer to its inner border
  const double right = upper.width - 1.0, bottom = upper.height - 1.0;
  const Vec2 spacing = from.spacing(0.5 * upper.width, 0.5 * upper.height);
  constexpr int kLines = 4;
  for (int line = 0; line <= kLines; ++line) {
    const double dx = wraps(upper) ? 0 : std::min(band / spacing.x * line / kLines, right / 2),
                 dy = std::min(band / spacing.y * line / kLines, bottom / 2);
    for (std::uint32_t x = 0; x < upper.width; ++x) {
      const double at = std::clamp<double>(x, dx, right - dx);
      add(at, dy);
      add(at, bottom - dy);
    }
    for (std::uint32_t y = 0; y < upper.height; ++y) {
      const double at = std::clamp<double>(y, dy, bottom - dy);
      add(dx, at);
      add(right - dx, at);
    }
  }
  if (box.empty()) return;
  // between the lines places lie further out by less than their distance
  const Vec2 slack = Vec2(2) + 0.25 * (box.high - box.low) / double{kLines};
  const auto cut = [](double v, std::uint32_t limit) {
    return static_cast<std::uint32_t>(std::clamp(v, 0.0, double(limit)));
  };
  left_ = cut(std::floor(box.low.x - slack.x), chart.width);
  top_ = cut(std::floor(box.low.y - slack.y), chart.height);
  width_ = cut(std::ceil(box.high.x + slack.x) + 1, chart.width) - left_;
  height_ = cut(std::ceil(box.high.y + slack.y) + 1, chart.height) - top_;
}

void HeightWindow::push(std::span<const float> row) {
  const std::uint32_t y = next_++;
  if (heights_.empty()) heights_.resize(posts());
  if (y < top_ || y >= top_ + height_) return;
  std::copy_n(row.begin() + left_, width_, heights_.begin() + std::size_t{y - top_} * width_);
}

double HeightWindow::at(const LatLon& place) const {
  const Vec2 post = post_at(chart_, map_, place);
  constexpr double kOutside = 1e-6;  // posts
  if (!(post.x >= -kOutside && post.y >= -kOutside && post.x <= chart_.width - 1 + kOutside &&
        post.y <= chart_.height - 1 + kOutside))
    return kNone;
  const auto x = static_cast<std::uint32_t>(std::clamp(post.x, 0.0, chart_.width - 2.0)),
             y = static_cast<std::uint32_t>(std::clamp(post.y, 0.0, chart_.height - 2.0));
  const std::uint32_t first = post.x - x >= post.y - y ? 0 : 1;
  if (map_.kind == Map::Kind::none) {
    if (!holds(x, y)) return kNone;
    const double u = post.x - x, v = post.y - y, h = height(x, y), far = height(x + 1, y + 1);
    const double side = first == 0 ? height(x + 1, y) : height(x, y + 1);
    return first == 0 ? h + u * (side - h) + v * (far - side)
                      : h + v * (side - h) + u * (far - side);
  }
  const Vec3 up = vertical_of(place);
  if (const auto met = on_triangle(x, y, first, up)) return *met;
  if (const auto met = on_triangle(x, y, 1 - first, up)) return *met;
  // edges are straight in space, not on the map: the place may be in a neighbour
  for (std::uint32_t cy = y > 0 ? y - 1 : 0; cy <= std::min(y + 1, chart_.height - 2); ++cy)
    for (std::uint32_t cx = x > 0 ? x - 1 : 0; cx <= std::min(x + 1, chart_.width - 2); ++cx)
      for (std::uint32_t which = 0; which < 2; ++which)
        if (cx != x || cy != y)
          if (const auto met = on_triangle(cx, cy, which, up)) return *met;
  return kNone;
}

// Height at which a vertical meets a triangle of a cell.
std::optional<double> HeightWindow::on_triangle(std::uint32_t x, std::uint32_t y,
                                                std::uint32_t which, const Vec3& up) const {
  if (!holds(x, y)) return {};
  const std::uint32_t corners[3][2] = {
      {x, y}, {x + 1, y + 1}, {which == 0 ? x + 1 : x, which == 0 ? y : y + 1}};
  Vec3 points[3];
  for (int k = 0; k < 3; ++k) {
    const double h = height(corners[k][0], corners[k][1]);
    if (std::isnan(h)) return {};
    const Vec3 v = vertical_of(map_.at(corners[k][0] + 0.5, corners[k][1] + 0.5));
    points[k] = (radius_of(chart_, v) + h) * v;
  }
  // from beside the triangle, so that differences are small
  const double radius = radius_of(chart_, up), near = height(x, y);
  const Vec3 side = points[1] - points[0], other = points[2] - points[0],
             from = (radius + near) * up - points[0], p = glm::cross(up, other);
  const double det = glm::dot(side, p);
  if (det == 0) return {};
  const Vec3 q = glm::cross(from, side);
  const double u = glm::dot(from, p) / det, v = glm::dot(up, q) / det;
  constexpr double kEdge = -1e-9;
  if (u < kEdge || v < kEdge || u + v > 1 - kEdge) return {};
  return near + glm::dot(other, q) / det;
}

Blend::Blend(const ChartRecord& chart, double band, std::vector<const HeightWindow*> below)
    : chart_(chart), map_(map_of(chart)), band_(band), below_(std::move(below)) {}

void Blend::apply(std::uint32_t y, std::span<double> heights) {
  const double middle = 0.5 * static_cast<double>(heights.size());
  const Vec2 spacing = map_.spacing(middle, y + 0.5);
  const auto count = static_cast<std::uint32_t>(heights.size());
  for (std::uint32_t x = 0; x < count; ++x) {
    const double distance = to_border(chart_, spacing, x, y);
    if (distance >= band_ || std::isnan(heights[x])) continue;
    const LatLon place = place_of(chart_, map_, x, y);
    double other = kNone;
    for (std::size_t k = 0; k < below_.size() && std::isnan(other); ++k)
      other = below_[k]->at(place);
    if (std::isnan(other)) {
      report_.without += distance == 0;
      continue;
    }
    const double t = distance / band_, share = t * t * (3 - 2 * t);
    const double off = heights[x] - other;
    heights[x] = other + share * off;
    if (distance > 0) continue;
    ++report_.posts;
    report_.step = std::max(report_.step, std::fabs(off));
    report_.sum += off;
    report_.squares += off * off;
  }
}

}  // namespace panwright::terrain::internal
