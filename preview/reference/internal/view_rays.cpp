#include "preview/reference/internal/view_rays.h"

#include <array>
#include <cmath>

namespace panwright::preview::reference {
namespace {

// Of a triangle on the plane z = 1, from its corners and twice its area. A. van Oosterom and
// J. Strackee, "The solid angle of a plane triangle", 1983: its triple product is that area, which
// is known without cancellation.
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c, double twice_area) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double other =
      la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
  const double t = twice_area / other;
  const double t2 = t * t;
  // the tangent of half of it: its series is exact where pixels are small
  if (t > 0 && t < 1e-3) return 2 * t * (1 - t2 * (1.0 / 3 - t2 * (1.0 / 5 - t2 / 7)));
  return 2 * det::atan2(twice_area, other);
}

}  // namespace

std::optional<geometry::Ray> view_ray(const world::Camera& camera, const Vec2& place) {
  const Vec2 plane = (place - camera.principal) / camera.focal;
  geometry::Ray ray;
  if (camera.distortion != nullptr) {
    const auto found = camera.distortion->ray(plane);
    if (!found) return std::nullopt;
    ray.origin = found->origin;
    ray.direction = found->direction;
    return ray;
  }
  if (camera.projection == world::Projection::orthographic) {
    ray.origin = Vec3(plane, 0);
    ray.direction = Vec3(0, 0, 1);
  } else {
    ray.origin = Vec3(0);
    ray.direction = Vec3(plane, 1) * (1 / std::sqrt(1 + plane.x * plane.x + plane.y * plane.y));
  }
  return ray;
}

namespace {

// Of the quadrilateral of the corners' directions.
double distorted_weight(const world::Camera& camera, std::uint32_t column, std::uint32_t row) {
  std::array<Vec3, 4> at;
  for (unsigned k = 0; k < 4; ++k) {
    const auto ray = view_ray(camera, Vec2(column + (k == 1 || k == 2), row + k / 2));
    if (!ray) return 0;
    at[k] = ray->direction;
  }
  const auto triangle = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return solid_angle(a, b, c, glm::dot(a, glm::cross(b - a, c - a)));
  };
  return triangle(at[0], at[1], at[2]) + triangle(at[0], at[2], at[3]);
}

}  // namespace

double pixel_weight(const world::Camera& camera, std::uint32_t column, std::uint32_t row) {
  const double area = 1 / (camera.focal.x * camera.focal.y);
  if (camera.projection == world::Projection::orthographic) return area;
  if (camera.distortion != nullptr) return distorted_weight(camera, column, row);
  const auto corner = [&](double x, double y) {
    return Vec3((x - camera.principal.x) / camera.focal.x,
                (y - camera.principal.y) / camera.focal.y, 1);
  };
  const double x = column, y = row;
  const Vec3 a = corner(x, y), b = corner(x + 1, y), c = corner(x + 1, y + 1), d = corner(x, y + 1);
  return solid_angle(a, b, c, area) + solid_angle(a, c, d, area);
}

}  // namespace panwright::preview::reference
