#include "workspace/frame.h"

#include <gtest/gtest.h>

#include <cmath>

#include "compiler/compile.h"
#include "image/image.h"
#include "tests/support/process.h"
#include "workspace/quantities.h"
#include "workspace/record.h"
#include "world/evaluation.h"

namespace panwright::workspace::views_test {
namespace {

// A ball of radius 2 about (10, 20, 30), with a frame "camera" on it.
world::ModelPtr model_with_frame() {
  static const world::ModelPtr model = [] {
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
    auto opened = pan::Model::from_bytes(*bytes, "m.pan", log);
    EXPECT_TRUE(opened->check(log));
    return std::make_shared<const pan::Model>(std::move(*opened));
  }();
  return model;
}

world::World world_of(const std::vector<std::string>& names) {
  world::World world;
  DiagnosticLog log;
  for (const std::string& name : names) EXPECT_TRUE(world.add(name, model_with_frame(), log));
  return world;
}

Frame frame_of(const Settings& settings, const world::World& world = world_of({"m"})) {
  DiagnosticLog log;
  const auto frame = FrameMaker(world).frame(settings, log);
  EXPECT_TRUE(frame) << to_text(log);
  return frame ? *frame : Frame{};
}

Code error_of(const Settings& settings, const world::World& world = world_of({"m"})) {
  DiagnosticLog log;
  EXPECT_FALSE(FrameMaker(world).frame(settings, log));
  return log.entries().empty() ? Code("E0101") : log.entries()[0].code;
}

// As typed.
Settings typed(SettingId id, const std::string& value) {
  DiagnosticLog log;
  Settings settings;
  EXPECT_TRUE(read_setting(id, value, settings, log)) << to_text(log);
  return settings;
}

Code refusal_of(SettingId id, const std::string& value) {
  DiagnosticLog log;
  Settings settings;
  EXPECT_FALSE(read_setting(id, value, settings, log)) << value;
  EXPECT_EQ(settings, Settings());
  return log.entries().empty() ? Code("E0101") : log.entries()[0].code;
}

// Whether every point of the ball of a target, posed, falls onto the image.
void expect_in_view(const Frame& view, const world::Pose& pose) {
  for (int i = 0; i < 200; ++i) {  // a spiral over the sphere
    const double z = -1 + (i + 0.5) / 100, r = std::sqrt(1 - z * z);
    const Vec3 p = Vec3(10, 20, 30) + 2.0 * Vec3(r * std::cos(2.4 * i), r * std::sin(2.4 * i), z);
    const auto pixel = world::project(view.camera(), Vec3(pose.matrix() * Vec4(p, 1)));
    ASSERT_TRUE(pixel);
    EXPECT_GE(pixel->x, 0);
    EXPECT_GE(pixel->y, 0);
    EXPECT_LE(pixel->x, view.camera().width);
    EXPECT_LE(pixel->y, view.camera().height);
  }
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
  Settings wide, tall;
  wide.size = ImageSize{800, 300};
  tall.size = ImageSize{300, 800};
  for (const Settings& options : {Settings{}, wide, tall}) expect_in_view(frame_of(options), {});
}

TEST(MakeView, TheDefaultSeesAllVisibleTargets) {
  world::World world = world_of({"a", "b", "far"});
  world.set_visible(2, false);
  const world::Pose near{{30, -5, 2}, {0, 0, 0, 1}};
  Settings text;
  text.pose = {{"b", near}, {"far", {{1000, 0, 0}, {1, 0, 0, 0}}}};
  const Frame view = frame_of(text, world);
  expect_in_view(view, {});
  expect_in_view(view, near);
  // what is not visible has no say
  EXPECT_LT(glm::length(view.camera().position), 300);
  world.set_visible(2, true);
  EXPECT_GT(glm::length(frame_of(text, world).camera().position), 1000);
}

// Of a default camera the outline of what is seen lies in the middle and is 85 % of the side
// that it fills first. A ball, and two balls far apart, which a sphere around both would show
// small.
TEST(MakeView, TheDefaultFitsTheOutline) {
  world::World two = world_of({"a", "b"});
  two.set_pose(1, {{60, -30, 5}, Quat(1, 0, 0, 0)});
  for (const world::World& world : {world_of({"m"}), two})
    for (const char* size : {"300x300", "400x200", "200x400"}) {
      Settings text = typed(SettingId::size, size);
      const Frame view = frame_of(text, world);
      Vec2 low(1e9), high(-1e9);
      for (const world::Instance& target : world.instances())
        for (int i = 0; i < 4000; ++i) {
          const double z = -1 + (i + 0.5) / 2000, r = std::sqrt(1 - z * z);
          const Vec3 p =
              Vec3(10, 20, 30) + 2.0 * Vec3(r * std::cos(2.4 * i), r * std::sin(2.4 * i), z);
          const auto pixel =
              world::project(view.camera(), Vec3(target.pose().matrix() * Vec4(p, 1)));
          ASSERT_TRUE(pixel);
          low = glm::min(low, Vec2(*pixel));
          high = glm::max(high, Vec2(*pixel));
        }
      const Vec2 image(view.camera().width, view.camera().height);
      const Vec2 filled = (high - low) / image, off = 0.5 * (low + high) / image - 0.5;
      // the mesh of 16 by 16 lies up to 2 % within the ball
      EXPECT_NEAR(std::max(filled.x, filled.y), 0.85, 0.025) << size;
      EXPECT_NEAR(off.x, 0, 0.01) << size;
      EXPECT_NEAR(off.y, 0, 0.01) << size;
    }
}

TEST(MakeView, FieldOfViewIsHorizontalAndFull) {
  Settings options;
  options.fov = 40 * kDegree;
  options.size = ImageSize{640, 480};
  const Frame view = frame_of(options);
  EXPECT_DOUBLE_EQ(view.camera().focal.x, 320 / std::tan(20 * kDegree));
  EXPECT_EQ(view.camera().principal, Vec2(320, 240));
  EXPECT_DOUBLE_EQ(frame_of(typed(SettingId::ifov, "0.5mrad")).camera().focal.x, 2000);
  const Frame pinhole = frame_of(typed(SettingId::intrinsics, "1000,1100,300,200"));
  EXPECT_EQ(pinhole.camera().focal, Vec2(1000, 1100));
}

// Of a line of pixels the model takes a share that can be seen.
TEST(MakeView, LinesOfPixelsShowTheModel) {
  for (const char* size : {"16384x1", "1x16384"}) {
    Settings text = typed(SettingId::size, size);
    const Frame view = frame_of(text);
    const double distance = glm::length(view.camera().position - Vec3(10, 20, 30));
    // across, of a ball of radius 2
    const double pixels = 2 * view.camera().focal.x * std::tan(std::asin(2 / distance));
    // 85 % of a fourth of them; its mesh lies up to 2 % within it
    EXPECT_NEAR(pixels, 0.85 * 16384 / 4, 100) << size;
  }
}

TEST(MakeView, LensesHaveAFiniteFocalLength) {
  EXPECT_EQ(error_of(typed(SettingId::fov, "1e-300")), Code("E0201"));
  EXPECT_EQ(error_of(typed(SettingId::ifov, "1e-300")), Code("E0201"));
  EXPECT_EQ(error_of(typed(SettingId::ortho, "1e-300")), Code("E0201"));
  EXPECT_EQ(error_of(typed(SettingId::intrinsics, "1e300,1,1,1")), Code("E0201"));
  EXPECT_GT(frame_of(typed(SettingId::fov, "1e-11rad")).camera().focal.x, 1e14);
}

// A recorded field of view stays one; what a record says of it and of names that are not UTF-8
// comes back.
TEST(Record, KeepsFieldsOfViewAndNamesOfAnyBytes) {
  const world::World world = world_of({"m"});
  const auto keeps = [](const Frame& frame) {
    return std::get<CameraInstrument>(frame.instrument).field_of_view;
  };
  Settings text;
  text.size = ImageSize{640, 480};
  text.fov = 20 * kDegree;
  const Frame view = frame_of(text, world);
  EXPECT_TRUE(keeps(view));
  const std::string name = "odd\xff\xfe.pxn";
  image::Image image;
  image.width = image.height = 1;
  image.radiance = {0, 0, 0};
  image.coverage = {0};
  image.metadata = {{image::kRecordName, record_text(world, view, {{name}, {}})}};
  const support::TemporaryFolder folder;
  DiagnosticLog log;
  ASSERT_TRUE(image::write_image(folder / "a.png", image, 0, log));
  auto record = read_record(folder / "a.png", log);
  ASSERT_TRUE(record) << to_text(log);
  EXPECT_EQ(record->targets[0].file, name);
  ASSERT_TRUE(record->view.field_of_view);
  Settings& settings = record->view.settings;
  const ImageSize other{1280, 96};
  keep_field_of_view(settings, other);
  settings.size = other;
  text.size = other;
  EXPECT_EQ(frame_of(settings, world).camera().focal, frame_of(text, world).camera().focal);
  EXPECT_EQ(frame_of(settings, world).camera().principal, Vec2(640, 48));
  EXPECT_FALSE(keeps(frame_of(typed(SettingId::intrinsics, "500,500,320,240"), world)));
}

TEST(MakeView, LooksAtTheOriginAndSeesTheSunOverTheLeftShoulder) {
  Settings options;
  options.camera = Vec3(0, -100, 0);
  const Frame view = frame_of(options);
  const Vec3 boresight = view.camera().world_from_camera * Vec3(0, 0, 1);
  EXPECT_NEAR(boresight.y, 1, 1e-15);
  const Vec3 right = view.camera().world_from_camera * Vec3(1, 0, 0);
  EXPECT_LT(glm::dot(view.sun->direction, right), 0);
  EXPECT_LT(glm::dot(view.sun->direction, boresight), 0);
  EXPECT_GT(view.sun->direction.z, 0);
}

TEST(MakeView, ACameraCanSitInAFrame) {
  Settings options;
  options.camera_frame = "camera";
  EXPECT_EQ(frame_of(options).camera().position, Vec3(10, 20, 32));
  options.camera_frame = "m/camera";
  EXPECT_EQ(frame_of(options).camera().position, Vec3(10, 20, 32));
  options.camera_frame = "camra";
  EXPECT_EQ(error_of(options), Code("E5005"));
  options.camera_frame = "m/camra";
  EXPECT_EQ(error_of(options), Code("E5005"));
}

TEST(MakeView, AFrameOfOneOfSeveralTargetsIsNamedWithIt) {
  const world::World world = world_of({"chaser", "client"});
  Settings options = typed(SettingId::pose, "client=1 2 3 1 0 0 0");
  options.camera_frame = "client/camera";
  EXPECT_EQ(frame_of(options, world).camera().position, Vec3(11, 22, 35));
  options.camera_frame = "camera";  // of which?
  EXPECT_EQ(error_of(options, world), Code("E5005"));
  options.camera_frame = "clien/camera";
  EXPECT_EQ(error_of(options, world), Code("E5005"));
}

TEST(MakeView, ThePoseMovesTheModelNotTheCamera) {
  Settings options;
  options.camera = Vec3(0, -5, 0);
  for (const char* name : {"", "m"}) {
    options.pose = {{name, {{1, 2, 3}, {0, 0, 0, 1}}}};
    const Frame view = frame_of(options);
    EXPECT_EQ(view.camera().position, Vec3(0, -5, 0));
    ASSERT_EQ(view.poses.size(), 1u);
    EXPECT_EQ(view.poses[0].target, "m");
    const world::Pose& pose = view.poses[0].pose;
    EXPECT_EQ(pose.translation, Vec3(1, 2, 3));
    const Vec4 p = pose.matrix() * Vec4(1, 0, 0, 1);
    EXPECT_NEAR(p.x, 0, 1e-15);
    EXPECT_NEAR(p.y, 2, 1e-15);
  }
}

TEST(MakeView, PosesAreOfTargetsThatAreThere) {
  const world::World world = world_of({"chaser", "client"});
  const auto with = [](const char* name) {
    Settings settings;
    settings.pose = {{name, {{1, 2, 3}, {1, 0, 0, 0}}}};
    return settings;
  };
  EXPECT_EQ(frame_of(with("client"), world).poses[0].target, "client");
  EXPECT_EQ(error_of(with("clients"), world), Code("E5011"));
  EXPECT_EQ(error_of(with(""), world), Code("E0201")) << "of which target?";
  EXPECT_EQ(error_of(with("n")), Code("E5011"));
  EXPECT_EQ((*typed(SettingId::pose, "client=1 2 3 1 0 0 0").pose)[0].target, "client");
  EXPECT_EQ((*typed(SettingId::pose, "1 2 3 1 0 0 0").pose)[0].target, "");
}

TEST(MakeView, RefusesWhatCannotBe) {
  const std::pair<SettingId, const char*> wrong[] = {{SettingId::camera, "0 0"},
                                                     {SettingId::sun, "0 0 0"},
                                                     {SettingId::fov, "0"},
                                                     {SettingId::fov, "180"},
                                                     {SettingId::size, "0x10"},
                                                     {SettingId::size, "99999x1"},
                                                     {SettingId::quat, "2 0 0 0"},
                                                     {SettingId::pose, "1 2 3"},
                                                     {SettingId::pose, "m=1 2 3 2 0 0 0"},
                                                     {SettingId::ev, "bright"},
                                                     {SettingId::ortho, "-1"},
                                                     {SettingId::sun_irradiance, "-1"},
                                                     {SettingId::white, "1 -1 0"},
                                                     {SettingId::white, "bright"},
                                                     {SettingId::sun_distance, "0"}};
  for (const auto& [id, value] : wrong) EXPECT_EQ(refusal_of(id, value), Code("E0201")) << value;
  EXPECT_EQ(error_of(typed(SettingId::output, "a.gif")), Code("E0202"));
  Settings both;
  both.fov = 10 * kDegree;
  both.ortho = 3;
  EXPECT_EQ(error_of(both), Code("E0201"));
  Settings here;
  here.camera = Vec3(1, 2, 3);
  here.look_at = Vec3(1, 2, 3);
  EXPECT_EQ(error_of(here), Code("E0201"));
}

}  // namespace
}  // namespace panwright::workspace::views_test
