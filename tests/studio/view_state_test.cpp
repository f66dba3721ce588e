// Camera and Sun of a view against vectors computed by hand, and its options.
#include "studio/view_state.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "studio/play.h"
#include "world/camera.h"

namespace panwright::studio {
namespace {

TEST(ViewState, DirectionsAndPhase) {
  ViewState view;
  view.camera.azimuth = 90;
  view.camera.elevation = 0;
  view.sun_azimuth = 0;
  view.sun_elevation = 60;
  EXPECT_LE(glm::length(view.camera.direction() - Vec3(0, 1, 0)), 1e-15);
  EXPECT_LE(glm::length(view.sun() - Vec3(0.5, 0, std::sqrt(0.75))), 1e-15);
  EXPECT_NEAR(view.phase(), 90, 1e-13);
  view.sun_azimuth = 90;
  view.sun_elevation = 1e-7;
  EXPECT_NEAR(view.phase(), 1e-7, 1e-14);  // acos would give 0
}

// A drag to the right turns the model to the right, so the camera to the left; whatever is done,
// no number leaves its range.
TEST(OrbitCamera, TurnsAndStaysInRange) {
  ViewState view;
  OrbitCamera& camera = view.camera;
  camera.azimuth = 170;
  camera.turn(-0.1, 0);
  EXPECT_NEAR(camera.azimuth, -172, 1e-12);
  for (int i = 0; i < 100; ++i) camera.turn(0.37, 0.2), camera.zoom(10), view.turn_sun(0.3, -0.3);
  EXPECT_LT(camera.elevation, 90);
  EXPECT_EQ(camera.range, kFarthest);
  EXPECT_EQ(view.sun_elevation, 90);
  for (int i = 0; i < 200; ++i) camera.zoom(0.5);
  EXPECT_EQ(camera.range, kNearest);
}

// A shifted point stays under the mouse.
TEST(OrbitCamera, ShiftFollowsTheMouse) {
  OrbitCamera camera;
  camera.azimuth = 33;
  camera.elevation = -20;
  camera.range = 40;
  camera.fov = 50;
  constexpr std::uint32_t kSide = 500;
  const auto place = [&](const Vec3& point) {
    DiagnosticLog log;
    world::Camera drawn;
    world::set_field_of_view(drawn, kSide, kSide, camera.fov * kDegree);
    drawn.position = camera.position();
    drawn.world_from_camera = *world::looking_at(drawn.position, camera.centre, {}, log);
    return *world::project(drawn, point);
  };
  const Vec3 point = camera.centre;
  const Vec2 before = place(point);
  camera.shift(0.1, -0.2);
  const Vec2 after = place(point);
  EXPECT_NEAR(after.x - before.x, 0.1 * kSide, 1e-9);
  EXPECT_NEAR(after.y - before.y, -0.2 * kSide, 1e-9);
}

// A sphere fills the narrow side of the image.
TEST(OrbitCamera, FramesASphere) {
  for (const double aspect : {0.5, 1.0, 2.0})
    for (const double fov : {0.01, 30.0, 120.0}) {
      OrbitCamera camera;
      camera.fov = fov;
      camera.frame_all({{1, 2, 3}, 7}, aspect);  // height over width
      const double radius = std::asin(7 / camera.range);
      const double half = std::atan(std::tan(fov * kDegree / 2) * std::min(1.0, aspect));
      EXPECT_LT(radius, half) << aspect << ' ' << fov;
      EXPECT_GT(radius, 0.8 * half) << aspect << ' ' << fov;
    }
}

// A site near a pole is seen from above its ground, whatever the direction was.
TEST(OrbitCamera, FramesASiteFromAbove) {
  const Vec3 up = glm::normalize(Vec3(0.02, 0.03, -1));
  OrbitCamera camera;
  camera.frame_all({1737400.0 * up, 500, up, true}, 1);
  EXPECT_GT(glm::dot(camera.direction(), up), 0.6);
  const OrbitCamera above = camera;
  camera.frame_all({1737400.0 * up, 500, up, true}, 1);
  EXPECT_EQ(camera, above);
  // a spacecraft may be seen from below
  camera.elevation = -40;
  camera.frame_all({Vec3(0), 500}, 1);
  EXPECT_EQ(camera.elevation, -40);
}

// Ground is lit at first, from behind the camera; a Sun above its horizon stays.
TEST(ViewState, ASunBelowTheHorizonIsRaised) {
  for (const Vec3& up :
       {glm::normalize(Vec3(0.02, 0.03, -1)), glm::normalize(Vec3(-1, 0.4, -0.2))}) {
    ViewState view;
    view.camera.frame_all({1737400.0 * up, 500, up, true}, 1);
    ASSERT_LT(glm::dot(view.sun(), up), 0);
    view.raise_sun(up);
    EXPECT_GT(glm::dot(view.sun(), up), 0.7);
    EXPECT_NEAR(view.phase(), std::atan(0.6 * std::sqrt(2.0)) / kDegree, 1e-9);
  }
  ViewState view;
  const Vec3 before = view.sun();
  view.raise_sun({0, 0, 1});
  EXPECT_EQ(view.sun(), before);
}

TEST(ViewState, CommandLineIsTheView) {
  ViewState view;
  view.camera.centre = {1, 0, 0};
  view.camera.azimuth = 0;
  view.camera.elevation = 0;
  view.camera.range = 9;
  view.joints["a b/wing"] = "10deg";
  view.shadows = workspace::Settings::Shadows::soft;
  view.indirect = workspace::Settings::Indirect::automatic;
  view.auto_ev = false;
  view.ev = -1.5;
  EXPECT_EQ(command_line(view, 640, 480, {"it's.pan"}, "out.png"),
            "panwright render 'it'\\''s.pan' -o out.png --camera '10 0 0' --look-at '1 0 0' "
            "--joint 'a b/wing=10deg' --sun '0.813797681 -0.296198133 0.5' --fov 30 --size 640x480 "
            "--ev -1.5 --shadows soft --indirect auto");
}

// Roll, then pitch, then yaw, about the world's axes.
TEST(ViewState, PosesOfTargets) {
  TargetPose pose;
  pose.angles = {90, 0, 90};
  const Vec3 up = pose.rotation() * Vec3(0, 0, 1);  // to −y by the roll, to +x by the yaw
  EXPECT_NEAR(glm::length(up - Vec3(1, 0, 0)), 0, 1e-15);
  pose.angles = {0, 90, 90};
  EXPECT_NEAR(glm::length(pose.rotation() * Vec3(0, 0, 1) - Vec3(0, 1, 0)), 0, 1e-15);
  ViewState view;
  view.poses["client"] = {{1, -2.5, 0}, {0, 0, 180}};
  const std::string command = command_line(view, 64, 48, {"a.pan", "client=b.pan"}, "out.png");
  const auto option = command.find(" --pose 'client=1 -2.5 0 ");
  ASSERT_NE(option, std::string::npos) << command;
  const auto poses =
      workspace::setting_texts(workspace::SettingId::pose, settings_of(view, 64, 48));
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_NE(command.find("'" + poses[0] + "'"), std::string::npos) << command;
}

// The tab Sky writes options of `render`; what is left out is that of the models.
TEST(ViewState, SkyAndLampsAreOptions) {
  ViewState view;
  view.scene_distance = view.sun_distance = 2;
  view.sky.lamps = {{"port/nav red", "off"}, {"port/flood", "intensity 8"}};
  view.sky.camera_lamp = 1.5;
  DiagnosticLog log;
  for (const auto& [id, text] : std::initializer_list<std::pair<workspace::SettingId, const char*>>{
           {workspace::SettingId::planet, "earth=off"},
           {workspace::SettingId::planet, "moon=1e8 0 0"},
           {workspace::SettingId::stars, "4.5"},
           {workspace::SettingId::sky, "sun"}})
    EXPECT_TRUE(workspace::read_setting(id, text, view.sky.settings, log));
  const std::string command = command_line(view, 64, 48, {"port.pxn"}, "out.png");
  for (const char* option :
       {"--lamp 'port/flood intensity 8' --lamp 'port/nav red off' --lamp 'spot on camera "
        "intensity "
        "1.5'",
        "--planet earth=off --planet 'moon=1e8 0 0'", "--stars 4.5", "--sky sun"})
    EXPECT_NE(command.find(option), std::string::npos) << option << "\n" << command;
  EXPECT_EQ(command.find("--sun-distance"), std::string::npos) << command;
  view.sun_distance = 1;
  EXPECT_NE(command_line(view, 64, 48, {"port.pxn"}, "out.png").find("--sun-distance 1"),
            std::string::npos);
}

// Lamps of a scenario's camera stay where that camera is; those of the window come behind.
TEST(ViewState, LampsOfAScenarioFromOutside) {
  auto moment = std::make_shared<Moment>();
  const std::string text = "led on camera intensity 3";
  moment->view.settings.lamp = std::vector{text};
  world::Lamp lamp;
  lamp.source = light::Spot{.intensity = Vec3(3), .half_angle = kPi / 2, .exponent = 1};
  lamp.carrier = world::Lamp::Carrier::camera;
  moment->frame.lamps = std::vector{lamp};
  moment->frame.sun = world::Sun();
  world::Camera camera;
  camera.position = {7, 0, 0};
  moment->frame.instrument = workspace::CameraInstrument(camera, true);
  ViewState view;
  view.moment = moment;
  EXPECT_EQ(settings_of(view, 8, 8).lamp->at(0), text);
  view.from_outside = true;
  view.sky.camera_lamp = 5;
  const auto lamps = *settings_of(view, 8, 8).lamp;
  ASSERT_EQ(lamps.size(), 2u);
  EXPECT_TRUE(lamps[0].starts_with("spot at 7 0 0 toward 7 0 1 intensity 3 3 3 half-angle"))
      << lamps[0];
  EXPECT_EQ(lamps[1], "spot on camera intensity 5");
}

}  // namespace
}  // namespace panwright::studio
