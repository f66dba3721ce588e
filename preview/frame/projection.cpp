#include <algorithm>
#include <cmath>

#include "base/axis_box.h"
#include "preview/frame/projection.h"

namespace panwright::preview {
namespace {

// a row vector times a matrix
Vec4 times(const Vec4& row, const Mat4& matrix) { return glm::transpose(matrix) * row; }

}  // namespace

std::array<Vec3, 8> corners(const Vec3& low, const Vec3& high) {
  std::array<Vec3, 8> points;
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = Vec3(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
  return points;
}

Mat4 camera_from(const world::Camera& camera, const Mat4& world_from_mesh) {
  const Mat3 rotation = glm::mat3_cast(glm::conjugate(camera.world_from_camera));
  const Vec3 offset = rotation * (Vec3(world_from_mesh[3]) - camera.position);
  Mat4 result(rotation * Mat3(world_from_mesh));
  result[3] = Vec4(offset, 1);
  return result;
}

DepthRange fitted_depth(world::Projection projection, std::span<const PlacedBox> boxes) {
  double low = INFINITY;
  double high = 0;
  double size = 0;
  for (const PlacedBox& box : boxes) {
    double box_low = INFINITY;
    double box_high = -INFINITY;
    double box_size = 0;
    for (const Vec3& corner : corners(box.low, box.high)) {
      const double z = (box.camera_from_mesh * Vec4(corner, 1)).z;
      box_low = std::min(box_low, z);
      box_high = std::max(box_high, z);
      box_size = std::max(box_size, glm::length(Mat3(box.camera_from_mesh) * corner));
    }
    if (!(box_high > 0)) continue;
    low = std::min(low, box_low);
    high = std::max(high, box_high);
    size = std::max(size, box_size);
  }
  if (!(high > 0)) return {};
  // 2^-16 of the size is 256 roundings of a float32 position; 2^-44 of the distance as many of a
  // double one
  const double pad = std::max({(high - low) * 0x1p-10, size * 0x1p-16, high * 0x1p-44, 0x1p-900});
  DepthRange range;
  range.far = high + pad;
  const double least = projection == world::Projection::perspective ? range.far * 0x1p-30 : 0.0;
  range.near = std::max(low - pad, least);
  return range;
}

ClipRows clip_rows(const world::Camera& camera, const Tile& tile, const DepthRange& range) {
  const Vec2 scale = 2.0 * camera.focal / Vec2(tile.width, tile.height);
  const Vec2 shift =
      2.0 * (camera.principal - Vec2(tile.x, tile.y)) / Vec2(tile.width, tile.height) - 1.0;
  const double span = range.far - range.near;
  if (camera.projection == world::Projection::orthographic)
    return {{scale.x, 0, 0, shift.x},
            {0, scale.y, 0, shift.y},
            {0, 0, -1 / span, range.far / span},
            {0, 0, 0, 1}};
  const double factor = range.near / span;
  return {{scale.x, 0, shift.x, 0},
          {0, scale.y, shift.y, 0},
          {0, 0, -factor, factor * range.far},
          {0, 0, 1, 0}};
}

Mat4 clip_from_mesh(const world::Camera& camera, const Tile& tile, const DepthRange& range,
                    const Mat4& camera_from_mesh) {
  const ClipRows rows = clip_rows(camera, tile, range);
  Vec4 z = times(rows.z, camera_from_mesh);
  z.w = -rows.z.z * (range.far - camera_from_mesh[3].z);
  return glm::transpose(Mat4(times(rows.x, camera_from_mesh), times(rows.y, camera_from_mesh), z,
                             times(rows.w, camera_from_mesh)));
}

bool may_touch(const world::Camera& camera, const Tile& tile, double margin, const PlacedBox& box) {
  const ClipRows rows = clip_rows(camera, tile, DepthRange{});
  const double edge_x = 1 + 2 * margin / tile.width;
  const double edge_y = 1 + 2 * margin / tile.height;
  // bit k stays set while every corner lies outside plane k
  unsigned outside = 31;
  for (const Vec3& corner : corners(box.low, box.high)) {
    const Vec4 point = box.camera_from_mesh * Vec4(corner, 1);
    const double x = glm::dot(rows.x, point);
    const double y = glm::dot(rows.y, point);
    const double w = glm::dot(rows.w, point);
    unsigned here = 0;
    if (x > edge_x * w) here |= 1;
    if (x < -edge_x * w) here |= 2;
    if (y > edge_y * w) here |= 4;
    if (y < -edge_y * w) here |= 8;
    if (!(point.z > 0)) here |= 16;
    outside &= here;
  }
  return outside == 0;
}

Tile touched_part(const world::Camera& camera, const Tile& tile, std::span<const PlacedBox> boxes,
                  std::span<const std::uint32_t> which) {
  AxisRectangle bounds;
  for (const std::uint32_t index : which)
    for (const Vec3& corner : corners(boxes[index].low, boxes[index].high)) {
      const Vec3 p(boxes[index].camera_from_mesh * Vec4(corner, 1));
      const bool perspective = camera.projection == world::Projection::perspective;
      if (perspective && !(p.z > 0)) return tile;
      bounds.add(camera.focal * (perspective ? Vec2(p) / p.z : Vec2(p)) + camera.principal);
    }
  const Vec2 first(tile.x, tile.y);
  const Vec2 last = first + Vec2(tile.width, tile.height);
  const Vec2 low = glm::clamp(glm::floor(bounds.low) - 1.0, first, last);
  const Vec2 high = glm::clamp(glm::ceil(bounds.high) + 1.0, first, last);
  if (!(high.x > low.x && high.y > low.y)) return {tile.x, tile.y, 0, 0};
  return {static_cast<std::uint32_t>(low.x), static_cast<std::uint32_t>(low.y),
          static_cast<std::uint32_t>(high.x - low.x), static_cast<std::uint32_t>(high.y - low.y)};
}

}  // namespace panwright::preview
