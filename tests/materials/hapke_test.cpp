#include <gtest/gtest.h>

#include "base/random.h"
#include "materials/brdf.h"
#include "materials/hapke_h.h"
#include "materials/internal/hapke_lanes.h"
#include "materials/sample.h"
#include "tests/materials/quadrature.h"
#include "tests/support/hard_cases.h"

namespace panwright::materials::hapke_test {
namespace {

const Vec3 kNormal(0, 0, 1);

// Hapke's law with H of 2002, without coherent backscatter.
f64::SurfaceFields surface(double w, double h, double b0, double rough, double b, double c,
                           double dense = 1) {
  f64::SurfaceFields s = f64::hapke_surface(w, h, b0, rough, b, c, dense);
  s.hapke_bc0 = 0;
  return s;
}

Material fitted(double w, Hapke hapke = {}) {
  Material m;
  m.diffuse = Vec3(1);
  hapke.w = w;
  m.diffuse_brdf = hapke;
  fit(m);
  return m;
}

double bidirectional(double i_deg, double e_deg, double psi_deg, double rough_deg) {
  const Vec3 l = from_angles(i_deg * kDegree, psi_deg * kDegree);
  const Vec3 v = from_angles(e_deg * kDegree, 0);
  return f64::hapke(surface(0.21, 0.07, 1.0, rough_deg * kDegree, 0.25, 0.3), l, v, kNormal) * l.z;
}

// An independent computation of r, smooth and with 20° of roughness.
TEST(Hapke, Fixture) {
  const struct {
    double i, e, psi, smooth, rough;
  } rows[] = {{0, 0, 0, .028389201, .028307759},     {30, 0, 0, .014411100, .014334146},
              {30, 30, 180, .011100650, .011015635}, {60, 60, 0, .028056029, .028049027},
              {60, 60, 90, .009478504, .007681216},  {60, 30, 45, .009711536, .009262282},
              {80, 70, 120, .005458602, .002228484}, {85, 85, 180, .009465028, .000449654}};
  for (const auto& row : rows) {
    SCOPED_TRACE(testing::Message() << row.i << ' ' << row.e << ' ' << row.psi);
    EXPECT_NEAR(bidirectional(row.i, row.e, row.psi, 0), row.smooth, 6e-10);  // digits of the table
    EXPECT_NEAR(bidirectional(row.i, row.e, row.psi, 20), row.rough, 6e-10);
  }
}

// Isotropic particles without opposition: the plane albedo is 1 − √(1 − w)·H(μ), exactly.
TEST(Hapke, PlaneAlbedo) {
  double worst = 0;
  for (const double w : {0.05, 0.3, 0.6, 0.9, 0.99, 1.0}) {
    const Material m = fitted(w);
    for (const double mu : {0.1, 0.5, 1.0}) {
      const Vec3 v = hard_cases::direction(mu, 0);
      const double got =
          cosine_integral([&](const Vec3& l) { return f64::brdf(m, l, v, kNormal).x; }, 96);
      worst = std::max(worst, std::fabs(got - (1 - std::sqrt(1 - w) * hapke_h(mu, w))));
    }
  }
  EXPECT_LE(worst, 5e-7) << worst;  // measured 3.3e-7, the error of the fit
  const struct {
    double w, mu, albedo;
  } rows[] = {{.9, .1, .62933582}, {.9, .5, .50793891}, {.9, 1, .41494748},
              {.6, .1, .30977055}, {.6, .5, .21208237}, {.6, 1, .15541466}};
  for (const auto& row : rows)
    EXPECT_NEAR(1 - std::sqrt(1 - row.w) * hapke_h(row.mu, row.w), row.albedo, 5e-9);
}

// The approximation of 2002 loses some 1 % of what a white surface reflects.
TEST(Hapke, PlaneAlbedoWithTheApproximationOf2002) {
  for (const auto& [mu, albedo] :
       {std::pair{0.1, .991}, std::pair{0.5, .987}, std::pair{1.0, .986}}) {
    const Vec3 v = hard_cases::direction(mu, 0);
    const f64::SurfaceFields s = surface(1, 0, 0, 0, 0, 0);
    EXPECT_NEAR(cosine_integral([&](const Vec3& l) { return f64::hapke(s, l, v, kNormal); }, 64),
                albedo, 6e-4);
  }
}

// The phase function has mean 1 over all directions whatever its asymmetry.
TEST(Hapke, PhaseFunctionIsNormalised) {
  for (const double b : {0.0, 0.25, 0.6, 0.9})
    for (const double c : {-1.0, 0.3, 1.0}) {
      double sum = 0;
      for (const auto& [x, w] : gauss(200)) {
        const double minus2 = 4 * x;  // 2 (1 - cos g), uniform over the sphere
        sum += w * f64::hapke_phase(b, c, minus2, 4 - minus2);
      }
      EXPECT_NEAR(sum, 1, 1e-12) << b << ' ' << c;
    }
  EXPECT_GT(f64::hapke_phase(0.5, 1.0, 0.0, 4.0), f64::hapke_phase(0.5, 1.0, 4.0, 0.0));
}

// The two lobes as printed, from the cosine of the phase angle.
TEST(Hapke, PhaseFunctionAsPrinted) {
  for (const double b : {0.0, 0.25, 0.9})
    for (const double c : {-1.0, 0.3, 1.0})
      for (const double g : {0.0, 0.1, 1.0, 2.0, 3.1, kPi}) {
        const auto lobe = [&](double sign) {
          return (1 - b * b) / std::pow(1 - sign * 2 * b * std::cos(g) + b * b, 1.5);
        };
        const double want = (1 + c) / 2 * lobe(1) + (1 - c) / 2 * lobe(-1);
        EXPECT_NEAR(f64::hapke_phase(b, c, 2 - 2 * std::cos(g), 2 + 2 * std::cos(g)) / want, 1,
                    2e-14);  // measured 8.2e-15, from 1 - cos g
      }
}

// B0/(1 + tan(g/2)/h): half its height where tan(g/2) = h, gone in forward scattering.
TEST(Hapke, OppositionSurge) {
  const double h = 0.07;
  const auto f = [&](double b0, double phase) {
    return f64::hapke(surface(0.3, h, b0, 0, 0, 0), from_angles(phase, 0), kNormal, kNormal);
  };
  const double lommel = 0.3 / (4 * kPi) / 2;
  EXPECT_NEAR(f(1, 0) - f(0, 0), lommel, 1e-15);
  const double g = 2 * std::atan(h);
  EXPECT_NEAR((f(1, g) - f(0, g)) / (0.3 / (4 * kPi) / (1 + std::cos(g))), 0.5, 1e-13);
}

// 1 + B0 (1 + (1 − e^−z)/z)/(2 (1 + z)²) multiplies everything, z = tan(g/2)/h.
TEST(Hapke, CoherentBackscatter) {
  const double h = 0.02, b0 = 0.6;
  f64::SurfaceFields with = surface(0.5, 0.05, 1, 0.3, 0.2, 0.4);
  const f64::SurfaceFields without = with;
  with.hapke_hc = h;
  with.hapke_bc0 = b0;
  double worst = 0;
  for (const double g : {1e-9, 1e-4, 0.01, 0.04, 0.3, 1.0, 1.5}) {
    const Vec3 l = from_angles(0.3 + g / 2, 0.2), v = from_angles(0.3 - g / 2, 0.2);
    const double z = std::tan(g / 2) / h;
    const double want = 1 + b0 * (1 - std::expm1(-z) / z) / (2 * (1 + z) * (1 + z));
    worst = std::max(
        worst,
        std::fabs(f64::hapke(with, l, v, kNormal) / f64::hapke(without, l, v, kNormal) / want - 1));
  }
  EXPECT_LE(worst, 1e-14) << worst;  // measured 1.4e-15
  with.hapke_hc = 0;
  EXPECT_EQ(f64::hapke(with, kNormal, kNormal, kNormal),
            f64::hapke(without, kNormal, kNormal, kNormal));
}

// Filling: r is K times that of particles apart whose cosines in H are smaller by K.
TEST(Hapke, Porosity) {
  const double phi = 0.4;
  const double dense =
      -std::log(1 - 1.209 * std::pow(phi, 2.0 / 3)) / (1.209 * std::pow(phi, 2.0 / 3));
  EXPECT_NEAR(porosity_factor(phi), dense, 1e-14);
  EXPECT_EQ(porosity_factor(0), 1);
  EXPECT_NEAR(porosity_factor(1e-9), 1 + 1.209e-6 / 2, 1e-11);
  const Material m = fitted(0.7, {.porosity = phi});
  const Vec3 l = from_angles(0.7, 1), v = from_angles(1.1, 0);
  const double h = hapke_h(l.z / dense, 0.7) * hapke_h(v.z / dense, 0.7);
  EXPECT_NEAR(f64::brdf(m, l, v, kNormal).x / (dense * 0.7 / (4 * kPi) / (l.z + v.z) * h), 1,
              1e-6);  // measured 2.0e-7, the error of the fit
}

// Directions all about, those below the horizon too, along the normal, opposed and equal.
std::vector<Scattering::Directions> all_directions() {
  std::vector<Scattering::Directions> out;
  const auto drawn = [](std::uint32_t i, std::uint32_t use) {
    const auto words = philox({i, use, 0, 0}, {5, 0});
    return glm::normalize(Vec3(in_unit(words[0]), in_unit(words[1]), in_unit(words[2])) - 0.5);
  };
  for (std::uint32_t i = 0; i < 3000; ++i) {
    const Vec3 normal = i % 3 == 0 ? kNormal : drawn(i, 0);
    // most above the horizon; one in ten at it
    const double up = i % 10 == 0 ? 1e-7 : 0.8;
    const Vec3 l = glm::normalize(drawn(i, 1) + up * normal),
               v = glm::normalize(drawn(i, 2) + up * normal);
    const Vec3 viewers[] = {v, v, v, l, normal, -v, glm::normalize(l + 1e-9 * v)};
    out.push_back({l, viewers[i % 7], normal, Vec3(1, 0.5, 0.25 * (i % 5))});
  }
  return out;
}

TEST(Hapke, ManyHaveTheBitsOfOne) {
  const std::vector<Scattering::Directions> at = all_directions();
  std::vector<Material> all{
      fitted(0.384, {.h = 0.052, .b0 = 1.7, .roughness = 0.41, .b = 0.229, .c = 0.426}),
      fitted(0.95, {.h = 0.3, .b0 = 0.5, .h_c = 0.02, .b_c0 = 0.8, .porosity = 0.3}), fitted(0),
      fitted(1, {.roughness = 1.2, .b = 0.9, .c = -1})};
  // others go one by one
  all.push_back(fitted(0.3));
  all.back().diffuse_brdf = OrenNayar{0.4};
  for (std::size_t m = 0; m < all.size(); ++m) {
    all[m].weights = {0.9, 0, 0};
    const Scattering scattering(all[m]);
    std::vector<Vec3> out(at.size());
    scattering.brdf(at, out);
    int lit = 0;
    for (std::size_t i = 0; i < at.size(); ++i) {
      const Vec3 one =
          scattering.brdf(at[i].to_light, at[i].to_viewer, at[i].normal, Vec3(0), at[i].tint);
      ASSERT_EQ(out[i], one) << m << ", " << i;
      lit += one.x > 0;
    }
    EXPECT_GT(lit, m == 2 ? -1 : 1000);
    // few, and none
    out.resize(3);
    scattering.brdf(std::span(at).first(3), out);
    EXPECT_EQ(out[2],
              scattering.brdf(at[2].to_light, at[2].to_viewer, at[2].normal, Vec3(0), at[2].tint));
    scattering.brdf({}, {});
  }
}

// Processors without wide registers give the same bits.
TEST(Hapke, PlainLanesHaveTheBitsOfWideOnes) {
  const std::vector<Scattering::Directions> at = all_directions();
  const f64::SurfaceFields s = f64::hapke_surface(0.384, 0.052, 1.7, 0.41, 0.229, 0.426, 1);
  HapkeLanes wide;
  for (std::size_t first = 0; first + HapkeLanes::kCount <= at.size();
       first += HapkeLanes::kCount) {
    for (int i = 0; i < HapkeLanes::kCount; ++i)
      for (int k = 0; k < 3; ++k) {
        const auto& from = at[first + static_cast<std::size_t>(i)];
        wide.to_light[k][i] = from.to_light[k];
        wide.to_viewer[k][i] = from.to_viewer[k];
        wide.normal[k][i] = from.normal[k];
      }
    HapkeLanes plain = wide;
    hapke(s, wide);
    plain_hapke(s, plain);
    for (int i = 0; i < HapkeLanes::kCount; ++i) {
      const auto& from = at[first + static_cast<std::size_t>(i)];
      ASSERT_EQ(wide.value[i], f64::hapke(s, from.to_light, from.to_viewer, from.normal));
      ASSERT_EQ(plain.value[i], wide.value[i]);
    }
  }
}

// Rough surfaces are continuous where angles vanish: the limits that public code gets wrong.
TEST(Hapke, RoughnessIsContinuousAtTheNormalAndInPlane) {
  const auto f = [](double i, double e, double psi) {
    return f64::hapke(surface(0.3, 0.1, 1.0, 0.4, 0.0, 0.0), from_angles(i, psi), from_angles(e, 0),
                      kNormal);
  };
  // measured 2.0e-12, 7.8e-16, 5.1e-13, 2.4e-15
  EXPECT_NEAR(f(1e-9, 0.7, 1.0), f(0, 0.7, 0), 1e-11);
  EXPECT_NEAR(f(0.5, 0.7, kPi - 1e-9), f(0.5, 0.7, kPi), 1e-14);
  EXPECT_NEAR(f(0.5, 0.5 + 1e-10, 2.0), f(0.5, 0.5 - 1e-10, 2.0), 5e-12);
  // as roughness goes to 0 the smooth surface comes back
  const Vec3 l = from_angles(0.5, 1), v = from_angles(0.9, 0);
  EXPECT_NEAR(f64::hapke(surface(0.3, 0.1, 1.0, 1e-6, 0.0, 0.0), l, v, kNormal),
              f64::hapke(surface(0.3, 0.1, 1.0, 0.0, 0.0, 0.0), l, v, kNormal), 1e-14);
}

}  // namespace
}  // namespace panwright::materials::hapke_test
