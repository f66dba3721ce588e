// The air against paths of photons through a spherical shell, all orders of scattering, written
// anew.
#include "light/air.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "light/body.h"

namespace panwright::light::air_test {
namespace {

constexpr double kRadius = 6371e3, kTop = 6471e3;  // metres

const Air& air() { return *earth_air(kRadius); }

// Backward paths by delta tracking; light of the Sun by steps.
class Paths {
 public:
  explicit Paths(int band) : band_(band) {}

  struct Mean {
    double value, error;
  };
  Mean mean(const Vec3& from, const Vec3& ray, const Vec3& sun, double albedo, int count) {
    double sum = 0, squares = 0;
    for (int i = 0; i < count; ++i) {
      const double light = path(from, ray, sun, albedo);
      sum += light;
      squares += light * light;
    }
    const double mean = sum / count;
    return {mean, std::sqrt((squares / count - mean * mean) / count)};
  }

 private:
  double unit() { return (static_cast<double>(random_() >> 11) + 0.5) * 0x1p-53; }

  struct Local {
    double rayleigh, mie, all;
  };
  Local local(double height) const {
    const double depth[3] = {0.0492, 0.0973, 0.2225};
    const double ozone[3] = {300 * 2.687e20 * 2.24e-25, 300 * 2.687e20 * 3.5e-25,
                             300 * 2.687e20 * 2.3e-26};
    const double haze = 0.05 / 1200 * std::exp(-height / 1200);
    const double layer = std::max(0.0, 1 - std::fabs(height - 25e3) / 15e3) / 15e3;
    const double rayleigh = depth[band_] / 8e3 * std::exp(-height / 8e3);
    return {rayleigh, 0.95 * haze, rayleigh + haze + ozone[band_] * layer};
  }

  static bool crosses(const Vec3& from, const Vec3& ray, double r, double& first, double& last) {
    const double b = glm::dot(from, ray), c = glm::dot(from, from) - r * r;
    if (b * b <= c) return false;
    const double half = std::sqrt(b * b - c);
    first = -b - half;
    last = -b + half;
    return true;
  }

  double to_sun(const Vec3& from, const Vec3& sun) const {
    double first, last;
    if (crosses(from, sun, kRadius, first, last) && first > 0) return 0;
    if (!crosses(from, sun, kTop, first, last)) return 1;
    constexpr int kSteps = 300;
    double depth = 0;
    for (int i = 0; i < kSteps; ++i)
      depth += local(glm::length(from + (i + 0.5) / kSteps * last * sun) - kRadius).all;
    return std::exp(-depth * last / kSteps);
  }

  static double even(double c) { return 3 / (16 * kPi) * (1 + c * c); }
  static double lobe(double c) {
    const double g = 0.6;
    return 3 / (8 * kPi) * (1 - g * g) / (2 + g * g) * (1 + c * c) /
           std::pow(1 + g * g - 2 * g * c, 1.5);
  }

  double path(Vec3 from, Vec3 ray, const Vec3& sun, double albedo) {
    double weight = 1, light = 0;
    for (int order = 0; order < 20; ++order) {
      double first, last, near, far;
      if (!crosses(from, ray, kTop, first, last) || last <= 0) break;
      const bool ground = crosses(from, ray, kRadius, near, far) && near > 1e-3;
      const double end = ground ? near : last, most = local(0).all;
      double t = std::max(first, 0.0);
      bool met = false;
      Local here{};
      while ((t -= std::log(unit()) / most) < end) {
        here = local(glm::length(from + t * ray) - kRadius);
        if (unit() < here.all / most) {
          met = true;
          break;
        }
      }
      const double turn = 2 * kPi * unit();
      if (met) {
        from += t * ray;
        const double share = here.rayleigh / (here.rayleigh + here.mie);
        const auto phase = [&](double c) { return share * even(c) + (1 - share) * lobe(c); };
        weight *= (here.rayleigh + here.mie) / here.all;
        light += weight * phase(glm::dot(ray, sun)) * to_sun(from, sun);
        const double z = 2 * unit() - 1, across = std::sqrt(1 - z * z);
        const Vec3 next(across * std::cos(turn), across * std::sin(turn), z);
        weight *= 4 * kPi * phase(glm::dot(ray, next));
        ray = next;
      } else if (ground && albedo > 0) {
        from += (near - 1e-2) * ray;
        const Vec3 up = glm::normalize(from);
        const double facing = glm::dot(up, sun);
        weight *= albedo;
        if (facing > 0) light += weight / kPi * facing * to_sun(from, sun);
        const double square = unit(), across = std::sqrt(square);
        const Vec3 x = glm::normalize(glm::cross(up, Vec3(0.3, 0.5, 0.7)));
        ray = across * (std::cos(turn) * x + std::sin(turn) * glm::cross(up, x)) +
              std::sqrt(1 - square) * up;
      } else {
        break;
      }
    }
    return light;
  }

  int band_;
  std::mt19937_64 random_{1};
};

struct Geometry {
  double mu;      // of the ray at the ground; below 0: height of its lowest place, metres
  double mu_sun;  // there
  double azimuth;
};

struct Look {
  Vec3 origin, ray, sun;
};
Look look_of(const Geometry& at) {
  const bool limb = at.mu < 0;
  const double mu = limb ? 0 : at.mu, across = std::sqrt(1 - at.mu_sun * at.mu_sun);
  const double turn = at.azimuth * kDegree;
  Look look;
  look.ray = Vec3(std::sqrt(1 - mu * mu), 0, -mu);
  look.sun = Vec3(across * std::cos(turn), across * std::sin(turn), at.mu_sun);
  look.origin = Vec3(0, 0, limb ? 1 - at.mu / kRadius : 1) - 1.2 * look.ray;
  return look;
}

// Worst: 10 % of thin light in the red at the nadir; 4 % of what is 0.02 or more. Of 8,000 paths
// the mean has errors of 1 to 3 %.
TEST(Air, LightByAllOrdersOfScattering) {
  for (const Geometry& at : {Geometry{0.9, 0.8, 60},
                             {0.4, 0.3, 180},
                             {0.1, 0.5, 40},
                             {-3e3, 0.5, 180},
                             {-10e3, 0.9, 0},
                             {-30e3, 0.2, 90},
                             {-10e3, -0.05, 20},
                             {-30e3, -0.1, 0},
                             {0.2, -0.05, 180}})
    for (const int band : {0, 2}) {
      const Look look = look_of(at);
      const auto want = Paths(band).mean(look.origin * kRadius, look.ray, look.sun, 0, 8000);
      const double got = air().from_outside(look.origin, look.ray, look.sun).light[band];
      EXPECT_NEAR(got, want.value, 4 * want.error + 0.11 * want.value + 1e-5)
          << at.mu << ' ' << at.mu_sun << ' ' << band;
      EXPECT_LT(want.error, 0.1 * want.value) << at.mu << ' ' << at.mu_sun << ' ' << band;
    }
}

// The ground through the air, both ways, with light of the sky: within 8 %.
TEST(Air, GroundByAllOrdersOfScattering) {
  for (const Geometry& at : {Geometry{0.9, 0.9, 0}, {0.5, 0.5, 90}, {0.3, 0.9, 180}})
    for (const int band : {0, 2}) {
      const Look look = look_of(at);
      const auto want = Paths(band).mean(look.origin * kRadius, look.ray, look.sun, 0.3, 8000);
      Body body = *body_preset("earth");
      body.radii = Vec3(kRadius);
      body.albedo = 0.3 * air().ground_factor() + air().albedo();
      const AirLight between = air().from_outside(look.origin, look.ray, look.sun);
      const double got = reflected_through(body, air(), Vec3(0, 0, 1), 0, at.mu_sun, at.mu, between,
                                           Vec3(1))[band];
      EXPECT_NEAR(got, want.value, 4 * want.error + 0.06 * want.value)
          << at.mu << ' ' << at.mu_sun << ' ' << band;
    }
}

// Steps along a ray against the tables, and from just above the air against just below.
TEST(Air, TablesAsSteps) {
  double worst = 0;
  for (const double mu : {0.99, 0.7, 0.33, 0.12, 0.05, -0.5e3, -4e3, -15e3, -42e3})
    for (const double mu_sun : {0.97, 0.42, 0.13, 0.03, -0.02, -0.07, -0.11})
      for (const double azimuth : {5.0, 77.0, 150.0}) {
        const Look look = look_of({mu, mu_sun, azimuth});
        const AirLight got = air().from_outside(look.origin, look.ray, look.sun);
        const AirLight want = air().along(look.origin, look.ray, look.sun);
        for (int k = 0; k < 3; ++k) {
          worst = std::max(worst, (std::fabs(got.light[k] - want.light[k]) - 1e-4) / want.light[k]);
          ASSERT_NEAR(got.through[k], want.through[k], 0.01) << mu;
        }
      }
  EXPECT_LT(worst, 0.04);  // 0.036
  const Vec3 ray = glm::normalize(Vec3(0.2, 0, -1)), sun = glm::normalize(Vec3(1, 1, 1));
  const Vec3 above(0, 0, air().top() + 1e-9), below(0, 0, air().top() - 1e-9);
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(air().light(above, ray, sun).light[k] / air().light(below, ray, sun).light[k], 1,
                0.02);
}

// At the ground, upwards and along it, at the top, at the centre of the Sun, and far away.
TEST(Air, FiniteEverywhere) {
  for (const double r : {1.0, 1 + 1e-12, 1.005, air().top(), 1.2, 63.0, 1e6})
    for (const Vec3& ray : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0.6, 0, -0.8)})
      for (const Vec3& sun : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0, 1, 0)}) {
        const AirLight light = air().light(Vec3(0, 0, r), ray, sun);
        for (int k = 0; k < 3; ++k) {
          EXPECT_TRUE(light.light[k] >= 0 && light.light[k] < 10) << r;
          EXPECT_TRUE(light.through[k] >= 0 && light.through[k] <= 1) << r;
        }
      }
}

// Blue sky at noon, a red Sun at the horizon, a blue limb.
TEST(Air, Colours) {
  const Vec3 up = air().light(Vec3(0, 0, 1), Vec3(0, 0, 1), glm::normalize(Vec3(1, 0, 1))).light;
  EXPECT_GT(up.z, 2 * up.x);
  const Vec3 setting = air().transmittance(1, 0.02);
  EXPECT_GT(setting.x, 5 * setting.z);
  const Look limb = look_of({-25e3, 0.5, 90});
  const Vec3 light = air().from_outside(limb.origin, limb.ray, limb.sun).light;
  EXPECT_GT(light.z, 3 * light.x);
}

// The light that leaves in all directions, by a sum over these, is the albedo's share of what falls
// on the disc: 0.4 %.
TEST(Air, KeepsTheAlbedo) {
  Body earth = *body_preset("earth");
  earth.radii = Vec3(kRadius);
  Vec3 sum(0);
  constexpr int kSteps = 40, kTurns = 8;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < 2 * kSteps; ++j)
      for (int k = 0; k < kTurns; ++k) {
        const double root = (i + 0.5) / kSteps, mu = root * root;
        const double mu_sun = -1 + (j + 0.5) / kSteps;
        const Look look = look_of({mu, mu_sun, 180 * (k + 0.5) / kTurns});
        const AirLight between = air().from_outside(look.origin, look.ray, look.sun);
        sum += reflected_through(earth, air(), Vec3(0, 0, 1), 0, mu_sun, mu, between, Vec3(1)) *
               (2 * mu * 2 * root / kSteps * 2 * kPi / kSteps / kTurns);
        const double height = (air().top() - 1) * root * root;
        const Look limb = look_of({-height * kRadius, mu_sun, 180 * (k + 0.5) / kTurns});
        sum +=
            air().from_outside(limb.origin, limb.ray, limb.sun).light *
            (2 * (1 + height) * (air().top() - 1) * 2 * root / kSteps * 2 * kPi / kSteps / kTurns);
      }
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(sum[k], earth.albedo[k], 0.01 * earth.albedo[k]);
}

MapPixels map_of(std::uint32_t width, const Vec3& west, const Vec3& east) {
  MapPixels map{width, width / 2, {}};
  for (std::uint32_t i = 0; i < width * width / 2; ++i)
    for (int k = 0; k < 3; ++k)
      map.rgb.push_back(static_cast<float>(i % width < width / 2 ? west[k] : east[k]));
  return map;
}

// Half of the planet under clouds of 0.75, the mean kept; clouds that are too much are dimmed.
TEST(BodyMap, Clouds) {
  bool dimmed = true;
  const MapPixels ground = map_of(8, Vec3(0.1, 0.2, 0.3), Vec3(0.2, 0.2, 0.3));
  const MapPixels clouds = map_of(16, Vec3(0), Vec3(0.5));
  const Vec3 albedo(0.3, 0.25, 0.4);
  const MapPixels both = with_clouds(ground, clouds, albedo, dimmed);
  EXPECT_FALSE(dimmed);
  ASSERT_EQ(both.width, 16u);
  const Vec3 mean = mean_of(both);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(mean[k], albedo[k], 1e-6);
  // 0.1·s in the west, half of 0.2·s and of white in the east, but for the columns between
  const double scale = (0.3 - kCloud / 4) * 2 / (0.1 + 0.5 * 0.2);
  EXPECT_NEAR(both.rgb[3 * (16 * 4 + 3)], 0.1 * scale, 0.02);
  EXPECT_NEAR(both.rgb[3 * (16 * 4 + 12)], 0.1 * scale + 0.5 * kCloud, 0.02);
  const MapPixels dim = with_clouds({}, clouds, Vec3(0.1), dimmed);
  EXPECT_TRUE(dimmed);
  EXPECT_NEAR(mean_of(dim).y, 0.1, 1e-6);
  EXPECT_NEAR(dim.rgb[0], 0, 1e-6);
}

// Rows of a wide image with a hole; turned by a quarter.
TEST(BodyMap, Rows) {
  const std::uint32_t width = 2 * MapRows::kMostWidth, height = MapRows::kMostWidth;
  MapRows rows(width, height, MapValues::cover, width / 4, std::uint8_t{7});
  std::vector<std::uint8_t> line(std::size_t{4} * width, 255);
  for (std::uint32_t x = 0; x < width; ++x)
    for (int k = 0; k < 3; ++k)
      line[4 * x + static_cast<std::uint32_t>(k)] = x < width / 2 ? 51 : 0;
  for (std::uint32_t y = 0; y < height; ++y) {
    if (y == 9) line[4 * 5] = line[4 * 5 + 1] = line[4 * 5 + 2] = 7;
    rows.add(line);
    if (y == 9) line[4 * 5] = line[4 * 5 + 1] = line[4 * 5 + 2] = 51;
  }
  EXPECT_EQ(rows.step(), 2u);
  EXPECT_EQ(rows.holes(), 1u);
  ASSERT_TRUE(rows.first_hole());
  EXPECT_EQ(rows.first_hole()->column, 5u);
  EXPECT_EQ(rows.first_hole()->row, 9u);
  const MapPixels map = rows.pixels();
  ASSERT_EQ(map.width, MapRows::kMostWidth);
  const std::size_t middle = std::size_t{100} * map.width;
  EXPECT_NEAR(map.rgb[3 * (middle + map.width / 4 - 1)], 0, 1e-6);
  EXPECT_NEAR(map.rgb[3 * (middle + map.width / 4)], 0.2, 1e-6);
  EXPECT_NEAR(map.rgb[3 * (middle + 3 * map.width / 4)], 0, 1e-6);
  EXPECT_NEAR(map.rgb[3 * (4 * map.width + map.width / 4 + 2)], 0.2, 1e-6);
}

// By night alone.
TEST(BodyMap, LightsOfTheNight) {
  Body body = *body_preset("earth");
  EXPECT_EQ(night_light(body, Vec3(1, 0, 0), 0, -1), Vec3(0));
  body.night = std::make_shared<BodyMap>(map_of(4, Vec3(0.5), Vec3(0.5)), BodyMap::Scale::none);
  EXPECT_EQ(night_light(body, Vec3(1, 0, 0), 0, 0.01), Vec3(0));
  EXPECT_NEAR(night_light(body, Vec3(1, 0, 0), 0, -0.05).x, 0.25 * kNightRadiance, 1e-9);
  EXPECT_NEAR(night_light(body, Vec3(1, 0, 0), 0, -0.5).x, 0.5 * kNightRadiance, 1e-9);
}

}  // namespace
}  // namespace panwright::light::air_test
