// Samples are placed by small numbers, from an origin near to what is seen.
#include "preview/frame/light_view.h"

#include <gtest/gtest.h>

#include "world/camera.h"

namespace panwright::preview::light_view_test {
namespace {

// A box of a kilometre, far from the world's origin, and a camera before one of its sides.
struct Scene {
  world::Pose pose{{7e6, -2e6, 3e5}, glm::angleAxis(0.7, glm::normalize(Vec3(1, 2, -1)))};
  AxisBox bounds{Vec3(-500), Vec3(500)};
  world::Camera camera;
  VisibleTarget visible;

  // at a distance before the point (300, -200) of the upper side, in the model's frame
  explicit Scene(double distance, world::Projection projection) {
    camera.width = 1000;
    camera.height = 800;
    camera.principal = Vec2(500, 400);
    camera.projection = projection;
    camera.focal = Vec2(1000);
    const Quat model_from_camera(0, 1, 0, 0);  // z down, y turned
    camera.world_from_camera = pose.rotation * model_from_camera;
    camera.position = pose.translation + pose.rotation * Vec3(300, -200, 500 + distance);
    visible.boxes.push_back({camera_from(camera, pose.matrix()), bounds.low, bounds.high});
  }
  Vec3 origin() const { return Vec3(model_from_sample(camera, pose, bounds, visible)[3]); }
};

TEST(LightView, TheOriginIsWhereTheImageLooks) {
  for (const auto projection : {world::Projection::perspective, world::Projection::orthographic})
    for (const double distance : {0.5, 20.0, 1e5}) {
      const Scene scene(distance, projection);
      // the camera's place in double has 1e-9 m
      EXPECT_LT(glm::length(scene.origin() - Vec3(300, -200, 500)), 1e-8) << distance;
    }
}

TEST(LightView, TheOriginFollowsACrop) {
  Scene scene(1000, world::Projection::perspective);
  scene.camera.principal = Vec2(400, 400);  // 0.1 rad to the right: x of the model too
  EXPECT_LT(glm::length(scene.origin() - Vec3(400, -200, 500)), 1e-8);
}

TEST(LightView, TheOriginLiesWithinTheBounds) {
  Scene scene(1000, world::Projection::perspective);
  scene.camera.principal = Vec2(-1000, 400);  // beyond its edge
  EXPECT_LT(glm::length(scene.origin() - Vec3(500, -200, 500)), 1e-8);
}

TEST(LightView, ACameraWithinTheBoundsIsTheOrigin) {
  const Scene scene(-3, world::Projection::perspective);
  EXPECT_LT(glm::length(scene.origin() - Vec3(300, -200, 497)), 1e-8);
}

TEST(LightView, AxesAreTheWorlds) {
  const Scene scene(10, world::Projection::perspective);
  const Mat4 matrix = model_from_sample(scene.camera, scene.pose, scene.bounds, scene.visible);
  const Vec3 direction = glm::normalize(Vec3(1, -3, 2));
  const Vec3 back = scene.pose.rotation * (Mat3(matrix) * direction);
  EXPECT_LT(glm::length(back - direction), 1e-15);
}

}  // namespace
}  // namespace panwright::preview::light_view_test
