// Lenses against OpenCV's results, closed forms, and their own inverse.
#include "sensor/lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <vector>

#include "tests/support/paths.h"

namespace panwright::sensor::lens_test {
namespace {

// As make_opencv_table.py.
class Numbers {
 public:
  double next() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EB;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1;
  }

 private:
  std::uint64_t state_ = 0;
};

Lens of_unit(const Distortion& distortion) {
  return {.focal = Vec2(1), .principal = Vec2(0), .distortion = distortion};
}

// Largest differences, OpenCV 4.6: 2.5e-16 and 4.0e-16 focal lengths.
TEST(Lens, AsOpenCv) {
  std::ifstream table(std::string(PANWRIGHT_SOURCE_DIR "/tests/sensor/data/opencv.txt"));
  constexpr std::array kBrown{0.3,  0.2,  5e-3, 5e-3, 0.1,  0.1,  0.1,
                              0.05, 5e-3, 5e-3, 5e-3, 5e-3, 0.05, 0.05};
  constexpr std::array kFisheye{0.05, 0.02, 0.01, 0.005};
  Numbers numbers;
  double worst = 0;
  const auto compare = [&](const Lens& lens, double reach) {
    const double x = reach * numbers.next();
    const Vec3 point(x, reach * numbers.next(), 1);
    Vec2 expected;
    ASSERT_TRUE(table >> expected.x >> expected.y);
    const LensMap map(lens);
    for (const double distance : {1.0, 7e5}) {
      const auto got = map.project(distance * point);
      ASSERT_TRUE(got);
      worst = std::max(worst, glm::length(*got - expected));
    }
  };
  for (int k = 0; k < 1000; ++k) {
    Brown brown;
    for (std::size_t term = 0; term < kBrown.size(); ++term)
      brown.k[term] = kBrown[term] * numbers.next();
    compare(of_unit(brown), 0.5);
  }
  EXPECT_LE(worst, 1e-15);
  worst = 0;
  for (int k = 0; k < 1000; ++k) {
    Fisheye fisheye;
    for (std::size_t term = 0; term < kFisheye.size(); ++term)
      fisheye.k[term] = kFisheye[term] * numbers.next();
    compare(of_unit(fisheye), 1.2);
  }
  EXPECT_LE(worst, 1e-15);
}

struct Case {
  const char* name;
  Lens lens;
  double width, height;
};

std::vector<Case> cases() {
  const auto lens = [](double focal, double width, double height, const Distortion& distortion) {
    return Lens{
        .focal = Vec2(focal), .principal = Vec2(width, height) / 2.0, .distortion = distortion};
  };
  std::vector<Case> all;
  // the camera of SPEED+, published
  all.push_back(
      {"SPEED+",
       {.focal = {2988.5795163815555, 2988.3401159176124},
        .principal = {960.5, 600.5},
        .distortion = Brown{{-.22383016606510672, .51409797089106379, -.00066499611998340662,
                             -.00021404771667484594, -.13124227429077406}}},
       1920,
       1200});
  all.push_back({"pinhole", lens(800, 1024, 1024, Pinhole{}), 1024, 1024});
  all.push_back({"wide", lens(900, 1200, 1000, Brown{{-.30}}), 1200, 1000});
  all.push_back(
      {"all terms",
       lens(900, 800, 600,
            Brown{{-.2, .1, 4e-3, -3e-3, .02, .03, -.05, .01, 2e-3, -1e-3, 3e-3, 1e-3, .04, -.03}}),
       800, 600});
  all.push_back(
      {"fisheye", lens(300, 1024, 1024, Fisheye{{-.02, .005, -.001, .0001}}), 1024, 1024});
  all.push_back({"barrel division", lens(300, 1024, 1024, Division{-.2}), 1024, 1024});
  all.push_back({"pincushion division", lens(900, 1024, 1024, Division{.15}), 1024, 1024});
  all.push_back(
      {"powers", lens(10060, 1024, 1000, RadialPowers{{1e-4, -2.8e-5, 0, 1e-12, 0}}), 1024, 1000});
  all.push_back(
      {"CAHVOR",
       {.focal = {1100, 1105},
        .principal = {512, 500},
        .skew = 0.3,
        .distortion = Cahvore{.axis = glm::normalize(Vec3(.01, -.02, 1)), .r = {1e-3, -.12, .03}}},
       1024,
       1024});
  all.push_back({"CAHVORE",
                 {.focal = Vec2(400),
                  .principal = {512, 512},
                  .distortion = Cahvore{.axis = glm::normalize(Vec3(.01, .01, 1)),
                                        .r = {-1e-3, -.05, .01},
                                        .e = {2e-3, 3e-3, -1e-3},
                                        .linearity = .3}},
                 1024,
                 1024});
  all.push_back({"CAHVORE fisheye",
                 {.focal = Vec2(600),
                  .principal = {512, 512},
                  .distortion = Cahvore{.e = {2e-3, 0, 0}, .linearity = 0}},
                 1024,
                 1024});
  return all;
}

// Largest distance of these lenses: 6.7e-13 pixels.
TEST(Lens, RayThenProjectIsThePixel) {
  for (const Case& each : cases()) {
    SCOPED_TRACE(each.name);
    const LensMap map(each.lens);
    int rays = 0, all = 0;
    double worst = 0;
    for (int j = 0; j <= 40; ++j)
      for (int i = 0; i <= 40; ++i) {
        ++all;
        const Vec2 pixel(each.width * i / 40, each.height * j / 40);
        const auto ray = map.ray(pixel);
        if (!ray) continue;
        ++rays;
        EXPECT_NEAR(glm::length(ray->direction), 1, 4e-16);
        for (const double distance : {0.5, 100.0}) {
          const auto back = map.project(ray->origin + distance * ray->direction);
          ASSERT_TRUE(back) << pixel.x << ' ' << pixel.y;
          worst = std::max(worst, glm::length(*back - pixel));
        }
      }
    EXPECT_LE(worst, 1e-11);
    EXPECT_GE(rays, all * 3 / 4);
  }
}

// The other way: any point of the domain comes back, as far as its image is told from others.
TEST(Lens, ProjectThenRayIsTheDirection) {
  for (const Case& each : cases()) {
    SCOPED_TRACE(each.name);
    const LensMap map(each.lens);
    const double widest = 0.98 * std::min(map.domain(), 1.4);
    for (int turn = 0; turn < 12; ++turn)
      for (int step = 0; step <= 20; ++step) {
        const double theta = (widest - 0.03) * step / 20, phi = turn * kPi / 6 + 0.1;
        const Vec3 direction(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                             std::cos(theta));
        const auto pixel = map.project(1e9 * direction);
        ASSERT_TRUE(pixel) << theta;
        const auto ray = map.ray(*pixel);
        ASSERT_TRUE(ray) << theta;
        EXPECT_LE(glm::length(ray->direction - direction), 1e-10) << theta;
      }
  }
}

TEST(Lens, ClosedForms) {
  const double theta = 1.7, phi = 0.4;  // behind the image plane
  const Vec3 direction(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                       std::cos(theta));
  const Vec2 out(std::cos(phi), std::sin(phi));
  const auto equidistant = LensMap(of_unit(Fisheye{})).project(direction);
  ASSERT_TRUE(equidistant);
  EXPECT_LE(glm::length(*equidistant - theta * out), 1e-15);
  // CAHVORE's fisheye is one in front of a plane
  const auto cahvore =
      LensMap(of_unit(Cahvore{.linearity = 0})).project({std::sin(0.9), 0, std::cos(0.9)});
  ASSERT_TRUE(cahvore);
  EXPECT_NEAR(cahvore->x, 0.9, 1e-15);
  // of the division model k = -1/4 is the stereographic lens: r = 2 tan(θ/2)
  const auto stereographic = LensMap(of_unit(Division{-0.25})).project(direction);
  ASSERT_TRUE(stereographic);
  EXPECT_LE(glm::length(*stereographic - 2 * std::tan(theta / 2) * out), 1e-14);
  // without R and E CAHVOR is a pinhole, wherever its O
  const LensMap linear(of_unit(Cahvore{.axis = glm::normalize(Vec3(.1, .2, 1))}));
  const LensMap pinhole(of_unit(Pinhole{}));
  const Vec3 point(0.3, -0.7, 2);
  EXPECT_LE(glm::length(*linear.project(point) - *pinhole.project(point)), 1e-15);
  // AMICA: 7.3 pixels at the edge of its image
  const LensMap amica(
      {.focal = Vec2(10060), .principal = {512, 512}, .distortion = RadialPowers{{0, -2.8e-5}}});
  EXPECT_NEAR(amica.project({512 / 10060.0, 0, 1})->x, 1024 - 2.8e-5 * 512 * 512, 1e-12);
}

// Principal point of OpenCV's camera matrix: half a pixel less.
TEST(Lens, HalfAPixel) {
  const double opencv_principal = (1024 - 1) / 2.0;  // of a camera whose axis is in the middle
  const LensMap map({.focal = Vec2(1000), .principal = Vec2(opencv_principal + 0.5)});
  EXPECT_EQ(*map.project({0, 0, 5}), Vec2(512));
}

// A polynomial's fold: 1 - 0.9 r² = 0 for k1 = -0.3.
TEST(Lens, Domain) {
  const double fold = 1 / std::sqrt(0.9);
  const LensMap map(of_unit(Brown{{-.3}}));
  EXPECT_NEAR(map.domain(), std::atan(fold), 1e-12);
  EXPECT_TRUE(map.project({fold - 1e-6, 0, 1}));
  EXPECT_FALSE(map.project({fold + 1e-6, 0, 1}));
  const double image = fold * (1 - 0.3 * fold * fold);
  EXPECT_TRUE(map.ray({image - 1e-9, 0}));
  EXPECT_FALSE(map.ray({image + 1e-9, 0}));
  EXPECT_EQ(map.pixel_solid_angle(3, 3), 0);
  // a pole of a rational model ends it as well
  EXPECT_FALSE(LensMap(of_unit(Brown{{0, 0, 0, 0, 0, -1}})).project({1.1, 0, 1}));
  // θ - 0.1 θ³ turns at θ = sqrt(10/3): 1.83, beyond a hemisphere
  EXPECT_NEAR(LensMap(of_unit(Fisheye{{-.1}})).domain(), std::sqrt(10 / 3.0), 1e-12);
  EXPECT_EQ(LensMap(of_unit(Fisheye{})).domain(), kPi);
  EXPECT_NEAR(LensMap(of_unit(Division{.25})).domain(), kPi / 4, 1e-15);
}

TEST(Lens, NoPixelOfNothing) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kHuge = std::numeric_limits<double>::max();
  for (const Case& each : cases()) {
    SCOPED_TRACE(each.name);
    const LensMap map(each.lens);
    EXPECT_FALSE(map.project({0, 0, 0}));
    if (map.domain() < 3) EXPECT_FALSE(map.project({0, 0, -1}));
    EXPECT_FALSE(map.project({kNaN, 0, 1}));
    EXPECT_FALSE(map.ray({kNaN, 0}));
    for (const Vec3& point : {Vec3(1, 0, 1e-300), Vec3(kHuge, kHuge, 1), Vec3(1e-300, 0, 1),
                              Vec3(0, 1e-300, 1e-300), Vec3(1, 1, -1e-300)}) {
      const auto pixel = map.project(point);
      EXPECT_TRUE(!pixel || (std::isfinite(pixel->x) && std::isfinite(pixel->y)));
    }
    for (const Vec2& pixel : {Vec2(kHuge), Vec2(-1e300, 0), Vec2(1e-300, 1e9)}) {
      const auto ray = map.ray(pixel);
      EXPECT_TRUE(!ray || is_finite(ray->direction));
    }
  }
}

// Pixels add up to the polygon of the border; of a pinhole to the closed form of a pyramid.
TEST(Lens, SolidAngles) {
  const Lens pinhole{.focal = {60, 70}, .principal = {32, 24}};
  const LensMap map(pinhole);
  double sum = 0;
  for (unsigned row = 0; row < 48; ++row)
    for (unsigned column = 0; column < 64; ++column) sum += map.pixel_solid_angle(column, row);
  const double a = 32 / 60.0, b = 24 / 70.0;
  EXPECT_NEAR(sum, 4 * std::atan(a * b / std::sqrt(1 + a * a + b * b)), 1e-14);
  // of an equidistant lens dΩ = sin θ/θ dx dy, here 0.01 rad a pixel: 4.2e-6 for squares
  const LensMap fisheye({.focal = Vec2(100), .principal = Vec2(0), .distortion = Fisheye{}});
  for (const unsigned column : {0u, 50u, 140u}) {
    const double theta = std::hypot(column + 0.5, 0.5) / 100;
    EXPECT_NEAR(fisheye.pixel_solid_angle(column, 0) / (1e-4 * std::sin(theta) / theta), 1, 2e-5);
  }
  // narrow: one millionth of a radian
  const LensMap narrow({.focal = Vec2(1e6), .principal = Vec2(512)});
  EXPECT_NEAR(narrow.pixel_solid_angle(512, 512) * 1e12, 1, 1e-9);
}

}  // namespace
}  // namespace panwright::sensor::lens_test
