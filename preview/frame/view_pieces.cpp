#include "preview/frame/view_pieces.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/axis_box.h"

namespace panwright::preview {
namespace {

// Points with dot(normal, p) + offset >= 0.
struct Plane {
  Vec3 normal{0};
  double offset = 0;
  double at(const Vec3& p) const { return glm::dot(normal, p) + offset; }
};

bool is_perspective(const world::Camera& camera) {
  return camera.projection == world::Projection::perspective;
}

std::array<Plane, 6> planes_of(const world::Camera& camera, const ViewCell& cell) {
  std::array<Plane, 6> planes;
  for (int axis = 0; axis < 2; ++axis)
    for (int side = 0; side < 2; ++side) {
      const double sign = side == 0 ? 1 : -1;
      const double edge = (side == 0 ? cell.low : cell.high)[axis] - camera.principal[axis];
      Plane& plane = planes[static_cast<std::size_t>(2 * axis + side)];
      plane.normal[axis] = sign * camera.focal[axis];
      (is_perspective(camera) ? plane.normal.z : plane.offset) = -sign * edge;
    }
  planes[4] = {Vec3(0, 0, 1), -cell.near};
  planes[5] = {Vec3(0, 0, -1), cell.far};
  return planes;
}

std::array<Vec3, 8> corners_of(const world::Camera& camera, const ViewCell& cell) {
  std::array<Vec3, 8> points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double z = i & 4 ? cell.far : cell.near;
    const Vec2 pixel(i & 1 ? cell.high.x : cell.low.x, i & 2 ? cell.high.y : cell.low.y);
    const Vec2 at = (pixel - camera.principal) / camera.focal;
    points[i] = Vec3(is_perspective(camera) ? at * z : at, z);
  }
  return points;
}

// of what has corners in the order of corners()
constexpr std::size_t kFaces[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                      {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};

// The six sides of a box; none where it is flat, and its faces say all.
bool sides_of(const std::array<Vec3, 8>& corners, std::array<Plane, 6>& planes) {
  constexpr double kFlat = 1e-9;
  const Vec3 edges[] = {corners[1] - corners[0], corners[2] - corners[0], corners[4] - corners[0]};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3 normal = glm::cross(edges[(axis + 1) % 3], edges[(axis + 2) % 3]);
    const double height = glm::dot(normal, edges[axis]);
    if (!(std::fabs(height) > kFlat * glm::length(normal) * glm::length(edges[axis]))) return false;
    if (height < 0) normal = -normal;
    planes[2 * axis] = {normal, -glm::dot(normal, corners[0])};
    planes[2 * axis + 1] = {-normal, glm::dot(normal, corners[7])};
  }
  return true;
}

struct Polygon {
  std::array<Vec3, 12> points;
  std::size_t count = 0;
  void add(const Vec3& point) {
    if (count < points.size()) points[count++] = point;
  }
};

void clip(Polygon& polygon, const Plane& plane) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Vec3& a = polygon.points[i];
    const Vec3& b = polygon.points[(i + 1) % polygon.count];
    const double at_a = plane.at(a);
    const double at_b = plane.at(b);
    if (at_a >= 0) kept.add(a);
    if ((at_a >= 0) != (at_b >= 0)) kept.add(a + (b - a) * (at_a / (at_a - at_b)));
  }
  polygon = kept;
}

void add_point(const ViewFrame& view, const Vec3& point, ShownPart& part) {
  const world::Camera& camera = *view.camera;
  part.light.add(Vec3(view.light_from_camera * Vec4(point, 1)));
  const double depth = is_perspective(camera) ? std::max(point.z, 0x1p-1000) : 1.0;
  part.view.add(Vec3(camera.focal * Vec2(point) / depth + camera.principal, point.z));
}

void add_clipped(const ViewFrame& view, Polygon polygon, std::span<const Plane> planes,
                 ShownPart& part) {
  for (const Plane& plane : planes) clip(polygon, plane);
  for (std::size_t i = 0; i < polygon.count; ++i) add_point(view, polygon.points[i], part);
}

}  // namespace

void measure(const ViewFrame& view, ViewPiece& piece) {
  AxisBox box;
  for (unsigned i = 0; i < piece.count; ++i)
    box.add(Mat3(view.light_from_camera) * piece.corners[i]);
  const Vec3 extent = box.extent();
  piece.across = std::max(extent.x, extent.y);
  piece.deep = extent.z;
}

ShownPart shown_part(const ViewFrame& view, const ViewCell& cell, const ViewPiece& piece) {
  const std::array<Plane, 6> planes = planes_of(*view.camera, cell);
  ShownPart part;
  // bit k: outside of plane k
  unsigned all = 63;
  unsigned any = 0;
  for (unsigned i = 0; i < piece.count; ++i) {
    unsigned outside = 0;
    for (unsigned k = 0; k < 6; ++k)
      if (planes[k].at(piece.corners[i]) < 0) outside |= 1u << k;
    all &= outside;
    any |= outside;
  }
  if (all != 0) return part;
  if (any == 0) {
    for (unsigned i = 0; i < piece.count; ++i) add_point(view, piece.corners[i], part);
    return part;
  }
  if (piece.count == 3) {
    Polygon triangle;
    for (unsigned i = 0; i < 3; ++i) triangle.add(piece.corners[i]);
    add_clipped(view, triangle, planes, part);
    return part;
  }
  const auto add_faces = [&](const std::array<Vec3, 8>& corners, std::span<const Plane> within) {
    for (const auto& face : kFaces) {
      Polygon polygon;
      for (const std::size_t corner : face) polygon.add(corners[corner]);
      add_clipped(view, polygon, within, part);
    }
  };
  add_faces(piece.corners, planes);
  std::array<Plane, 6> sides;
  if (sides_of(piece.corners, sides)) add_faces(corners_of(*view.camera, cell), sides);
  return part;
}

}  // namespace panwright::preview
