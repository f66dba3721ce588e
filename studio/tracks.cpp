#include "studio/tracks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "studio/clip.h"

namespace panwright::studio {
namespace {

constexpr int kSideSteps = 16;       // of each side of the field of view: a lens bends it
constexpr double kNearPlane = 1e-6;  // of the distance of the farther end

class TrackLines {
 public:
  explicit TrackLines(const world::Camera& camera)
      : camera_(camera),
        camera_from_world_(glm::transpose(glm::mat3_cast(camera.world_from_camera))) {}

  void add(TrackLine::Kind kind, const Vec3& from, const Vec3& to) {
    Vec3 a = camera_from_world_ * (from - camera_.position),
         b = camera_from_world_ * (to - camera_.position);
    if (camera_.projection == world::Projection::perspective && !in_front(a, b)) return;
    const Vec2 start = pixel(a), way = pixel(b) - start;
    if (const auto part = visible_part(start, start + way, Vec2(camera_.width, camera_.height)))
      lines_.push_back({kind, start + part->first * way, start + part->second * way});
  }

  std::vector<TrackLine> take() { return std::move(lines_); }

 private:
  static bool in_front(Vec3& a, Vec3& b) {
    const double nearest = kNearPlane * std::max({glm::length(a), glm::length(b), 1e-300});
    if (a.z < nearest && b.z < nearest) return false;
    if (a.z < nearest) a = b + (a - b) * ((b.z - nearest) / (b.z - a.z));
    if (b.z < nearest) b = a + (b - a) * ((a.z - nearest) / (a.z - b.z));
    return true;
  }

  Vec2 pixel(const Vec3& p) const {
    const bool perspective = camera_.projection == world::Projection::perspective;
    return camera_.principal + camera_.focal * Vec2(p.x, p.y) / (perspective ? p.z : 1.0);
  }

  const world::Camera& camera_;
  Mat3 camera_from_world_;
  std::vector<TrackLine> lines_;
};

// World point of a pixel at a depth along the boresight. Rays more than 84 degrees off it end at
// ten times that distance.
std::optional<Vec3> point_of(const world::Camera& camera, const Vec2& pixel, double depth) {
  const auto ray = world::distorted_ray(camera, pixel);
  if (!ray) return std::nullopt;
  const Vec3 forward = camera.world_from_camera * Vec3(0, 0, 1);
  const double along = glm::dot(ray->direction, forward);
  return ray->origin + ray->direction * (depth / std::max(along, 0.1));
}

void add_field_of_view(const world::Camera& camera, double depth, TrackLines& lines) {
  using Kind = TrackLine::Kind;
  const Vec2 size(camera.width, camera.height);
  const Vec2 corners[] = {{0, 0}, {size.x, 0}, size, {0, size.y}};
  for (std::size_t side = 0; side < 4; ++side) {
    const Vec2 from = corners[side], to = corners[(side + 1) % 4];
    std::optional<Vec3> before = point_of(camera, from, depth);
    if (before) {
      const auto origin = world::distorted_ray(camera, from)->origin;
      lines.add(Kind::field_of_view, origin, *before);
    }
    for (int k = 1; k <= kSideSteps; ++k) {
      const auto point = point_of(camera, from + (to - from) * (double(k) / kSideSteps), depth);
      if (before && point) lines.add(Kind::field_of_view, *before, *point);
      before = point;
    }
  }
  // above: the upper side of the image, row 0
  const auto left = point_of(camera, {0.35 * size.x, 0}, depth),
             right = point_of(camera, {0.65 * size.x, 0}, depth),
             middle = point_of(camera, 0.5 * size, depth),
             top = point_of(camera, {0.5 * size.x, 0}, depth);
  if (!left || !right || !middle || !top) return;
  const Vec3 tip = *top + 0.3 * (*top - *middle);
  lines.add(Kind::field_of_view, *left, tip);
  lines.add(Kind::field_of_view, tip, *right);
}

}  // namespace

std::vector<TrackLine> track_lines(const world::Camera& camera, const Play& play,
                                   const Moment& moment, const Vec3& centre) {
  using Kind = TrackLine::Kind;
  TrackLines lines(camera);
  const world::Camera& own = moment.frame.camera();
  for (const Track& track : play.tracks)
    for (std::size_t k = 1; k < track.points.size(); ++k) {
      const Vec3 &from = track.points[k - 1], &to = track.points[k];
      if (!track.target.empty()) {
        lines.add(Kind::target, from, to);
      } else if (track.numbers[k] <= moment.number || track.numbers[k - 1] >= moment.number) {
        lines.add(track.numbers[k] <= moment.number ? Kind::past : Kind::future, from, to);
      } else {
        lines.add(Kind::past, from, own.position);
        lines.add(Kind::future, own.position, to);
      }
    }
  const Vec3 way = centre - own.position;
  const double depth = glm::dot(way, own.world_from_camera * Vec3(0, 0, 1));
  // towards the targets, else a part of the way to them
  const double length = depth > 0 ? depth : 0.25 * glm::length(way);
  if (length > 0) add_field_of_view(own, length, lines);
  return lines.take();
}

}  // namespace panwright::studio
