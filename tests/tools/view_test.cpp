#include "tools/view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "compiler/compile.h"

namespace panwright::tools {
namespace {

pan::Model model_with_frame() {
  scene::Scene scene;
  scene.nodes.push_back({"root", scene::kNone, {}, {}});
  scene.nodes.push_back({"body", 0, {{10, 20, 30}, {1, 0, 0, 0}, Vec3(2)}, {}});
  scene.shapes = {geometry::Sphere{1, {{16, 16}}}};
  scene.materials.emplace_back();
  scene::Instance instance;
  instance.node = 1;
  scene.instances = {instance};
  scene.frames.push_back({"camera", 1, {0, 0, 1}, {1, 0, 0, 0}, {}});
  DiagnosticLog log;
  const auto bytes = compiler::compiled(scene, {}, log);
  auto model = pan::Model::from_bytes(*bytes, "m.pan", log);
  EXPECT_TRUE(model->check(log));
  return std::move(*model);
}

preview::View view_of(const ViewOptions& options) {
  DiagnosticLog log;
  const auto view = make_view(options, model_with_frame(), log);
  EXPECT_TRUE(view) << to_text(log);
  return view ? *view : preview::View{};
}

Code error_of(const ViewOptions& options) {
  DiagnosticLog log;
  EXPECT_FALSE(make_view(options, model_with_frame(), log));
  return log.entries().empty() ? Code::E0101 : log.entries()[0].code;
}

TEST(ParseNumbers, TakesBlanksAndCommas) {
  EXPECT_EQ(*parse_numbers("0 -5 1", 3), (std::vector<double>{0, -5, 1}));
  EXPECT_EQ(*parse_numbers(" 1,2 ,3e2 ", 3), (std::vector<double>{1, 2, 300}));
  EXPECT_FALSE(parse_numbers("1 2", 3));
  EXPECT_FALSE(parse_numbers("1 2 3 4", 3));
  EXPECT_FALSE(parse_numbers("1 2 nan", 3));
}

TEST(ParseAngle, BareNumbersAreDegrees) {
  EXPECT_DOUBLE_EQ(*parse_angle("180"), kPi);
  EXPECT_DOUBLE_EQ(*parse_angle("180deg"), kPi);
  EXPECT_DOUBLE_EQ(*parse_angle("0.2mrad"), 2e-4);
  EXPECT_DOUBLE_EQ(*parse_angle("3urad"), 3e-6);
  EXPECT_DOUBLE_EQ(*parse_angle("1.5rad"), 1.5);
  EXPECT_DOUBLE_EQ(*parse_angle("60arcmin"), kDegree);
  EXPECT_DOUBLE_EQ(*parse_angle("3600arcsec"), kDegree);
  EXPECT_FALSE(parse_angle("1 turn"));
  EXPECT_FALSE(parse_angle("mrad"));
}

TEST(MakeView, TheDefaultSeesTheWholeModel) {
  ViewOptions wide, tall;
  wide.size = "800x300";
  tall.size = "300x800";
  for (const ViewOptions& options : {ViewOptions{}, wide, tall}) {
    const preview::View view = view_of(options);
    for (int i = 0; i < 200; ++i) {  // a spiral over the sphere of radius 2 about (10, 20, 30)
      const double z = -1 + (i + 0.5) / 100, r = std::sqrt(1 - z * z);
      const Vec3 p = Vec3(10, 20, 30) + 2.0 * Vec3(r * std::cos(2.4 * i), r * std::sin(2.4 * i), z);
      const auto pixel = world::project(view.camera, p);
      ASSERT_TRUE(pixel);
      EXPECT_GE(pixel->x, 0);
      EXPECT_GE(pixel->y, 0);
      EXPECT_LE(pixel->x, view.camera.width);
      EXPECT_LE(pixel->y, view.camera.height);
    }
  }
}

TEST(MakeView, FieldOfViewIsHorizontalAndFull) {
  ViewOptions options;
  options.fov = "40";
  options.size = "640x480";
  const preview::View view = view_of(options);
  EXPECT_DOUBLE_EQ(view.camera.focal.x, 320 / std::tan(20 * kDegree));
  EXPECT_EQ(view.camera.principal, Vec2(320, 240));
  options.fov.reset();
  options.ifov = "0.5mrad";
  EXPECT_DOUBLE_EQ(view_of(options).camera.focal.x, 2000);
  options.ifov.reset();
  options.intrinsics = "1000,1100,300,200";
  EXPECT_EQ(view_of(options).camera.focal, Vec2(1000, 1100));
}

TEST(MakeView, LooksAtTheOriginAndSeesTheSunOverTheLeftShoulder) {
  ViewOptions options;
  options.camera = "0 -100 0";
  const preview::View view = view_of(options);
  const Vec3 boresight = view.camera.world_from_camera * Vec3(0, 0, 1);
  EXPECT_NEAR(boresight.y, 1, 1e-15);
  const Vec3 right = view.camera.world_from_camera * Vec3(1, 0, 0);
  EXPECT_LT(glm::dot(view.to_sun, right), 0);
  EXPECT_LT(glm::dot(view.to_sun, boresight), 0);
  EXPECT_GT(view.to_sun.z, 0);
}

TEST(MakeView, ACameraCanSitInAFrame) {
  ViewOptions options;
  options.camera_frame = "camera";
  const preview::View view = view_of(options);
  EXPECT_EQ(view.camera.position, Vec3(10, 20, 32));
  options.camera_frame = "camra";
  EXPECT_EQ(error_of(options), Code::E5005);
}

TEST(MakeView, ThePoseMovesTheModelNotTheCamera) {
  ViewOptions options;
  options.camera = "0 -5 0";
  options.pose = "1 2 3 0 0 0 1";
  const preview::View view = view_of(options);
  EXPECT_EQ(view.camera.position, Vec3(0, -5, 0));
  EXPECT_EQ(view.world_from_model.translation, Vec3(1, 2, 3));
  const Vec4 p = view.world_from_model.matrix() * Vec4(1, 0, 0, 1);
  EXPECT_NEAR(p.x, 0, 1e-15);
  EXPECT_NEAR(p.y, 2, 1e-15);
}

TEST(MakeView, RefusesWhatCannotBe) {
  const auto with = [](std::optional<std::string> ViewOptions::*member, const char* value) {
    ViewOptions options;
    options.*member = value;
    return options;
  };
  EXPECT_EQ(error_of(with(&ViewOptions::camera, "0 0")), Code::E0201);
  EXPECT_EQ(error_of(with(&ViewOptions::sun, "0 0 0")), Code::E0201);
  EXPECT_EQ(error_of(with(&ViewOptions::fov, "0")), Code::E0201);
  EXPECT_EQ(error_of(with(&ViewOptions::fov, "180")), Code::E0201);
  EXPECT_EQ(error_of(with(&ViewOptions::size, "0x10")), Code::E0201);
  EXPECT_EQ(error_of(with(&ViewOptions::size, "99999x1")), Code::E0201);
  EXPECT_EQ(error_of(with(&ViewOptions::quat, "2 0 0 0")), Code::E0201);
  EXPECT_EQ(error_of(with(&ViewOptions::pose, "1 2 3")), Code::E0201);
  EXPECT_EQ(error_of(with(&ViewOptions::ortho, "-1")), Code::E0201);
  EXPECT_EQ(error_of(with(&ViewOptions::sun_irradiance, "-1")), Code::E0201);
  EXPECT_EQ(error_of(with(&ViewOptions::sun_distance, "0")), Code::E0201);
  ViewOptions both = with(&ViewOptions::fov, "10");
  both.ortho = "3";
  EXPECT_EQ(error_of(both), Code::E0201);
  ViewOptions here;
  here.camera = "1 2 3";
  here.look_at = "1 2 3";
  EXPECT_EQ(error_of(here), Code::E0201);
}

}  // namespace
}  // namespace panwright::tools
