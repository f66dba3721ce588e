#include "labels/internal/image_plane.h"

#include <algorithm>
#include <variant>

namespace panwright::labels {

namespace {

constexpr double kChord = 0.005;  // pixels: from a curved edge to its chain
constexpr double kStraight = 2;   // pixels: shorter edges have no curvature that shows
constexpr unsigned kMostSplits = 12;

double largest_of(const Vec3& v) {
  return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

void emit(const Vec2& a, const Vec2& b, const Vec2& c, std::optional<std::uint32_t> number,
          PlacedTriangles& out) {
  out.triangles.push_back({a, b, c});
  if (number) out.numbers.push_back(*number);
  for (const Vec2& p : {a, b, c}) out.box.add(p);
}

// The part of a triangle in front of the camera, without distortion.
void emit_clipped(const ImagePlane& plane, const std::array<Vec3, 3>& corners,
                  std::optional<std::uint32_t> number, PlacedTriangles& out) {
  out.cut = true;
  double far = 0;
  for (const Vec3& p : corners) far = std::max(far, largest_of(p));
  // far beyond the image, and within what doubles resolve there
  const double near = plane.orthographic() ? 0 : 1e-7 * far;
  std::array<Vec2, 4> places;
  std::size_t count = 0;
  const auto add = [&](const Vec3& p) {
    if (const auto at = plane.place(p)) places[count++] = *at;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &a = corners[k], &b = corners[(k + 1) % 3];
    if (a.z > near) add(a);
    if ((a.z > near) == (b.z > near)) continue;
    // from the same end for both triangles of an edge
    const bool forth = a.z < b.z;
    const Vec3 &low = forth ? a : b, &high = forth ? b : a;
    Vec3 cut = low + (near - low.z) / (high.z - low.z) * (high - low);
    cut.z = plane.orthographic() ? std::numeric_limits<double>::min() : near;
    add(cut);
  }
  for (std::size_t k = 2; k < count; ++k) emit(places[0], places[k - 1], places[k], number, out);
}

double chord_distance(const Vec2& a, const Vec2& b, const Vec2& p) {
  const Vec2 along = b - a;
  const double length = glm::length(along);
  if (!(length > 0)) return glm::length(p - a);
  return std::fabs(along.x * (p.y - a.y) - along.y * (p.x - a.x)) / length;
}

// Splits triangles until their edges are straight on the plane.
struct Splitter {
  const ImagePlane& plane;
  std::optional<std::uint32_t> number;
  PlacedTriangles& out;
  AxisRectangle canvas;  // three images wide and high

  PlacedPoint between(const PlacedPoint& a, const PlacedPoint& b, double share) const {
    return placed_point(plane, a.point * (1 - share) + b.point * share);
  }

  // Of the edge alone, so that both triangles agree.
  bool is_curved(const PlacedPoint& a, const PlacedPoint& b) const {
    if (!(glm::length(b.place - a.place) > kStraight)) return false;
    AxisRectangle box;
    box.add(a.place);
    box.add(b.place);
    // beyond the canvas only extents matter
    const double within = box.meets(canvas) ? kChord : 16 * kChord;
    constexpr double kShares[] = {0.25, 0.5, 0.75};
    return std::ranges::any_of(kShares, [&](double share) {
      const PlacedPoint p = between(a, b, share);
      return !p.placed() || chord_distance(a.place, b.place, p.place) > within;
    });
  }

  void split(const PlacedPoint& a, const PlacedPoint& b, const PlacedPoint& c, unsigned depth) {
    const unsigned placed = a.placed() + b.placed() + c.placed();
    if (placed < 3) {
      split_cut(a, b, c, depth, placed);
      return;
    }
    const bool ab = depth < kMostSplits && is_curved(a, b);
    const bool bc = depth < kMostSplits && is_curved(b, c);
    const bool ca = depth < kMostSplits && is_curved(c, a);
    if (!ab && !bc && !ca) {
      emit(a.place, b.place, c.place, number, out);
      return;
    }
    split_at(a, b, c, {ab, bc, ca}, depth + 1);
  }

  // Turned so that the first of the edges to split is ab.
  void split_at(const PlacedPoint& a, const PlacedPoint& b, const PlacedPoint& c,
                std::array<bool, 3> at, unsigned depth) {
    if (!at[0]) {
      split_at(b, c, a, {at[1], at[2], at[0]}, depth);
      return;
    }
    const PlacedPoint ab = between(a, b, 0.5);
    if (at[1] && at[2]) {
      const PlacedPoint bc = between(b, c, 0.5), ca = between(c, a, 0.5);
      split(a, ab, ca, depth);
      split(ab, b, bc, depth);
      split(ca, bc, c, depth);
      split(ab, bc, ca, depth);
    } else if (at[1]) {
      const PlacedPoint bc = between(b, c, 0.5);
      split(ab, b, bc, depth);
      split(a, ab, bc, depth);
      split(a, bc, c, depth);
    } else if (at[2]) {
      const PlacedPoint ca = between(c, a, 0.5);
      split(a, ab, ca, depth);
      split(ab, b, c, depth);
      split(ab, c, ca, depth);
    } else {
      split(a, ab, c, depth);
      split(ab, b, c, depth);
    }
  }

  // Some corners have no place.
  void split_cut(const PlacedPoint& a, const PlacedPoint& b, const PlacedPoint& c, unsigned depth,
                 unsigned placed) {
    constexpr unsigned kMostCuts = 8;
    constexpr unsigned kSurely = 3;  // splits after which three corners without place are enough
    constexpr double kSmall = 1e-3;  // radians
    out.cut = true;
    const double side = std::max({glm::length(b.point - a.point), glm::length(c.point - b.point),
                                  glm::length(a.point - c.point)});
    const double near = std::min({largest_of(a.point), largest_of(b.point), largest_of(c.point)});
    if (depth >= kMostCuts || side < kSmall * near || (placed == 0 && depth >= kSurely)) return;
    split_at(a, b, c, {true, true, true}, depth + 1);
  }
};

}  // namespace

bool ImagePlane::central() const {
  if (orthographic()) return false;
  if (!distorted()) return true;
  const auto* model = std::get_if<sensor::Cahvore>(&camera_.distortion->distortion());
  return model == nullptr || model->e == std::array<double, 3>{};
}

std::optional<Vec2> ImagePlane::place(const Vec3& point) const {
  if (orthographic()) {
    if (!(point.z > 0)) return std::nullopt;
    return camera_.focal * Vec2(point) + camera_.principal;
  }
  if (distorted()) {
    const auto place = camera_.distortion->place(point);
    if (!place) return std::nullopt;
    return camera_.focal * *place + camera_.principal;
  }
  if (!(point.z > 0)) return std::nullopt;
  return camera_.focal * Vec2(point) / point.z + camera_.principal;
}

std::optional<trace::Ray> ImagePlane::view_ray(const Vec2& place) const {
  const Vec2 plane = (place - camera_.principal) / camera_.focal;
  trace::Ray ray;
  if (orthographic()) {
    ray.origin = Vec3(plane, 0);
    ray.direction = Vec3(0, 0, 1);
  } else if (distorted()) {
    const auto through = camera_.distortion->ray(plane);
    if (!through) return std::nullopt;
    ray.origin = through->origin;
    ray.direction = through->direction;
  } else {
    ray.direction = glm::normalize(Vec3(plane, 1));
  }
  return ray;
}

std::optional<trace::Ray> ImagePlane::view_ray_to(const Vec3& point) const {
  trace::Ray ray;
  if (orthographic()) {
    ray.origin = Vec3(point.x, point.y, 0);
  } else if (!central()) {
    const auto at = place(point);
    const auto through = at ? view_ray(*at) : std::nullopt;
    if (!through) return std::nullopt;
    ray.origin = through->origin;
  }
  const Vec3 way = point - ray.origin;
  const double length = glm::length(way);
  if (!(length > 0)) return std::nullopt;
  ray.direction = way / length;
  ray.max_distance = length;
  return ray;
}

PlacedPoint placed_point(const ImagePlane& plane, const Vec3& point) {
  PlacedPoint result;
  result.point = point;
  if (const auto place = plane.place(point)) result.place = *place;
  return result;
}

void add_triangle(const ImagePlane& plane, const PlacedPoint& a, const PlacedPoint& b,
                  const PlacedPoint& c, std::optional<std::uint32_t> number, PlacedTriangles& out) {
  if (plane.distorted()) {
    const world::Camera& camera = plane.camera();
    const Vec2 size(camera.width, camera.height);
    Splitter{plane, number, out, {-size, 2.0 * size}}.split(a, b, c, 0);
    return;
  }
  if (a.placed() && b.placed() && c.placed())
    emit(a.place, b.place, c.place, number, out);
  else
    emit_clipped(plane, {a.point, b.point, c.point}, number, out);
}

}  // namespace panwright::labels
