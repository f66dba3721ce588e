#include "world/camera.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace panwright::world {
namespace {

// from docs/conventions.md 2
constexpr double kParallelAngle = 1e-6;

bool along(const Vec3& direction, const Vec3& other) {
  const double angle = angle_between(direction, other);
  return angle < kParallelAngle || kPi - angle < kParallelAngle;
}

// the rotation whose z is forward and whose -y lies nearest to up
Quat rotation_from(const Vec3& forward, const Vec3& up) {
  const Vec3 z = glm::normalize(forward);
  const Vec3 x = glm::normalize(glm::cross(z, up));
  return glm::normalize(glm::quat_cast(Mat3(x, glm::cross(z, x), z)));
}

void set_image(Camera& camera, std::uint32_t width, std::uint32_t height, double focal) {
  assert(width > 0 && height > 0 && focal > 0);
  camera.width = width;
  camera.height = height;
  camera.focal = Vec2(focal);
  camera.principal = Vec2(width / 2.0, height / 2.0);
}

// the solid angle of a triangle by its corners and their determinant (Van Oosterom and Strackee,
// "The solid angle of a plane triangle", 1983): of small triangles far off the axis nothing cancels
double triangle_solid_angle(const Vec3& a, const Vec3& b, const Vec3& c, double determinant) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double sum = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
  // of small pixels by the series of atan, whose next term is below 1e-21
  const double t = determinant / sum, square = t * t;
  if (sum > 0 && square < 1e-4)
    return 2 * t * (1 - square * (1.0 / 3 - square * (0.2 - square * (1.0 / 7 - square / 9))));
  return 2 * det::atan2(determinant, sum);
}

// the quadrilateral of a pixel's corners on the sphere
double distorted_solid_angle(const Camera& camera, std::uint32_t column, std::uint32_t row) {
  Vec3 corners[4];
  for (unsigned k = 0; k < 4; ++k) {
    const Vec2 at(column + (k == 1 || k == 2), row + k / 2);
    const auto ray = camera.distortion->ray((at - camera.principal) / camera.focal);
    if (!ray) return 0;
    corners[k] = ray->direction;
  }
  const auto triangle = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return triangle_solid_angle(a, b, c, glm::dot(a, glm::cross(b - a, c - a)));
  };
  return triangle(corners[0], corners[1], corners[2]) +
         triangle(corners[0], corners[2], corners[3]);
}

}  // namespace

void set_field_of_view(Camera& camera, std::uint32_t width, std::uint32_t height, double fov) {
  assert(fov > 0 && fov < kPi);
  set_image(camera, width, height, width / 2.0 / det::tan(fov / 2));
  camera.projection = Projection::perspective;
}

void set_pixel_angle(Camera& camera, std::uint32_t width, std::uint32_t height, double ifov) {
  set_image(camera, width, height, 1 / ifov);
  camera.projection = Projection::perspective;
}

void set_orthographic(Camera& camera, std::uint32_t width, std::uint32_t height, double width_m) {
  set_image(camera, width, height, width / width_m);
  camera.projection = Projection::orthographic;
}

Result<Quat> looking_at(const Vec3& position, const Vec3& target, const std::optional<Vec3>& up,
                        DiagnosticLog& log) {
  const Vec3 line = target - position;
  if (line == Vec3(0) || !is_finite(line)) {
    log.report_file(Code("E0201"), {},
                    line == Vec3(0)
                        ? "the camera is at the point that it looks at, expected another --look-at"
                        : "the camera is too far from the point that it looks at, expected less");
    return failed;
  }
  // squares of the largest and the smallest lengths overflow or underflow a double; powers of two
  // change no bit of the direction
  const double longest = std::max({std::fabs(line.x), std::fabs(line.y), std::fabs(line.z)});
  const Vec3 forward = line * std::ldexp(1.0, std::min(-std::ilogb(longest), 1000));
  if (up && (*up == Vec3(0) || !is_finite(*up))) {
    log.report_file(Code("E0201"), {}, "--up is \"0 0 0\", expected a direction of another length");
    return failed;
  }
  const Vec3 wanted = up.value_or(Vec3(0, 0, 1));
  if (!along(forward, wanted)) return rotation_from(forward, wanted);
  const Vec3 y_axis(0, 1, 0);
  const bool y_is_free = !along(forward, y_axis);
  log.report_file(
      Code("N5004"), {},
      y_is_free ? "the up direction is parallel to the line of sight; +y is used as up"
                : "the up direction and +y are parallel to the line of sight; +z is used as up");
  return rotation_from(forward, y_is_free ? y_axis : Vec3(0, 0, 1));
}

void place_in_frame(Camera& camera, const Mat4& world_from_node, const Vec3& origin,
                    const Quat& node_from_frame) {
  const Mat3 linear = Mat3(world_from_node) * glm::mat3_cast(node_from_frame);
  camera.position = Vec3(world_from_node * Vec4(origin, 1));
  camera.world_from_camera = rotation_from(linear[2], -linear[1]);
}

geometry::Ray pixel_ray(const Camera& camera, const Vec2& pixel) {
  assert(camera.distortion == nullptr);
  const Vec2 plane = (pixel - camera.principal) / camera.focal;
  geometry::Ray ray;
  ray.origin = camera.position;
  if (camera.projection == Projection::perspective) {
    ray.direction = camera.world_from_camera * glm::normalize(Vec3(plane, 1));
  } else {
    ray.origin += camera.world_from_camera * Vec3(plane, 0);
    ray.direction = camera.world_from_camera * Vec3(0, 0, 1);
  }
  return ray;
}

std::optional<geometry::Ray> distorted_ray(const Camera& camera, const Vec2& pixel) {
  if (camera.distortion == nullptr) return pixel_ray(camera, pixel);
  const auto local = camera.distortion->ray((pixel - camera.principal) / camera.focal);
  if (!local) return std::nullopt;
  geometry::Ray ray;
  ray.origin = camera.position + camera.world_from_camera * local->origin;
  ray.direction = camera.world_from_camera * local->direction;
  return ray;
}

double share_without_ray(const Camera& camera) {
  if (camera.distortion == nullptr) return 0;
  constexpr int kSide = 64;
  int missing = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const Vec2 at = Vec2(camera.width, camera.height) * (Vec2(x, y) + 0.5) / double{kSide};
      missing += !camera.distortion->ray((at - camera.principal) / camera.focal);
    }
  return missing / double{kSide * kSide};
}

std::optional<Vec2> project(const Camera& camera, const Vec3& point) {
  const Vec3 local = glm::conjugate(camera.world_from_camera) * (point - camera.position);
  if (camera.projection == Projection::orthographic)
    return camera.focal * Vec2(local) + camera.principal;
  if (camera.distortion != nullptr) {
    const auto place = camera.distortion->place(local);
    if (!place) return std::nullopt;
    return camera.focal * *place + camera.principal;
  }
  if (!(local.z > 0)) return std::nullopt;
  return camera.focal * Vec2(local) / local.z + camera.principal;
}

double pixel_solid_angle(const Camera& camera, std::uint32_t column, std::uint32_t row) {
  assert(camera.projection == Projection::perspective);
  assert(column < camera.width && row < camera.height);
  if (camera.distortion != nullptr) return distorted_solid_angle(camera, column, row);
  // the rectangle on the plane at distance 1, as two triangles
  const Vec2 low = (Vec2(column, row) - camera.principal) / camera.focal;
  const Vec2 side = Vec2(1) / camera.focal;
  const Vec2 high = low + side;
  const Vec3 a(low, 1), b(high.x, low.y, 1), c(high, 1), d(low.x, high.y, 1);
  // six times the volume of either tetrahedron, without a difference of corners
  const double volume = side.x * side.y;
  return triangle_solid_angle(a, b, c, volume) + triangle_solid_angle(a, c, d, volume);
}

double pixel_area(const Camera& camera) {
  assert(camera.projection == Projection::orthographic);
  return 1 / (camera.focal.x * camera.focal.y);
}

}  // namespace panwright::world
