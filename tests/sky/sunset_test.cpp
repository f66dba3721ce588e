// Sunlight through the ring of a planet's air, against sums over directions to the Sun's disc.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sky/sky.h"

namespace panwright::sky::sunset_test {
namespace {

constexpr double kRadius = 6371e3, kTop = 100e3;
constexpr double kBendAtGround = 0.0204, kBendScale = 7600;

// Another body before the Sun, in radii of the Sun's disc: away from the planet, and beside.
struct Ball {
  double up = 0, aside = 0, radius = 0;
};

// Oracle, of the other side: where each direction of the Sun's disc is seen through the air, by
// bisection, how much it is spread there, and what is left of it by sums along straight rays.
class Oracle {
 public:
  explicit Oracle(bool clear) {
    constexpr int kHeights = 500;
    for (int i = 0; i <= kHeights; ++i)
      depths_.push_back(clear ? rayleigh(kTop * i / kHeights) : depth(kTop * i / kHeights));
  }

  // What arrives of the Sun at an angle from the centre, seen from a distance.
  Vec3 share(double distance, double sun, double limb, const Ball& ball = {}) const {
    const int kSide = ball.radius > 0 ? 300 : 160;
    const double radius = std::asin(world::kSunSineAtOneAu);
    Vec3 sum(0);
    double all = 0;
    for (int i = 0; i < kSide; ++i)
      for (int j = 0; j < kSide; ++j) {
        const double a = 2 * (i + 0.5) / kSide - 1, b = 2 * (j + 0.5) / kSide - 1;
        const double square = a * a + b * b;
        if (square >= 1) continue;
        const double weight = 1 - limb * (1 - std::sqrt(1 - square));
        all += weight;
        if (std::hypot(a - ball.up, b - ball.aside) < ball.radius) continue;
        const double up = sun + radius * a, aside = radius * b;
        sum += weight * arriving(distance, std::acos(std::cos(up) * std::cos(aside)));
      }
    return sum / all;
  }

 private:
  // 0.05 of aerosols, ozone as a triangle between 10 and 40 km: docs/air.md
  static Vec3 depth(double lowest) {
    const Vec3 molecules(0.0492, 0.0973, 0.2225);
    const Vec3 ozone = 8.061e22 * Vec3(2.24e-25, 3.5e-25, 2.3e-26);
    const double r = kRadius + lowest;
    const double half = std::sqrt((kTop - lowest) * (2 * kRadius + kTop + lowest));
    constexpr int kSteps = 1000;
    Vec3 sum(0);
    for (int k = 0; k < kSteps; ++k) {
      const double t = half * (k + 0.5) / kSteps;
      const double h = std::sqrt(r * r + t * t) - kRadius;
      const double layer = std::max(0.0, 1 - std::fabs(h - 25e3) / 15e3) / 15e3;
      sum += molecules * (std::exp(-h / 8000) / 8000) + Vec3(0.05 * std::exp(-h / 1200) / 1200) +
             ozone * layer;
    }
    return sum * (2 * half / kSteps);
  }
  static Vec3 rayleigh(double lowest) {
    return Vec3(0.0492, 0.0973, 0.2225) * std::sqrt(2 * kPi * (kRadius + lowest) / 8000) *
           std::exp(-lowest / 8000);
  }

  Vec3 left(double height) const {
    const double x = height / kTop * static_cast<double>(depths_.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(x), depths_.size() - 2);
    const Vec3 depth = glm::mix(depths_[i], depths_[i + 1], x - static_cast<double>(i));
    return {std::exp(-depth.x), std::exp(-depth.y), std::exp(-depth.z)};
  }

  Vec3 arriving(double distance, double angle) const {
    const auto source = [&](double h) {
      return std::asin((kRadius + h) / distance) - kBendAtGround * std::exp(-h / kBendScale);
    };
    if (angle > source(kTop)) return Vec3(1);
    Vec3 sum(0);
    for (const double want : {angle, -angle}) {
      if (want < source(0)) continue;
      double low = 0, high = kTop;
      for (int i = 0; i < 45; ++i)
        (source(0.5 * (low + high)) < want ? low : high) = 0.5 * (low + high);
      // d(apparent)/d(source) along the radius, and the sines around it
      const double sine = (kRadius + low) / distance;
      const double seen = 1 / (distance * std::sqrt(1 - sine * sine));
      const double bent = seen + kBendAtGround / kBendScale * std::exp(-low / kBendScale);
      sum += left(low) * (seen / bent * sine / std::max(std::sin(angle), 1e-9));
    }
    return sum;
  }

  std::vector<Vec3> depths_;
};

world::World behind(double distance, double angle, double limb) {
  world::World world;
  light::Body body = *light::body_preset("earth");
  body.radii = Vec3(kRadius);
  body.sunset = true;
  body.centre = distance * Vec3(std::cos(angle), std::sin(angle), 0);
  world.set_sky({body}, false);
  world.set_sun({.direction = {1, 0, 0}, .limb_darkening = limb});
  return world;
}

// Of molecules alone and an even disc: what is left at geometric half light, 0.182, 0.085, 0.014
// from 400 km and 0.44, 0.43, 0.41 from GEO (a sum of its own, docs/accuracy/sky.md).
TEST(Sunset, OracleOfClearAir) {
  const Oracle clear(true);
  const auto half = [&](double height) {
    const double distance = kRadius + height;
    return clear.share(distance, std::asin(kRadius / distance), 0);
  };
  const Vec3 low = half(400e3), high = half(35786e3);
  EXPECT_NEAR(low.x, 0.182, 2e-3);
  EXPECT_NEAR(low.y, 0.085, 1e-3);
  EXPECT_NEAR(low.z, 0.014, 5e-4);
  EXPECT_NEAR(high.x, 0.446, 3e-3);
  EXPECT_NEAR(high.y, 0.435, 3e-3);
  EXPECT_NEAR(high.z, 0.416, 3e-3);
}

// From a low orbit to the Moon, from the whole Sun to the depth of the shadow.
TEST(Sunset, SharesByBand) {
  const Oracle oracle(false);
  for (const double distance : {kRadius + 400e3, kRadius + 1500e3, 42164e3, 3.844e8}) {
    double worst = 0;
    const double limb = std::asin(kRadius / distance), sun = std::asin(world::kSunSineAtOneAu);
    for (const double t : {-3.0, -1.0, -0.3, 0.0, 0.5, 1.0, 2.0, 4.0, 7.0, 12.0}) {
      if (limb + t * sun < 0) continue;
      const world::World world = behind(distance, limb + t * sun, 0.6);
      const Sky sky(world);
      const Vec3 want = oracle.share(distance, limb + t * sun, 0.6);
      const Vec3 got = sky.sunlight(Vec3(0));
      const auto sunset = sky.sunset(Vec3(0), 10);
      const Vec3 table = sunset ? sunset->at(sunset->edge.value) : Vec3(1);
      for (int k = 0; k < 3; ++k) {
        worst = std::max({worst, std::fabs(got[k] - want[k]), std::fabs(table[k] - want[k])});
        // 9e-4 and 2.4e-3 measured, of which the sum's own error is 5e-4
        EXPECT_NEAR(got[k], want[k], 1.5e-3) << distance << ' ' << t << ' ' << k;
        EXPECT_NEAR(table[k], want[k], 3e-3) << distance << ' ' << t << ' ' << k;
      }
      EXPECT_LE(got.z, got.x + 1e-9) << t;
    }
    printf("%.0f km: at most %.1e\n", 1e-3 * distance, worst);
  }
}

// The light across 4 km of a low orbit, by the edge at its middle.
TEST(Sunset, EdgeNearAPoint) {
  const double distance = kRadius + 400e3, sun = std::asin(world::kSunSineAtOneAu);
  for (const double t : {0.0, 2.0, 5.0}) {
    const double angle = std::asin(kRadius / distance) + t * sun;
    const Sky sky(behind(distance, angle, 0.6));
    const auto sunset = sky.sunset(Vec3(0), 2000);
    ASSERT_TRUE(sunset);
    for (const double off : {-2000.0, 2000.0}) {
      const Vec3 got =
          sunset->at(sunset->edge.value + glm::dot(sunset->edge.gradient, Vec3(0, off, 0)));
      const Vec3 want = sky.sunlight({0, off, 0});
      // 2.2e-3 measured: by lines between places of the table
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(got[k], want[k], 3e-3) << t << ' ' << off;
    }
  }
}

// A body without it, the whole Sun, the Sun before the body, and a place in the air are as ever.
TEST(Sunset, NoneElsewhere) {
  const double distance = kRadius + 400e3;
  EXPECT_FALSE(Sky(behind(distance, 1.9, 0)).sunset(Vec3(0), 10));
  EXPECT_FALSE(Sky(behind(distance, 3, 0)).sunset(Vec3(0), 10));
  EXPECT_EQ(Sky(behind(distance, 1.9, 0)).sunlight(Vec3(0)), Vec3(1));
  EXPECT_FALSE(Sky(behind(kRadius + 50e3, 1.5, 0)).sunset(Vec3(0), 10));
  world::World world = behind(distance, 1.226, 0.6);
  std::vector<light::Body> bodies(world.bodies().begin(), world.bodies().end());
  bodies[0].sunset = false;
  world.set_sky(bodies, false);
  const Sky sky(world);
  EXPECT_FALSE(sky.sunset(Vec3(0), 10));
  EXPECT_EQ(sky.sunlight(Vec3(0)), Vec3(sky.sun_share(Vec3(0))));
}

// Another body before the Sun takes those of its directions that it hides, not its share of what
// the air leaves: that is up to 7e-2 off here.
TEST(Sunset, BesideAnotherBody) {
  const Oracle oracle(false);
  const double distance = kRadius + 400e3, sun = std::asin(world::kSunSineAtOneAu);
  double worst = 0, product = 0;
  for (const double t : {-0.5, 1.0, 3.0})
    for (const Ball& ball : {Ball{0, 0, 0.5}, Ball{0.6, 0.2, 0.5}, Ball{-0.7, 0, 0.6}}) {
      const double angle = std::asin(kRadius / distance) + t * sun;
      world::World world = behind(distance, angle, 0.6);
      const Vec3 alone = Sky(world).sunlight(Vec3(0));
      std::vector<light::Body> bodies(world.bodies().begin(), world.bodies().end());
      light::Body other;
      other.name = "ball";
      const double width = world::kSunSineAtOneAu * 1e5;
      other.radii = Vec3(ball.radius * width);
      other.centre = {1e5, -ball.up * width, ball.aside * width};
      bodies.push_back(other);
      world.set_sky(bodies, false);
      const Sky sky(world);
      const Vec3 got = sky.sunlight(Vec3(0)), want = oracle.share(distance, angle, 0.6, ball);
      for (int k = 0; k < 3; ++k) {
        worst = std::max(worst, std::fabs(got[k] - want[k]));
        product = std::max(product, std::fabs(alone[k] * sky.sun_share(Vec3(0), 0) - want[k]));
        // 3.4e-4 measured
        EXPECT_NEAR(got[k], want[k], 1e-3) << t << ' ' << ball.up << ' ' << k;
      }
    }
  printf("beside a body: at most %.1e, products of shares %.1e\n", worst, product);
  EXPECT_GT(product, 0.03);
}

}  // namespace
}  // namespace panwright::sky::sunset_test
