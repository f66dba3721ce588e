#include <algorithm>
#include <cmath>

#include "base/axis_box.h"
#include "preview/frame/light_space.h"
#include "preview/frame/projection.h"

namespace panwright::preview {
namespace {

// The axis across which the model is longest as the Sun sees it, at a right angle to the Sun.
Vec3 longest_across(const Vec3& size, const Vec3& to_sun) {
  Vec3 longest(0);
  double length = -1;
  for (int k = 0; k < 3; ++k) {
    Vec3 axis(0);
    axis[k] = 1;
    const Vec3 across = axis - to_sun * to_sun[k];
    const double seen = size[k] * glm::length(across);
    // of three axes at right angles one at least is 54 degrees or more off the Sun
    if (!(seen > length) || glm::length(across) < 0.5) continue;
    length = seen;
    longest = glm::normalize(across);
  }
  return longest;
}

AxisBox box_along(std::span<const DrawItem> list, const Mat3& axes_from_model) {
  AxisBox box;
  for (const DrawItem& item : list) {
    if (!item.visible) continue;
    for (const Vec3& corner : corners(item.low, item.high))
      box.add(axes_from_model * Vec3(item.model_from_mesh * Vec4(corner, 1)));
  }
  return box;
}

}  // namespace

LightSpace fitted_light_space(std::span<const DrawItem> list, const Vec3& to_sun, unsigned side) {
  LightSpace frame;
  if (std::none_of(list.begin(), list.end(), [](const DrawItem& item) { return item.visible; }))
    return frame;
  const AxisBox whole = box_along(list, Mat3(1));
  const Vec3 right = longest_across(whole.extent(), to_sun);
  const Mat3 axes_from_model = glm::transpose(Mat3(right, glm::cross(to_sun, right), to_sun));
  frame.axes_from_model = axes_from_model;
  const AxisBox box = box_along(list, axes_from_model);

  Vec3 extent = box.extent();
  // what is seen edge on, or is a point, still has a width to divide by
  const double least = std::max(std::max({extent.x, extent.y, extent.z}) * 0x1p-10, 0x1p-900);
  extent = glm::max(extent, Vec3(least));
  const double wider = static_cast<double>(side) / (side - 4);
  extent *= Vec3(wider, wider, 1 + 0x1p-10);
  frame.extent = extent;

  const Vec3 centre = box.low + 0.5 * (box.high - box.low);
  const Vec3 scale = Vec3(2, 2, 1) / extent;
  const Vec3 shift(0, 0, 0.5);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      frame.sun_from_model[column][row] = scale[row] * axes_from_model[column][row];
    frame.sun_from_model[3][row] = shift[row] - scale[row] * centre[row];
  }
  const Vec3 stretch = Vec3(0.5, 0.5, 1) * extent / std::max({extent.x, extent.y, extent.z});
  for (int column = 0; column < 3; ++column)
    frame.sun_normal_from_model[column] = stretch * axes_from_model[column];
  return frame;
}

LightSpace widened(LightSpace frame, double tangent) {
  const Vec3 before = frame.extent;
  frame.extent += Vec3(Vec2(tangent * before.z), 0);
  const Vec3 ratio = before / frame.extent;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 2; ++row) frame.sun_from_model[column][row] *= ratio[row];
  const Vec3 stretch =
      Vec3(0.5, 0.5, 1) * frame.extent / std::max({frame.extent.x, frame.extent.y, frame.extent.z});
  for (int column = 0; column < 3; ++column)
    frame.sun_normal_from_model[column] = stretch * frame.axes_from_model[column];
  return frame;
}

Vec2 sun_shear(const Vec3& extent, const Vec2& point) {
  return 2.0 * point * extent.z / Vec2(extent);
}

Mat4 sheared(const Vec2& shear) {
  Mat4 matrix(1);
  matrix[2] = Vec4(-shear, 1, 0);
  matrix[3] = Vec4(0.5 * shear, 0, 1);
  return matrix;
}

}  // namespace panwright::preview
