// Camera files: what each format says, what is refused and where, and the way back.
#include "sensor/camera_file.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace panwright::sensor::camera_file_test {
namespace {

std::optional<CameraFile> read(const std::string& text, std::string* problems = nullptr) {
  DiagnosticLog log;
  const auto camera = read_camera(text, "camera", log);
  EXPECT_EQ(camera.ok(), !log.has_errors()) << to_text(log);
  if (problems != nullptr)
    *problems = to_text(log);
  else
    EXPECT_TRUE(log.entries().empty()) << to_text(log);
  if (!camera) return std::nullopt;
  return *camera;
}

const Brown kBrown{{-.2, .1, 4e-3, -3e-3, .02}};

// One camera as each program would write it: 1920 x 1200, f 2988.5 2988.25, c 960 600 in the middle
// of a pixel, five terms (Kalibr: four).
constexpr const char* kOwn = R"(# a comment
name = "left"
size = [1920, 1200]
focal = [2988.5, 2988.25]
principal = [960.5, 600.5]
distortion = "brown"
coefficients = [-0.2, 0.1, 4e-3, -3e-3, 0.02]
)";
constexpr const char* kOpenCv = R"(%YAML:1.0
---
calibration_time: "Mon 02 Mar 2026"
image_width: 1920
image_height: 1200
flags: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 2988.5, 0., 960., 0.,
       2988.25, 600., 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -0.2, 1.0e-01, 4.0e-03,
       -3.0e-03, 2.0e-02 ]
)";
constexpr const char* kRos = R"(image_width: 1920
image_height: 1200
camera_name: left
camera_matrix:
  rows: 3
  cols: 3
  data: [2988.5, 0, 960, 0, 2988.25, 600, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.2, 0.1, 0.004, -0.003, 0.02]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
)";
constexpr const char* kKalibr = R"(cam0:
  cam_overlaps: []
  camera_model: pinhole
  distortion_coeffs: [-0.2, 0.1, 0.004, -0.003]
  distortion_model: radtan
  intrinsics: [2988.5, 2988.25, 960.0, 600.0]
  resolution: [1920, 1200]
  rostopic: /left/image_raw
)";
constexpr const char* kSpeed = R"({"Nu": 1920, "Nv": 1200, "ppx": 5.86e-6, "ppy": 5.86e-6,
 "fx": 0.017512, "fy": 0.017512, "ccx": 960, "ccy": 600,
 "cameraMatrix": [[2988.5, 0, 960], [0, 2988.25, 600], [0, 0, 1]],
 "distCoeffs": [-0.2, 0.1, 0.004, -0.003, 0.02]}
)";

// A message CameraInfo of ROS 2.
constexpr const char* kMessage = R"(header:
  frame_id: left
height: 1200
width: 1920
distortion_model: plumb_bob
d: [-0.2, 0.1, 0.004, -0.003, 0.02]
k: [2988.5, 0.0, 960.0, 0.0, 2988.25, 600.0, 0.0, 0.0, 1.0]
r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
binning_x: 0
binning_y: 0
)";

TEST(CameraFile, OneCameraInEachFormat) {
  for (const char* text : {kOwn, kOpenCv, kRos, kMessage, kKalibr, kSpeed}) {
    SCOPED_TRACE(text);
    const auto camera = read(text);
    ASSERT_TRUE(camera);
    EXPECT_EQ(camera->width, 1920u);
    EXPECT_EQ(camera->height, 1200u);
    EXPECT_EQ(camera->lens.focal, Vec2(2988.5, 2988.25));
    EXPECT_EQ(camera->lens.principal, Vec2(960.5, 600.5));
    Brown expected = kBrown;
    if (text == kKalibr) expected.k[4] = 0;
    EXPECT_EQ(camera->lens.distortion, Distortion(expected));
  }
}

TEST(CameraFile, OtherLenses) {
  const auto opencv = read(
      "%YAML:1.0\nimage_width: 640\nimage_height: 480\nfisheye_model: 1\n"
      "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
      "   data: [ 300, 0, 319.5, 0, 300, 239.5, 0, 0, 1 ]\n"
      "distortion_coefficients: [ .1, .2, .3, .4 ]\n");
  ASSERT_TRUE(opencv);
  EXPECT_EQ(opencv->lens.distortion, Distortion(Fisheye{{.1, .2, .3, .4}}));
  EXPECT_EQ(opencv->lens.principal, Vec2(320, 240));
  const auto kalibr = read(
      "cam0:\n  camera_model: pinhole\n  distortion_model: equidistant\n"
      "  distortion_coeffs: [.1, .2, .3, .4]\n  intrinsics: [300, 300, 319.5, 239.5]\n"
      "  resolution: [640, 480]\n");
  ASSERT_TRUE(kalibr);
  EXPECT_EQ(kalibr->lens, opencv->lens);
  // metres: a lens of 17.6 mm over pixels of 5.86 um
  const auto speed =
      read(R"({"Nu":1920,"Nv":1200,"ppx":5.86e-6,"ppy":5.86e-6,"fx":0.0176,"fy":0.0176})");
  ASSERT_TRUE(speed);
  EXPECT_NEAR(speed->lens.focal.x, 3003.413, 1e-3);
  const auto own = read("size = 1024\nfocal_length_mm = 17.6\npixel_um = 5.86\n");
  ASSERT_TRUE(own);
  EXPECT_NEAR(own->lens.focal.y, 3003.413, 1e-3);
  EXPECT_EQ(own->lens.principal, Vec2(512));
  EXPECT_EQ(own->lens.distortion, Distortion(Pinhole{}));
  const auto cahvore = read(
      "size = 1024\nfocal = 700\ndistortion = \"cahvore\"\naxis = [0, 0.02, 2]\n"
      "r = [1e-3, 2e-3, 3e-3]\ne = [1e-4, 0, 0]\nlinearity = 0.5\n");
  ASSERT_TRUE(cahvore);
  const auto& terms = std::get<Cahvore>(cahvore->lens.distortion);
  EXPECT_NEAR(glm::length(terms.axis), 1, 1e-15);
  EXPECT_EQ(terms.linearity, 0.5);
}

// A window shows what the whole detector shows there.
TEST(CameraFile, RegionAndBinning) {
  const std::string part = "\nregion = [100, 60, 1601, 1003]\nbinning = [2, 2]\n";
  for (const char* lens : {"distortion = \"brown\"\ncoefficients = [-0.2, 0.1, 4e-3, -3e-3, 0.02]",
                           "distortion = \"powers\"\ncoefficients = [1e-3, -2.8e-5, 1e-9, 0, 0]"}) {
    const std::string whole = std::string("size = [1920, 1200]\nfocal = 2988.5\n") + lens;
    const auto full = read(whole), window = read(whole + part);
    ASSERT_TRUE(full && window);
    EXPECT_EQ(window->width, 800u);
    EXPECT_EQ(window->height, 501u);
    const DistortionMap all(full->lens.distortion), own(window->lens.distortion);
    const auto plane = [](const Lens& of, const Vec2& pixel) {
      return (pixel - of.principal) / of.focal;
    };
    for (const Vec2& pixel : {Vec2(0), Vec2(17, 400), Vec2(800, 501)}) {
      const auto ray = own.ray(plane(window->lens, pixel)),
                 same = all.ray(plane(full->lens, 2.0 * pixel + Vec2(100, 60)));
      ASSERT_TRUE(ray && same);
      EXPECT_LE(glm::length(ray->direction - same->direction), 1e-15);
    }
  }
  // the same from ROS
  const auto ros = read(std::string(kRos) +
                        "binning_x: 2\nbinning_y: 2\nroi:\n  x_offset: 100\n  y_offset: 60\n"
                        "  height: 1003\n  width: 1601\n  do_rectify: false\n");
  ASSERT_TRUE(ros);
  EXPECT_EQ(ros->height, 501u);
  EXPECT_EQ(ros->lens.principal, Vec2(860.5, 540.5) / 2.0);
}

// Metres across the image, in place of a lens; parts of it keep the metres of a pixel.
TEST(CameraFile, Orthographic) {
  const auto whole = read("size = [640, 480]\nwidth_m = 12.8");
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->width_m, 12.8);
  EXPECT_EQ(whole->lens.focal, Vec2(50));
  EXPECT_EQ(whole->lens.principal, Vec2(320, 240));
  const auto part =
      read("size = [640, 480]\nwidth_m = 12.8\nregion = [160, 120, 320, 240]\nbinning = [2, 2]");
  ASSERT_TRUE(part);
  EXPECT_EQ(part->width, 160u);
  EXPECT_EQ(part->width_m, 6.4);
  DiagnosticLog log;
  const auto text = camera_text(*part, CameraFormat::toml, log);
  ASSERT_TRUE(text);
  const auto back = read(*text);
  ASSERT_TRUE(back) << *text;
  EXPECT_EQ(back->width_m, 6.4);
  EXPECT_FALSE(camera_text(*part, CameraFormat::opencv, log));
}

// SPEED+'s starter kit asks for focal lengths and pixels in metres, and for five coefficients.
TEST(CameraFile, SpeedIsThatOfItsStarterKit) {
  CameraFile camera{.name = "", .width = 640, .height = 480};
  camera.lens = {
      .focal = {701.1, 702.7}, .principal = {320.123, 239.7}, .distortion = Brown{{.1, .2}}};
  DiagnosticLog log;
  auto text = camera_text(camera, CameraFormat::speed, log);
  ASSERT_TRUE(text);
  EXPECT_NE(text->find(R"("distCoeffs": [0.1, 0.2, 0.0, 0.0, 0.0])"), std::string::npos) << *text;
  const std::size_t at = text->find(R"("cameraMatrix")");
  ASSERT_NE(at, std::string::npos);
  const auto back = read(text->erase(at, text->find("]],") + 3 - at));
  ASSERT_TRUE(back) << *text;
  // rounding of a product and a quotient: 1.1e-13 measured
  EXPECT_LE(glm::length(back->lens.focal - camera.lens.focal), 3e-13);
  EXPECT_LE(glm::length(back->lens.principal - camera.lens.principal), 1e-13);
}

// Cameras that a format holds come back from its text.
TEST(CameraFile, TextReadsBack) {
  CameraFile camera{.name = "a \"b\"", .width = 640, .height = 480};
  camera.lens = {.focal = {701.1, 702.7}, .principal = {320.123, 239.7}, .distortion = {}};
  std::vector<std::pair<Distortion, std::vector<CameraFormat>>> cases;
  using enum CameraFormat;
  cases.push_back({Pinhole{}, {toml, opencv, ros, kalibr, speed}});
  cases.push_back({Brown{{.1, .2, .3, .4}}, {toml, opencv, ros, kalibr, speed}});
  cases.push_back({kBrown, {toml, opencv, ros, speed}});
  cases.push_back({Brown{{.1, 0, 0, 0, 0, 0, 0, .2}}, {toml, opencv, ros}});
  cases.push_back({Brown{{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, .13, .14}}, {toml, opencv, ros}});
  cases.push_back({Fisheye{{.1, .2, .3, .4}}, {toml, opencv, ros, kalibr}});
  cases.push_back({Division{-.3}, {toml}});
  cases.push_back({RadialPowers{{1e-3, -2.8e-2}}, {}});
  cases.push_back({Cahvore{.r = {1, 2, 3}, .e = {4, 5, 6}, .linearity = -.5}, {toml}});
  for (const auto& [distortion, formats] : cases) {
    camera.lens.distortion = distortion;
    for (const CameraFormat format : {toml, opencv, ros, kalibr, speed}) {
      SCOPED_TRACE(std::to_string(distortion.index()) + ", " +
                   std::to_string(static_cast<int>(format)));
      DiagnosticLog log;
      const auto text = camera_text(camera, format, log);
      const bool holds = std::ranges::find(formats, format) != formats.end();
      ASSERT_EQ(text.ok(), holds) << to_text(log);
      if (!holds) continue;
      const auto back = read(*text);
      ASSERT_TRUE(back) << *text;
      EXPECT_EQ(back->width, 640u);
      EXPECT_EQ(back->height, 480u);
      EXPECT_EQ(back->lens.focal, camera.lens.focal);
      EXPECT_LE(glm::length(back->lens.principal - camera.lens.principal), 1e-13);
      EXPECT_EQ(back->lens.distortion, distortion);
    }
  }
}

TEST(CameraFile, Refused) {
  const std::pair<std::string, std::string> cases[] = {
      {"", "size is missing"},
      {"size = 1024", "focal is missing"},
      {"size = 1024\nfocal = -3", "camera:1:1: error: focal lengths are not above 0"},
      {"size = 0\nfocal = 3", "camera:1:8: error: size is not of whole numbers"},
      {"size = 20000\nfocal = 3", "16384"},
      {"size = [1, 2, 3]\nfocal = 3", "size has 3 numbers, expected 1 or 2"},
      {"size = \"big\"\nfocal = 3", "size is text, expected numbers"},
      {"size = 9\nfocal = 3\nfocal_length_mm = 2\npixel_um = 1", "not both"},
      {"size = 9\nfocal_length_mm = 2", "pixel_um is missing"},
      {"size = 9\nfocal = 3\npricipal = [1, 2]",
       "camera:3:12: error: 'pricipal' is no member of a camera"},
      {"size = 9\nfocal = 3\npricipal = [1, 2]", "did you mean 'principal'?"},
      {"size = 9\nfocal = 3\ncoefficients = [1]",
       "'coefficients' is no member of a camera, or has no effect beside the others"},
      {"size = 9\nfocal = 3\ndistortion = \"brwn\"", "did you mean 'brown'?"},
      {"size = 9\nfocal = 3\ndistortion = \"brown\"", "coefficients is missing"},
      {"size = 9\nfocal = 3\ndistortion = \"brown\"\ncoefficients = [1, 2, 3]",
       "coefficients has 3 numbers"},
      {"size = 9\nfocal = nan", "numbers"},
      {"size = 9\nfocal = 3\nregion = [5, 0, 5, 9]", "do not fit"},
      {"size = 9\nfocal = 3\nbinning = [10, 1]", "do not fit"},
      {"size = 9\nwidth_m = 0", "camera:2:11: error: width_m is not above 0 m"},
      {"size = 9\nwidth_m = 3\nfocal = 9", "'focal' is no member of a camera, or has no effect"},
      {"size = 9\nwidth_m = 3\nregion = [0, 0, 4, 4]", "reads the middle of its image"},
      {"size = 9\nfocal = [3, 4]\ndistortion = \"powers\"\ncoefficients = [1]", "square ones"},
      {"size = 9\nfocal = 3\ndistortion = \"cahvore\"\naxis = [1, 0, 0]", "60 degrees"},
      {"size = 9\nsize = 8", "camera:2:"},
      {"size = [1,\n", "invalid TOML"},
      {"[1, 2]", "the text is a list, expected a camera"},
      {"image_width: 3\nimage_width: 4\n", "camera:2:1: error: 'image_width' is given twice"},
      {"image_width: [\n", "invalid YAML"},
      {"image_width: 640\nimage_height: 480\ncamera_matrix: [1, 2]\n", "has 2 numbers, expected 9"},
      {"image_width: 640\nimage_height: 480\n", "camera_matrix is missing"},
      {"image_width: 640.5\nimage_height: 480\ncamera_matrix: [1,0,0,0,1,0,0,0,1]\n",
       "image_width is not a whole number"},
      {"image_width: 640\nimage_height: 480\ncamera_matrix: [1,0,0,0,1,0,0,0,2]\n",
       "camera_matrix is not [fx 0 cx"},
      {"cam0:\n  camera_model: omni\n  intrinsics: [1, 1, 1, 1]\n  resolution: [9, 9]\n",
       "camera_model is 'omni', expected pinhole"},
      {"cam0:\n  intrinsics: [1, 1, 1, 1]\n  resolution: [9, 9]\n  distortion_model: fov\n"
       "  distortion_coeffs: [1]\n",
       "distortion_model is 'fov'"},
      {"image_width: 9\nimage_height: 9\ndistortion_model: thin\n"
       "camera_matrix: [1,0,0,0,1,0,0,0,1]\n",
       "expected plumb_bob, rational_polynomial or equidistant"},
      {"a: &a [x, x, x, x, x, x, x, x, x, x]\nb: &b [*a, *a, *a, *a, *a, *a, *a, *a, *a, *a]\n"
       "c: &c [*b, *b, *b, *b, *b, *b, *b, *b, *b, *b]\n"
       "d: &d [*c, *c, *c, *c, *c, *c, *c, *c, *c, *c]\n"
       "e: &e [*d, *d, *d, *d, *d, *d, *d, *d, *d, *d]\n"
       "f: &f [*e, *e, *e, *e, *e, *e, *e, *e, *e, *e]\n"
       "g: [*f, *f, *f, *f, *f, *f, *f, *f, *f, *f]\n",
       "more than 1000000 values"},
      {"a: " + std::string(5000, '[') + "\n", "invalid YAML"},
      {"a: " + std::string(100, '[') + std::string(100, ']') + "\n", "more than 64 deep"},
      {"a = " + std::string(5000, '[') + "\n", "invalid TOML"},
      {std::string("image_width: \0\xff\xfe\n", 17), "camera"},
  };
  for (const auto& [text, expected] : cases) {
    SCOPED_TRACE(text.substr(0, 200));
    std::string problems;
    EXPECT_FALSE(read(text, &problems));
    EXPECT_NE(problems.find(expected), problems.npos) << problems;
    EXPECT_NE(problems.find("[E0220]"), problems.npos) << problems;
  }
}

TEST(CameraFile, MountIsAUnitQuaternion) {
  const auto camera = read(std::string(kOwn) + "mount = [0.6, 0, 0.8, 0]\n");
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->mount_from_camera, Quat(0.6, 0, 0.8, 0));
  DiagnosticLog log;
  const auto text = camera_text(*camera, CameraFormat::toml, log);
  ASSERT_TRUE(text);
  EXPECT_EQ(read(*text)->mount_from_camera, camera->mount_from_camera);
  EXPECT_FALSE(camera_text(*camera, CameraFormat::ros, log));
  std::string problems;
  EXPECT_FALSE(read(std::string(kOwn) + "mount = [1, 1, 0, 0]\n", &problems));
  EXPECT_NE(problems.find("unit quaternion"), problems.npos) << problems;
}

TEST(CameraFile, IgnoredPartsAreSaid) {
  std::string problems;
  std::string turned = kRos;
  turned.replace(turned.rfind("[1, 0, 0"), 8, "[0.9, 0, 0");
  EXPECT_TRUE(read(turned, &problems));
  EXPECT_NE(problems.find("rectification"), problems.npos) << problems;
  EXPECT_TRUE(read(std::string(kKalibr) + "cam1:\n  camera_model: pinhole\n", &problems));
  EXPECT_NE(problems.find("only the first camera"), problems.npos) << problems;
  EXPECT_NE(problems.find("[W0221]"), problems.npos) << problems;
}

// Metres of SPEED's camera.json are those of the camera's own pixels, where they are known.
TEST(CameraFile, SpeedHasThePixelsOfTheCamera) {
  const std::string lens = "size = [64, 48]\nfocal_length_mm = 16\n";
  const std::string detector = "[optics]\naperture_mm = 4\n[detector]\nexposure_s = 0.01\n";
  const std::pair<std::string, Vec2> cases[] = {
      {lens + "pixel_um = 4.8\n", Vec2(4.8)},
      {lens + "pixel_um = [4.8, 5]\n", Vec2(4.8, 5)},
      {lens + "pixel_um = 4.8\nbinning = [2, 4]\n", Vec2(9.6, 19.2)},
      {lens + "pixel_um = 4.8\nbinning = [2, 2]\n" + detector, Vec2(9.6)},
      {"size = [64, 48]\nfocal = 3000\n" + detector + "pixel_um = 7\n", Vec2(7)},
      {"size = [64, 48]\nfocal = 3000\n", Vec2(5.86)},
  };
  for (const auto& [text, expected] : cases) {
    SCOPED_TRACE(text);
    const auto camera = read(text);
    ASSERT_TRUE(camera);
    DiagnosticLog log;
    const auto own = camera_text(*camera, CameraFormat::toml, log);
    ASSERT_TRUE(own) << to_text(log);
    for (const std::string& from : {text, *own}) {
      const auto speed = camera_text(*read(from), CameraFormat::speed, log);
      ASSERT_TRUE(speed) << to_text(log);
      const auto back = read(*speed);
      ASSERT_TRUE(back && back->pixel_um) << *speed;
      // rounding of two products: 2e-15 measured
      EXPECT_LE(glm::length(*back->pixel_um - expected), 1e-14) << *speed;
    }
  }
  std::string problems;
  EXPECT_FALSE(read("size = 9\nfocal = 3\npixel_um = 0\n", &problems));
  EXPECT_THAT(problems, testing::HasSubstr("pixel_um is not above 0"));
}

}  // namespace
}  // namespace panwright::sensor::camera_file_test
