#include "preview/frame/light_view.h"

#include <algorithm>
#include <cmath>

namespace panwright::preview {

Mat4 model_from_sample(const world::Camera& camera, const world::Pose& pose, const AxisBox& bounds,
                       const VisibleTarget& visible) {
  const bool perspective = camera.projection == world::Projection::perspective;
  double near = INFINITY;
  for (const PlacedBox& box : visible.boxes)
    for (const Vec3& corner : corners(box.low, box.high))
      near = std::min(near, (box.camera_from_mesh * Vec4(corner, 1)).z);
  near = std::max(near, 0.0);
  const Vec2 middle = (0.5 * Vec2(camera.width, camera.height) - camera.principal) / camera.focal;
  const Vec3 seen = perspective ? near * Vec3(middle, 1) : Vec3(middle, near);
  const Quat model_from_world = glm::conjugate(pose.rotation);
  const Vec3 in_model =
      model_from_world * ((camera.position - pose.translation) + camera.world_from_camera * seen);
  Mat4 matrix(glm::mat3_cast(model_from_world));
  matrix[3] = Vec4(glm::clamp(in_model, bounds.low, bounds.high), 1);
  return matrix;
}

}  // namespace panwright::preview
