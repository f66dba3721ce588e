// Lenses against OpenCV's results, closed forms, and their own inverse.
#include "sensor/lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <vector>

#include "sensor/camera_file.h"
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

// In pixels.
struct Pixels {
  explicit Pixels(const Lens& of) : lens(of), map(of.distortion) {}

  std::optional<Vec2> project(const Vec3& point) const {
    const auto at = map.place(point);
    if (!at) return std::nullopt;
    return lens.focal * *at + lens.principal;
  }
  std::optional<LensRay> ray(const Vec2& pixel) const {
    return map.ray((pixel - lens.principal) / lens.focal);
  }

  Lens lens;
  DistortionMap map;
};

// Largest differences, OpenCV 4.6: 2.5e-16 and 4.0e-16 focal lengths.
TEST(Lens, AsOpenCv) {
  std::ifstream table(std::string(PANWRIGHT_SOURCE_DIR "/tests/sensor/data/opencv.txt"));
  constexpr std::array kBrown{0.3,  0.2,  5e-3, 5e-3, 0.1,  0.1,  0.1,
                              0.05, 5e-3, 5e-3, 5e-3, 5e-3, 0.05, 0.05};
  constexpr std::array kFisheye{0.05, 0.02, 0.01, 0.005};
  Numbers numbers;
  double worst = 0;
  const auto compare = [&](const Distortion& distortion, double reach) {
    const double x = reach * numbers.next();
    const Vec3 point(x, reach * numbers.next(), 1);
    Vec2 expected;
    ASSERT_TRUE(table >> expected.x >> expected.y);
    const DistortionMap map(distortion);
    for (const double distance : {1.0, 7e5}) {
      const auto got = map.place(distance * point);
      ASSERT_TRUE(got);
      worst = std::max(worst, glm::length(*got - expected));
    }
  };
  for (int k = 0; k < 1000; ++k) {
    Brown brown;
    for (std::size_t term = 0; term < kBrown.size(); ++term)
      brown.k[term] = kBrown[term] * numbers.next();
    compare(brown, 0.5);
  }
  EXPECT_LE(worst, 1e-15);
  worst = 0;
  for (int k = 0; k < 1000; ++k) {
    Fisheye fisheye;
    for (std::size_t term = 0; term < kFisheye.size(); ++term)
      fisheye.k[term] = kFisheye[term] * numbers.next();
    compare(fisheye, 1.2);
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
      {"powers", lens(900, 1024, 1000, RadialPowers{{1e-4, -2.8e-2, 0, 1e-2, 0}}), 1024, 1000});
  all.push_back(
      {"CAHVOR",
       {.focal = {1100, 1105},
        .principal = {512, 500},

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
    const Pixels map(each.lens);
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
    const Pixels map(each.lens);
    const double widest = 0.98 * std::min(map.map.domain(), 1.4);
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
  const auto equidistant = DistortionMap(Fisheye{}).place(direction);
  ASSERT_TRUE(equidistant);
  EXPECT_LE(glm::length(*equidistant - theta * out), 1e-15);
  // CAHVORE's fisheye is one in front of a plane
  const auto cahvore =
      DistortionMap(Cahvore{.linearity = 0}).place({std::sin(0.9), 0, std::cos(0.9)});
  ASSERT_TRUE(cahvore);
  EXPECT_NEAR(cahvore->x, 0.9, 1e-15);
  // of the division model k = -1/4 is the stereographic lens: r = 2 tan(θ/2)
  const auto stereographic = DistortionMap(Division{-0.25}).place(direction);
  ASSERT_TRUE(stereographic);
  EXPECT_LE(glm::length(*stereographic - 2 * std::tan(theta / 2) * out), 1e-14);
  // without R and E CAHVOR is a pinhole, wherever its O
  const DistortionMap linear(Cahvore{.axis = glm::normalize(Vec3(.1, .2, 1))});
  const DistortionMap pinhole(Pinhole{});
  const Vec3 point(0.3, -0.7, 2);
  EXPECT_LE(glm::length(*linear.place(point) - *pinhole.place(point)), 1e-15);
  // AMICA: its published term is -2.8e-5 r² of pixels, 7.3 at the edge of its image
  const double focal = 10060, edge = 512 / focal;
  const auto amica = DistortionMap(RadialPowers{{0, -2.8e-5 * focal}}).place({edge, 0, 1});
  ASSERT_TRUE(amica);
  EXPECT_NEAR(focal * amica->x, 512 - 2.8e-5 * 512 * 512, 1e-12);
}

// A polynomial's fold: 1 - 0.9 r² = 0 for k1 = -0.3.
TEST(Lens, Domain) {
  const double fold = 1 / std::sqrt(0.9);
  const DistortionMap map(Brown{{-.3}});
  EXPECT_NEAR(map.domain(), std::atan(fold), 1e-12);
  EXPECT_TRUE(map.place({fold - 1e-6, 0, 1}));
  EXPECT_FALSE(map.place({fold + 1e-6, 0, 1}));
  const double image = fold * (1 - 0.3 * fold * fold);
  EXPECT_TRUE(map.ray({image - 1e-9, 0}));
  EXPECT_FALSE(map.ray({image + 1e-9, 0}));
  // a pole of a rational model ends it as well
  EXPECT_FALSE(DistortionMap(Brown{{0, 0, 0, 0, 0, -1}}).place({1.1, 0, 1}));
  // θ - 0.1 θ³ turns at θ = sqrt(10/3): 1.83, beyond a hemisphere
  EXPECT_NEAR(DistortionMap(Fisheye{{-.1}}).domain(), std::sqrt(10 / 3.0), 1e-12);
  EXPECT_EQ(DistortionMap(Fisheye{}).domain(), kPi);
  EXPECT_NEAR(DistortionMap(Division{.25}).domain(), kPi / 4, 1e-15);
}

TEST(Lens, NoPixelOfNothing) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kHuge = std::numeric_limits<double>::max();
  for (const Case& each : cases()) {
    SCOPED_TRACE(each.name);
    const Pixels map(each.lens);
    EXPECT_FALSE(map.project({0, 0, 0}));
    if (map.map.domain() < 3) EXPECT_FALSE(map.project({0, 0, -1}));
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

}  // namespace
}  // namespace panwright::sensor::lens_test
