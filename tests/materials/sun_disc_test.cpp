// Narrow lobes under the Sun's disc against a quadrature over the disc.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "materials/brdf.h"
#include "materials/material.h"
#include "tests/support/disc_quadrature.h"

namespace panwright::materials::sun_disc_test {
namespace {

using namespace disc_quadrature;

Vec3 rounded(const Dir& a) {
  return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
}

Material material_of(const Lobe& lobe) {
  Material m;
  m.diffuse = Vec3(0);
  m.specular = Vec3(1);
  m.weights = Vec3(0, 1, 0);
  if (lobe.index > 0) m.refract = Vec3(static_cast<double>(lobe.index));
  const auto ax = static_cast<double>(lobe.ax), ay = static_cast<double>(lobe.ay);
  switch (lobe.brdf) {
    case Brdf::cook_torrance:
      m.specular_brdf = CookTorrance{.alpha = ax};
      break;
    case Brdf::beckmann:
      m.specular_brdf = Beckmann{ax, ay};
      break;
    case Brdf::ggx:
      m.specular_brdf = Ggx{ax, ay};
      break;
    case Brdf::blinn_phong:
      m.specular_brdf = BlinnPhong{.shine = 2 / (ax * ax)};
      break;
  }
  fit(m);
  return m;
}

struct Residuals {
  double peak = 0;     // relative, at the specular direction
  double profile = 0;  // over the largest, ±1° about it in the plane of incidence and across it
  double between = 0;  // the same between them
  double single = 0;   // f32 − f64 over the largest
};

// Views in the plane of incidence, across it and between.
constexpr double kPlaces_deg[][2] = {{0, 0},
                                     {0.1, 0},
                                     {-0.1, 0},
                                     {0.25, 0},
                                     {-0.25, 0},
                                     {0.6, 0},
                                     {-0.6, 0},
                                     {1, 0},
                                     {-1, 0},
                                     {0, 0.03},
                                     {0, 0.1},
                                     {0, 0.2},
                                     {0, 0.27},
                                     {0, 0.4},
                                     {0, 0.7},
                                     {0, 1},
                                     {0.2, 0.2},
                                     {-0.4, 0.3},
                                     {0, 0.265},
                                     // where the disc ends at 0.3 AU
                                     {0, 0.885},
                                     {0, 0.87},
                                     {0.8, 0},
                                     {-0.8, 0.3}};

// phi: azimuth of the plane of incidence against the tangent
Residuals residuals(const Lobe& lobe, Long theta, Long phi, Long au, Long limb) {
  const Material m = material_of(lobe);
  const Long radius = kRadius / au;
  const ShadingContext local{Vec3(1, 0, 0)};
  const auto turned = [&](const Dir& d) {
    return Dir{d.x * std::cos(phi) - d.y * std::sin(phi), d.x * std::sin(phi) + d.y * std::cos(phi),
               d.z};
  };
  const Dir l = turned({-std::sin(theta), 0, std::cos(theta)});
  const Vec3 normal(0, 0, 1);
  const Incidence light(rounded(l), Vec3(1), kSunAlpha2 / static_cast<double>(au * au),
                        static_cast<double>(limb));
  std::vector<double> want, got, single;
  for (const auto& place : kPlaces_deg) {
    const Long in = theta + place[0] * kLongPi / 180, out = place[1] * kLongPi / 180;
    const Dir v =
        turned({std::sin(in) * std::cos(out), std::sin(out), std::cos(in) * std::cos(out)});
    want.push_back(static_cast<double>(over_disc(lobe, l, v, radius, limb)));
    got.push_back(f64::radiance(m, light, rounded(v), normal, Vec3(1), local).x);
    single.push_back(static_cast<double>(
        f32::radiance(m, light, glm::vec3(rounded(v)), glm::vec3(normal), glm::vec3(1), local).x));
  }
  Residuals r;
  double largest = 0;
  for (const double one : want) largest = std::max(largest, one);
  r.peak = std::fabs(got[0] / want[0] - 1);
  for (std::size_t i = 0; i < want.size(); ++i) {
    EXPECT_TRUE(std::isfinite(got[i]) && got[i] >= 0 && std::isfinite(single[i]) && single[i] >= 0);
    double& error = kPlaces_deg[i][0] != 0 && kPlaces_deg[i][1] != 0 ? r.between : r.profile;
    error = std::max(error, std::fabs(got[i] - want[i]) / largest);
    r.single = std::max(r.single, std::fabs(single[i] - got[i]) / largest);
  }
  return r;
}

constexpr Long kDegreeLong = kLongPi / 180;

struct Case {
  const char* name;
  Brdf brdf;
  Long index;
};
const Case kCases[] = {{"cook_torrance", Brdf::cook_torrance, 1.5L},
                       {"beckmann", Brdf::beckmann, 0},
                       {"ggx", Brdf::ggx, 1.5L},
                       {"blinn_phong", Brdf::blinn_phong, 0}};

TEST(SunDisc, FlatPlate) {
  for (const Case& each : kCases) {
    Residuals worst;
    for (const Long slope : {0.001L, 0.003L, 0.02L, 0.1L})
      for (const Long theta : {0.0L, 45.0L, 75.0L, 85.0L})
        for (const Long au : {0.3L, 1.0L, 5.0L}) {
          const Residuals r = residuals({each.brdf, slope, slope, each.index}, theta * kDegreeLong,
                                        0.3L, au, au == 1 ? 0.6L : 0.0L);
          if (r.profile > 0.02)
            std::printf("  %s slope %g, %g deg, %g AU: %.1e %.1e %.1e\n", each.name, double(slope),
                        double(theta), double(au), r.peak, r.profile, r.single);
          worst.peak = std::max(worst.peak, r.peak);
          worst.profile = std::max(worst.profile, r.profile);
          worst.between = std::max(worst.between, r.between);
          worst.single = std::max(worst.single, r.single);
        }
    std::printf("%s: peak %.1e, profile %.1e, between %.1e, single precision %.1e\n", each.name,
                worst.peak, worst.profile, worst.between, worst.single);
    // measured 1.3e-3 to 4.0e-3, 3.8e-3 to 6.4e-3, 1.3e-2 to 2.4e-2 (slope 0.001 at 85 degrees,
    // where the disc ends) and 1.5e-4; the profile was 4e-2 where the disc ends at 0.3 AU
    EXPECT_LE(worst.peak, 5e-3) << each.name;
    EXPECT_LE(worst.profile, 0.01) << each.name;
    EXPECT_LE(worst.between, 0.026) << each.name;
    EXPECT_LE(worst.single, 6e-4) << each.name;
  }
}

TEST(SunDisc, Anisotropic) {
  for (const Case& each : {kCases[1], kCases[2]}) {
    Residuals worst;
    for (const auto& [x, y] :
         {std::pair{0.001L, 0.01L}, std::pair{0.02L, 0.002L}, std::pair{0.1L, 0.01L}})
      for (const Long theta : {0.0L, 60.0L, 80.0L})
        for (const Long phi : {0.0L, 30.0L, 45.0L, 90.0L}) {
          const Residuals r = residuals({each.brdf, x, y, each.index}, theta * kDegreeLong,
                                        phi * kDegreeLong, 1, 0);
          if (r.profile > 0.02)
            std::printf("  %s slopes %g %g, %g deg, %g: %.1e %.1e %.1e\n", each.name, double(x),
                        double(y), double(theta), double(phi), r.peak, r.profile, r.single);
          worst.peak = std::max(worst.peak, r.peak);
          worst.profile = std::max(worst.profile, r.profile);
          worst.between = std::max(worst.between, r.between);
          worst.single = std::max(worst.single, r.single);
        }
    std::printf("%s: peak %.1e, profile %.1e, between %.1e, single precision %.1e\n", each.name,
                worst.peak, worst.profile, worst.between, worst.single);
    EXPECT_LE(worst.peak, 7e-3) << each.name;  // measured 5.2e-3
    // measured 1.4e-2
    EXPECT_LE(std::max(worst.profile, worst.between), 0.017) << each.name;
  }
}

// A mirror shows the disc as it is: brightness by the radius, 1 over the sphere, nothing outside.
TEST(SunDisc, Mirror) {
  Material m;
  m.diffuse = Vec3(0);
  m.specular = Vec3(1);
  m.weights = Vec3(0, 1, 0);
  m.specular_brdf = Mirror{};
  fit(m);
  for (const double theta : {0.0, 0.7, 1.48}) {
    const double radius = static_cast<double>(kRadius);
    const Vec3 v(std::sin(theta), 0, std::cos(theta)), mirrored(-v.x, 0, v.z);
    const Vec3 x(v.z, 0, v.x), y(0, 1, 0);
    double sum = 0;
    constexpr int n = 400;
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < n; ++k) {
        const double a = 1.1 * (2 * (i + 0.5) / n - 1), b = 1.1 * (2 * (k + 0.5) / n - 1);
        const double r2 = a * a + b * b;
        const Vec3 l = radius * (a * x + b * y) + std::sqrt(1 - radius * radius * r2) * mirrored;
        const double got = f64::radiance(m, {l, Vec3(1), kSunAlpha2, 0.6}, v, Vec3(0, 0, 1)).x;
        sum += got * (2.2 / n) * (2.2 / n) * radius * radius;
        if (std::fabs(r2 - 1) < 1e-4) continue;
        const double want =
            r2 < 1 ? (1 - 0.6 * (1 - std::sqrt(1 - r2))) / (1 - 0.2) / (kPi * radius * radius) : 0;
        EXPECT_NEAR(got, want, 2e-2 * want + 1e-9) << theta << ' ' << a << ' ' << b;
      }
    EXPECT_NEAR(sum, 1, 2e-3);  // steps at the disc's edge
  }
}

}  // namespace
}  // namespace panwright::materials::sun_disc_test
