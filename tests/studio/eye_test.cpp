// Where one looks from: against vectors worked out by hand, and what options make of it.
#include "studio/eye.h"

#include <gtest/gtest.h>

#include <cmath>

#include "world/camera.h"

namespace panwright::studio {
namespace {

TEST(Eye, DirectionsAndPhase) {
  Eye eye;
  eye.azimuth = 90;
  eye.elevation = 0;
  eye.sun_azimuth = 0;
  eye.sun_elevation = 60;
  EXPECT_LE(glm::length(eye.direction() - Vec3(0, 1, 0)), 1e-15);
  EXPECT_LE(glm::length(eye.sun() - Vec3(0.5, 0, std::sqrt(0.75))), 1e-15);
  EXPECT_NEAR(eye.phase(), 90, 1e-13);
  eye.sun_azimuth = 90;
  eye.sun_elevation = 1e-7;
  EXPECT_NEAR(eye.phase(), 1e-7, 1e-14);  // acos would give 0
}

// A drag to the right turns the model to the right, so the camera to the left; whatever is done,
// no number leaves its range.
TEST(Eye, TurnsAndStaysInRange) {
  Eye eye;
  eye.azimuth = 170;
  eye.turn(-0.1, 0);
  EXPECT_NEAR(eye.azimuth, -172, 1e-12);
  for (int i = 0; i < 100; ++i) eye.turn(0.37, 0.2), eye.zoom(10), eye.turn_sun(0.3, -0.3);
  EXPECT_LT(eye.elevation, 90);
  EXPECT_EQ(eye.range, kFarthest);
  EXPECT_EQ(eye.sun_elevation, 90);
  for (int i = 0; i < 200; ++i) eye.zoom(0.5);
  EXPECT_EQ(eye.range, kNearest);
}

// What is under the mouse stays under it while it shifts the picture.
TEST(Eye, ShiftFollowsTheMouse) {
  Eye eye;
  eye.azimuth = 33;
  eye.elevation = -20;
  eye.range = 40;
  eye.fov = 50;
  constexpr std::uint32_t kSide = 500;
  const auto place = [&](const Vec3& point) {
    DiagnosticLog log;
    world::Camera camera;
    world::set_field_of_view(camera, kSide, kSide, eye.fov * kDegree);
    camera.position = eye.centre + eye.range * eye.direction();
    camera.world_from_camera = *world::looking_at(camera.position, eye.centre, {}, log);
    return *world::project(camera, point);
  };
  const Vec3 point = eye.centre;
  const Vec2 before = place(point);
  eye.shift(0.1, -0.2);
  const Vec2 after = place(point);
  EXPECT_NEAR(after.x - before.x, 0.1 * kSide, 1e-9);
  EXPECT_NEAR(after.y - before.y, -0.2 * kSide, 1e-9);
}

// A sphere fills the narrow side of the image.
TEST(Eye, FramesASphere) {
  for (const double aspect : {0.5, 1.0, 2.0})
    for (const double fov : {0.01, 30.0, 120.0}) {
      Eye eye;
      eye.fov = fov;
      eye.frame_all({{1, 2, 3}, 7}, aspect);  // height over width
      const double seen = std::asin(7 / eye.range);
      const double half = std::atan(std::tan(fov * kDegree / 2) * std::min(1.0, aspect));
      EXPECT_LT(seen, half) << aspect << ' ' << fov;
      EXPECT_GT(seen, 0.8 * half) << aspect << ' ' << fov;
    }
}

TEST(Eye, CommandLineIsTheView) {
  Eye eye;
  eye.centre = {1, 0, 0};
  eye.azimuth = 0;
  eye.elevation = 0;
  eye.range = 9;
  eye.joints["a b/wing"] = "10deg";
  eye.shadows = "soft";
  eye.auto_ev = false;
  eye.ev = -1.5;
  EXPECT_EQ(command_line(eye, 640, 480, {"it's.pan"}, "out.png"),
            "panwright render 'it'\\''s.pan' -o out.png --camera '10 0 0' --look-at '1 0 0' --fov 30 "
            "--sun '0.813797681 -0.296198133 0.5' --size 640x480 --ev -1.5 --shadows soft "
            "--joint 'a b/wing=10deg'");
}

// Roll, then pitch, then yaw, about the world's axes.
TEST(Eye, PosesOfTargets) {
  Standing place;
  place.turned = {90, 0, 90};
  const Vec3 up = place.rotation() * Vec3(0, 0, 1);  // to −y by the roll, to +x by the yaw
  EXPECT_NEAR(glm::length(up - Vec3(1, 0, 0)), 0, 1e-15);
  place.turned = {0, 90, 90};
  EXPECT_NEAR(glm::length(place.rotation() * Vec3(0, 0, 1) - Vec3(0, 1, 0)), 0, 1e-15);
  Eye eye;
  eye.poses["client"] = {{1, -2.5, 0}, {0, 0, 180}};
  const std::string command = command_line(eye, 64, 48, {"a.pan", "client=b.pan"}, "out.png");
  const auto pose = command.find(" --pose 'client=1 -2.5 0 ");
  ASSERT_NE(pose, std::string::npos) << command;
  const workspace::ViewText text = view_text(eye, 64, 48);
  ASSERT_EQ(text.poses.size(), 1u);
  EXPECT_NE(command.find("'client=" + text.poses[0].value + "'"), std::string::npos) << command;
}

}  // namespace
}  // namespace panwright::studio
