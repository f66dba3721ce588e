#include "preview/frame/outline.h"

#include <algorithm>
#include <cmath>

namespace panwright::preview {
namespace {

double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

double distance_to_segment(const Vec2& point, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double square = glm::dot(along, along);
  const double t = square > 0 ? std::clamp(glm::dot(point - a, along) / square, 0.0, 1.0) : 0.0;
  return glm::length(point - a - t * along);
}

}  // namespace

void Outline::find(const world::Camera& camera, std::span<const PlacedBox> boxes) {
  const bool perspective = camera.projection == world::Projection::perspective;
  all_.clear();
  points_.clear();
  width_ = 0;
  for (const PlacedBox& box : boxes)
    for (const Vec3& corner : corners(box.low, box.high)) {
      const Vec3 p(box.camera_from_mesh * Vec4(corner, 1));
      if (perspective && !(p.z > 0)) {
        width_ = HUGE_VAL;
        return;
      }
      all_.push_back(camera.focal * (perspective ? Vec2(p) / p.z : Vec2(p)) + camera.principal);
    }
  std::sort(all_.begin(), all_.end(),
            [](const Vec2& a, const Vec2& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  // the lower chain, then the upper one (Andrew 1979)
  const auto add_chain = [&](const auto& points) {
    const std::size_t first = points_.size();
    for (const Vec2& p : points) {
      while (points_.size() >= first + 2 &&
             turn(points_[points_.size() - 2], points_.back(), p) <= 0)
        points_.pop_back();
      points_.push_back(p);
    }
    if (!points_.empty()) points_.pop_back();  // the other chain begins with it
  };
  add_chain(all_);
  std::reverse(all_.begin(), all_.end());
  add_chain(all_);
  if (points_.size() < 3) return;
  width_ = HUGE_VAL;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vec2& a = points_[i];
    const Vec2& b = points_[(i + 1) % points_.size()];
    const double length = glm::length(b - a);
    if (!(length > 0)) continue;
    double farthest = 0;
    for (const Vec2& p : points_) farthest = std::max(farthest, turn(a, b, p) / length);
    width_ = std::min(width_, farthest);
  }
}

double Outline::distance(const Vec2& point) const {
  double nearest = HUGE_VAL;
  bool inside = points_.size() > 2;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vec2& a = points_[i];
    const Vec2& b = points_[(i + 1) % points_.size()];
    inside = inside && turn(a, b, point) >= 0;
    nearest = std::min(nearest, distance_to_segment(point, a, b));
  }
  return inside ? 0 : nearest;
}

}  // namespace panwright::preview
