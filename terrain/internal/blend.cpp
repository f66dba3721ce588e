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
  if (x < left_ || y < top_ || x + 1 >= left_ + width_ || y + 1 >= top_ + height_ ||
      heights_.empty())
    return kNone;
  const bool right = post.x - x >= post.y - y;
  const std::uint32_t corners[3][2] = {
      {x, y}, {x + 1, y + 1}, {right ? x + 1 : x, right ? y : y + 1}};
  const auto height = [&](int k) {
    return double(heights_[std::size_t{corners[k][1] - top_} * width_ + corners[k][0] - left_]);
  };
  if (map_.kind == Map::Kind::none) {
    const double u = post.x - x, v = post.y - y;
    const double rise = right ? u * (height(2) - height(0)) + v * (height(1) - height(2))
                              : v * (height(2) - height(0)) + u * (height(1) - height(2));
    return height(0) + rise;
  }
  Vec3 points[3];
  for (int k = 0; k < 3; ++k) {
    const Vec3 v = vertical_of(map_.at(corners[k][0] + 0.5, corners[k][1] + 0.5));
    points[k] = (radius_of(chart_, v) + height(k)) * v;
  }
  const Vec3 normal = glm::cross(points[1] - points[0], points[2] - points[0]);
  const Vec3 up = vertical_of(place);
  const double facing = glm::dot(normal, up);
  return facing != 0 ? glm::dot(normal, points[0]) / facing - radius_of(chart_, up) : kNone;
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
