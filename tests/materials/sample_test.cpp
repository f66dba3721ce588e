// Directions drawn by Scattering against its densities and against quadrature.
#include "materials/sample.h"

#include <gtest/gtest.h>

#include <cmath>

#include "materials/hapke_h.h"

#include "base/random.h"
#include "materials/brdf.h"
#include "materials/energy.h"
#include "tests/materials/quadrature.h"

namespace panwright::materials::sample_test {
namespace {

const Vec3 kNormal(0, 0, 1);
const Vec3 kTangent(1, 0, 0);
const Vec3 kWhite(1);

struct Case {
  std::string name;
  Material material;
  std::optional<Vec3> reflectance;  // what a map says
};

Scattering scattering_of(const Case& c) {
  const Scattering plain(c.material);
  return c.reflectance ? plain.reflecting(*c.reflectance) : plain;
}

Case microfacets(const char* name, SpecularModel brdf, double x, double y) {
  Case c{name, {}, {}};
  c.material.weights = {0, 1, 0};
  c.material.specular = {0.9, 0.7, 0.5};
  c.material.specular_brdf =
      brdf == SpecularModel::blinn_phong ? SpecularBrdf(BlinnPhong{30}) : with_slopes(brdf, {x, y});
  return c;
}

std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back({"lambert", {}, {}});
  all.push_back(microfacets("blinn_phong", SpecularModel::blinn_phong, 0.5, 0.5));
  all.push_back(microfacets("cook_torrance", SpecularModel::cook_torrance, 0.3, 0.3));
  all.push_back(microfacets("beckmann", SpecularModel::beckmann, 0.4, 0.4));
  all.push_back(microfacets("brushed beckmann", SpecularModel::beckmann, 0.5, 0.15));
  all.push_back(microfacets("ggx", SpecularModel::ggx, 0.3, 0.3));
  all.push_back(microfacets("brushed ggx", SpecularModel::ggx, 0.2, 0.6));
  Case silver = microfacets("silver", SpecularModel::ggx, 0.5, 0.5);
  silver.material.refract = Vec3(0.15);
  silver.material.extinction = Vec3(3);
  all.push_back(silver);
  Case mixed = microfacets("mixed", SpecularModel::ggx, 0.25, 0.25);
  mixed.material.weights = {0.6, 0.4, 0};
  mixed.material.refract = Vec3(1.5);
  all.push_back(mixed);
  Case paint = microfacets("paint under a rough coat", SpecularModel::none, 0.5, 0.5);
  paint.material.weights = {1, 0, 0};
  paint.material.diffuse = {0.9, 0.5, 0.1};
  paint.material.coat = Coat{.index = 1.5, .alpha = 0.2};
  all.push_back(paint);
  Case foil = microfacets("foil under film", SpecularModel::beckmann, 0.2, 0.1);
  foil.material.coat = Coat{.index = 1.7, .alpha = 0, .depth = {0.1, 0.5, 1}};
  all.push_back(foil);
  Case cell = microfacets("tilted mirror under glass", SpecularModel::mirror, 0.5, 0.5);
  cell.material.weights = {0.2, 0.8, 0};
  cell.material.coat = Coat{.index = 1.5};
  cell.material.cells = Cells{.tilt = {0.03, -0.02}};
  all.push_back(cell);
  // below, at and above F0; red dips towards grazing
  Case panel = microfacets("mapped metal", SpecularModel::ggx, 0.4, 0.4);
  panel.material.refract = Vec3(3.5, 0.5, 1.5);
  panel.material.extinction = Vec3(3, 2, 2);
  panel.material.maps.reflectance = 0;
  panel.reflectance = Vec3(0.1, 0.9, 0);
  all.push_back(panel);
  Case film = microfacets("mapped mirror under film", SpecularModel::mirror, 0.5, 0.5);
  film.material.refract = Vec3(0.2);
  film.material.extinction = Vec3(4);
  film.material.coat = Coat{.index = 1.5, .alpha = 0.4, .depth = {0.1, 0.2, 0.3}};
  film.material.maps.reflectance = 0;
  film.reflectance = Vec3(0.25, 1, 0);
  all.push_back(film);
  Case cube = microfacets("retroreflector", SpecularModel::retroreflector, 0.5, 0.5);
  cube.material.specular_brdf = Retroreflector{.index = 1.46, .width = 0.08};
  all.push_back(cube);
  Case tape =
      microfacets("wide retroreflector with a cut-off", SpecularModel::retroreflector, 0.5, 0.5);
  tape.material.specular_brdf = Retroreflector{.depth = 0.2, .cutoff = 1.2, .width = 0.3};
  tape.material.weights = {0.3, 0.7, 0};
  all.push_back(tape);
  for (Case& c : all) fit(c.material);
  return all;
}

// The i-th draw of a viewer.
std::optional<Sampled> draw(const Scattering& scattering, const Vec3& v, std::uint32_t i) {
  const auto words = philox({i, 0, 0, 0}, {2, 5});
  return scattering.sample(v, kNormal, kTangent, kWhite, {in_unit(words[0]), in_unit(words[1])},
                           in_unit(words[2]));
}

const std::array kViewers{from_angles(0.0, 0), from_angles(0.6, 0.4), from_angles(1.2, 2.0),
                          from_angles(1.5, -1.0)};

// The mean weight is the albedo that quadrature finds, and a weight is f cosθ over the density.
TEST(Sample, MeanWeightIsTheAlbedo) {
  constexpr std::uint32_t kDraws = 40000;
  double worst = 0;
  for (const Case& c : cases()) {
    const Scattering scattering = scattering_of(c);
    for (const Vec3& v : kViewers) {
      Vec3 sum(0), squares(0);
      for (std::uint32_t i = 0; i < kDraws; ++i) {
        const auto s = draw(scattering, v, i);
        if (!s) continue;
        sum += s->weight;
        squares += s->weight * s->weight;
        ASSERT_NEAR(glm::length(s->to_light), 1, 1e-12);
        ASSERT_GT(s->to_light.z, 0);
        if (s->delta || i % 16 != 0) continue;
        const double pdf = scattering.pdf(s->to_light, v, kNormal, kTangent, kWhite);
        ASSERT_NEAR(pdf, s->pdf, 1e-9 * pdf) << c.name;
        const Vec3 f = scattering.brdf(s->to_light, v, kNormal, kTangent, kWhite);
        ASSERT_NEAR(s->weight.x, f.x * s->to_light.z / pdf, 1e-9 * s->weight.x + 1e-15) << c.name;
      }
      const Vec3 mean = sum / static_cast<double>(kDraws);
      const double azimuth = std::atan2(v.y, v.x);
      const Vec3 want = directional_albedo(c.material, v.z, azimuth, c.reflectance);
      for (int k = 0; k < 3; ++k) {
        const double variance = squares[k] / kDraws - mean[k] * mean[k];
        const double sigma = std::sqrt(std::max(variance, 0.0) / kDraws) + 1e-6;
        worst = std::max(worst, std::fabs(mean[k] - want[k]) / sigma);
        EXPECT_NEAR(mean[k], want[k], 4 * sigma) << c.name << ' ' << v.z;
      }
    }
  }
  std::printf("worst %.2f sigma\n", worst);
}

// Histogram of directions against the density, integrated bin by bin: Pearson's test.
TEST(Sample, DirectionsFollowTheirDensity) {
  constexpr int kRows = 10, kColumns = 20;
  constexpr std::uint32_t kDraws = 200000;
  const auto nodes = gauss(12);
  for (const Case& c : cases()) {
    const Scattering scattering = scattering_of(c);
    for (const Vec3& v : {kViewers[1], kViewers[2]}) {
      std::vector<double> seen(kRows * kColumns), expected(kRows * kColumns);
      double elsewhere = 0;
      for (std::uint32_t i = 0; i < kDraws; ++i) {
        const auto s = draw(scattering, v, i);
        if (!s || s->delta) {
          ++elsewhere;
          continue;
        }
        const int row = std::min(static_cast<int>(s->to_light.z * kRows), kRows - 1);
        const double turn = std::atan2(s->to_light.y, s->to_light.x) / (2 * kPi) + 0.5;
        const int column = std::min(static_cast<int>(turn * kColumns), kColumns - 1);
        ++seen[static_cast<std::size_t>(row * kColumns + column)];
      }
      double total = 0;
      for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < kColumns; ++column)
          for (const auto& [a, wa] : nodes)
            for (const auto& [b, wb] : nodes) {
              const double z = (row + a) / kRows;
              const double phi = 2 * kPi * ((column + b) / kColumns - 0.5);
              const double sine = std::sqrt(1 - z * z);
              const double p = scattering.pdf({sine * std::cos(phi), sine * std::sin(phi), z}, v,
                                              kNormal, kTangent, kWhite) *
                               wa * wb * 2 * kPi / (kRows * kColumns);
              expected[static_cast<std::size_t>(row * kColumns + column)] += p * kDraws;
              total += p;
            }
      // what is drawn is either here or not; 4 sigma
      const double p = elsewhere / kDraws;
      EXPECT_NEAR(total + p, 1, 4 * std::sqrt(p * (1 - p) / kDraws) + 1e-3) << c.name;
      double chi2 = 0, pooled_seen = 0, pooled_expected = 0;
      int degrees = 0;
      for (std::size_t i = 0; i < seen.size(); ++i) {
        if (expected[i] < 5) {
          pooled_seen += seen[i];
          pooled_expected += expected[i];
          continue;
        }
        chi2 += (seen[i] - expected[i]) * (seen[i] - expected[i]) / expected[i];
        ++degrees;
      }
      if (pooled_expected >= 5) {
        chi2 += (pooled_seen - pooled_expected) * (pooled_seen - pooled_expected) / pooled_expected;
        ++degrees;
      }
      // Wilson and Hilferty: the cube root is normal. 1 % shared among 28 tests: 3.39 sigma
      const double k = degrees;
      const double z = (std::cbrt(chi2 / k) - (1 - 2 / (9 * k))) / std::sqrt(2 / (9 * k));
      EXPECT_LE(z, 3.39) << c.name << ' ' << v.z << " chi2 " << chi2 << " of " << degrees;
    }
  }
}

TEST(Sample, Mirrors) {
  Case c = microfacets("mirror", SpecularModel::mirror, 0.5, 0.5);
  Scattering scattering(c.material);
  EXPECT_TRUE(scattering.has_delta());
  EXPECT_EQ(scattering.mirror_reflectance(0.3), c.material.specular);
  const Vec3 v = from_angles(0.8, 0.5);
  const auto s = scattering.sample(v, kNormal, Vec3(0), kWhite, {0.3, 0.4}, 0.99);
  ASSERT_TRUE(s && s->delta);
  EXPECT_NEAR(glm::length(s->to_light - from_angles(0.8, 0.5 + kPi)), 0, 1e-15);
  EXPECT_EQ(s->pdf, 0);
  EXPECT_EQ(s->weight, c.material.specular);
  // under a rough coat it is a lobe
  c.material.coat = Coat{.index = 1.5, .alpha = 0.1};
  fit(c.material);
  EXPECT_FALSE(Scattering(c.material).has_delta());
  EXPECT_FALSE(Scattering(Material{}).has_delta());
  EXPECT_EQ(Scattering(Material{}).mirror_reflectance(0.5), Vec3(0));
  // tilted against its smooth coat: two directions, and what is tilted by t is mirrored by 2t
  c.material.coat->alpha = 0;
  c.material.cells = Cells{.tilt = {0.1, 0}};
  fit(c.material);
  const Mirrors two = Scattering(c.material).mirrors(kNormal, kNormal, kTangent);
  ASSERT_EQ(two.count, 2);
  EXPECT_EQ(two.all[0].to_light, kNormal);
  EXPECT_NEAR(two.all[1].to_light.x, -std::sin(0.2), 1e-14);
}

TEST(Sample, EvaluationIsThatOfTheBrdfs) {
  for (const Case& c : cases()) {
    const Scattering scattering = scattering_of(c);
    for (const Vec3& v : kViewers) {
      const Vec3 l = from_angles(0.9, 1.1), tint(0.5, 0.25, 1);
      EXPECT_EQ(scattering.brdf(l, v, kNormal, kTangent, tint),
                f64::brdf(c.material, l, v, kNormal, tint, {kTangent, c.reflectance}));
    }
  }
  // maps multiply slopes
  Case c = microfacets("ggx", SpecularModel::ggx, 0.3, 0.2);
  c.material.compensation = Compensation::off;
  Case half = microfacets("ggx", SpecularModel::ggx, 0.15, 0.1);
  half.material.compensation = Compensation::off;
  const Vec3 l = from_angles(0.5, 1.1), v = from_angles(0.6, 4);
  EXPECT_EQ(Scattering(c.material).scaled(0.5).brdf(l, v, kNormal, kTangent, kWhite),
            Scattering(half.material).brdf(l, v, kNormal, kTangent, kWhite));
}

// Nothing a caller may pass gives a NaN, and viewers under the horizon see what is at it.
TEST(Sample, HardPlaces) {
  for (const Case& c : cases()) {
    for (const double roughness : {0.0, 1e-6, 1.0, 100.0}) {
      const Scattering scattering = scattering_of(c).scaled(roughness);
      for (const double mu : {-1.0, -0.3, 0.0, 1e-12, 1e-6, 0.5, 1.0}) {
        const Vec3 v(std::sqrt(1 - mu * mu), 0, mu);
        for (std::uint32_t i = 0; i < 200; ++i) {
          const auto words = philox({i, 1, 0, 0}, {7, 11});
          // the ends of the unit square as well
          const Vec2 u(i % 5 == 0 ? 0 : in_unit(words[0]), i % 7 == 0 ? 0 : in_unit(words[1]));
          const auto s = scattering.sample(v, kNormal, i % 2 ? kTangent : Vec3(0), kWhite, u,
                                           in_unit(words[2]));
          if (!s) continue;
          ASSERT_TRUE(is_finite(s->weight) && is_finite(s->to_light) && std::isfinite(s->pdf))
              << c.name << ' ' << mu;
          ASSERT_TRUE(s->weight.x >= 0 && s->pdf >= 0) << c.name << ' ' << mu;
        }
      }
    }
  }
}

// Isotropic grains without opposition: w/4π (H H)/(μ0 + μ), with H of the integral itself.
TEST(Sample, HapkeWithItsExactH) {
  double worst = 0;
  for (const double w : {0.3, 0.9, 1.0}) {
    Material m;
    m.diffuse = Vec3(1);
    m.diffuse_brdf = Hapke{.w = w, .h = 0.1};
    fit(m);
    const Scattering scattering(m);
    for (const double a : {0.02, 0.3, 0.77, 1.0})
      for (const double b : {0.05, 0.5, 1.0}) {
        const Vec3 l(std::sqrt(1 - a * a), 0, a);
        const Vec3 v(0, std::sqrt(1 - b * b), b);
        const double want = w / (4 * kPi) * hapke_h(a, w) * hapke_h(b, w) / (a + b);
        const double got = scattering.brdf(l, v, {0, 0, 1}, Vec3(0), Vec3(1)).x;
        worst = std::max(worst, std::fabs(got / want - 1));
      }
  }
  EXPECT_LE(worst, 1e-9) << worst;  // measured 2e-10; with the fit 1e-6
}

// The slope of a Blinn-Phong lobe: its RMS over half vectors, and its half width to second order.
TEST(Sample, SlopesOfShine) {
  for (const double shine : {2.0, 10.0, 25.0, 100.0, 1000.0}) {
    const double slope = slope_of_shine(shine);
    constexpr int kSteps = 1'000'000;
    double sum = 0, weight = 0;
    // u: sin² of the angle; uniform over the projected hemisphere
    for (int k = 0; k < kSteps; ++k) {
      const double u = (k + 0.5) / kSteps;
      const double density = std::pow(1 - u, 0.5 * shine);  // cos^shine
      sum += density * u / (1 - u);
      weight += density;
    }
    EXPECT_NEAR(std::sqrt(sum / weight), slope, 2e-4 * slope) << shine;
    if (shine < 25) continue;
    const double half = std::sqrt(std::pow(2.0, 2 / shine) - 1);
    EXPECT_NEAR(half, slope * std::sqrt(std::log(2.0)), 0.015 * slope) << shine;
  }
}

TEST(Sample, NarrowestSlopes) {
  const auto slope = [](const Material& m, Lobes lobes) { return narrowest_slope(m, lobes); };
  Material m;
  EXPECT_FALSE(slope(m, Lobes::about_normal));
  m.specular_brdf = Ggx{0.3, 0.1};
  EXPECT_EQ(slope(m, Lobes::about_normal), 0.1);
  m.coat = Coat{.index = 1.5, .alpha = 0};
  EXPECT_EQ(slope(m, Lobes::about_normal), 0);
  EXPECT_EQ(slope(m, Lobes::finite), 0.1);
  m.specular_brdf = Mirror{};
  EXPECT_FALSE(slope(m, Lobes::finite));
  m.coat->alpha = 0.2;
  EXPECT_DOUBLE_EQ(slope(m, Lobes::about_normal).value(), 0.1 * std::sqrt(0.5));
  m.coat.reset();
  m.specular_brdf = Retroreflector{.width = 0.1};
  EXPECT_FALSE(slope(m, Lobes::about_normal));
  EXPECT_DOUBLE_EQ(slope(m, Lobes::finite).value(), 0.1 * std::sqrt(0.5));
}

}  // namespace
}  // namespace panwright::materials::sample_test
