// Facets whose reflectance comes from a map, against textbooks and balances.
#include <gtest/gtest.h>

#include <array>
#include <complex>
#include <cstdio>

#include "materials/brdf.h"
#include "materials/energy.h"
#include "materials/internal/formulas.h"
#include "materials/report.h"
#include "tests/materials/quadrature.h"

namespace panwright::materials::reflectance_map_test {
namespace {

const Vec3 kNormal(0, 0, 1);

Material microfacets(double slope, const std::optional<Vec3>& n, const Vec3& k = Vec3(0)) {
  Material m;
  m.weights = {0, 1, 0};
  m.specular = Vec3(1);
  m.specular_brdf = Ggx{slope, slope};
  m.refract = n;
  m.extinction = k;
  m.maps.reflectance = 0;
  fit(m);
  return m;
}

ShadingContext under(const Vec3& reflectance) { return {Vec3(0), reflectance}; }

// Fresnel's equations with a complex index, as they stand in textbooks.
double textbook(double cos_i, double n, double k) {
  using Complex = std::complex<long double>;
  const Complex index(n, k);
  const long double c = cos_i;
  const Complex cos_t = std::sqrt(Complex(1) - (1 - c * c) / (index * index));
  const Complex rs = (c - index * cos_t) / (c + index * cos_t);
  const Complex rp = (index * c - cos_t) / (index * c + cos_t);
  return static_cast<double>((std::norm(rs) + std::norm(rp)) / 2);
}

double f0_of(double n, double k) {
  return ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
}

// gold, aluminium and a metal that dips below F0
const Vec3 kN(0.17, 1.37, 3.5);
const Vec3 kK(3.1, 7.6, 3.3);

TEST(ReflectanceMap, FitIsTheClosedForm) {
  for (const SpecularModel brdf : {SpecularModel::cook_torrance, SpecularModel::beckmann,
                                   SpecularModel::ggx, SpecularModel::mirror}) {
    Material m = microfacets(0.3, kN, kK);
    m.specular_brdf = with_slopes(brdf, Vec2(0.3));
    fit(m);
    for (int i = 0; i < 3; ++i)  // measured 2e-16
      EXPECT_NEAR(m.fits.f0[i], f0_of(kN[i], kK[i]), 1e-14);
    m.coat = Coat{.index = 1.5};
    fit(m);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(m.fits.f0[i], f0_of(kN[i] / 1.5, kK[i] / 1.5), 1e-14);
    m.coat = {};
    m.extinction = Vec3(0);
    fit(m);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(m.fits.f0[i], f0_of(kN[i], 0), 1e-14);
    m.refract = {};
    fit(m);
    EXPECT_EQ(m.fits.f0, Vec3(1));
  }
  Material m;
  fit(m);
  EXPECT_EQ(m.fits.f0, Vec3(0));
  EXPECT_FALSE(brdf_model_of(m).mapped);
  m.maps.reflectance = 0;  // without microfacets
  EXPECT_FALSE(brdf_model_of(m).mapped);
  EXPECT_TRUE(brdf_model_of(microfacets(0.3, {})).mapped);
}

// Schlick's curve from F0 becomes Schlick's curve from R.
TEST(ReflectanceMap, SchlickStaysSchlick) {
  for (const double f0 : {0.0, 0.04, 0.5, 0.95})
    for (const double r : {0.0, 0.04, 0.3, 0.95, 1.0})
      for (const double cosine : {0.0, 0.1, 0.5, 0.9, 1.0}) {
        const double rise = std::pow(1 - cosine, 5);
        EXPECT_NEAR(f64::fresnel_from(f0 + (1 - f0) * rise, f0, r), r + (1 - r) * rise, 1e-15);
      }
}

// The lobe is what the indices leave it, Fresnel's term apart: that is linear in R, 0 to 1, its own
// where R = F0, R at normal incidence, and 1 at grazing.
TEST(ReflectanceMap, TakesThePlaceOfF0) {
  Material m = microfacets(0.4, kN, kK);
  m.compensation = Compensation::off;
  fit(m);
  Material bright = m;
  bright.refract = {};
  bright.extinction = Vec3(0);
  bright.maps.reflectance = -1;
  fit(bright);
  double worst = 0;
  for (const double polar : {0.0, 0.4, 0.9, 1.3, 1.5})
    for (const double other : {0.0, 0.7, 1.4}) {
      const Vec3 l = from_angles(polar, 0.3), v = from_angles(other, 2.0);
      const Vec3 lobe = f64::brdf(bright, l, v, kNormal);
      const double cosine = std::sqrt(0.5 * (1 + glm::dot(l, v)));
      for (const double r : {0.0, 0.02, 0.3, 0.7, 1.0}) {
        const Vec3 f = f64::brdf(m, l, v, kNormal, Vec3(1), under(Vec3(r)));
        for (int k = 0; k < 3; ++k) {
          const double own = textbook(cosine, kN[k], kK[k]), f0 = f0_of(kN[k], kK[k]);
          const double want = own < f0 ? r * own / f0 : r + (own - f0) * (1 - r) / (1 - f0);
          worst = std::max(worst, std::fabs(f[k] / lobe[k] - want));
          EXPECT_GE(f[k], 0);
          EXPECT_LE(f[k], lobe[k] * (1 + 1e-15));
        }
      }
      const Vec3 own = f64::brdf(m, l, v, kNormal);
      const Vec3 same = f64::brdf(m, l, v, kNormal, Vec3(1), under(m.fits.f0));
      EXPECT_EQ(own, same);
      Material plain = m;
      plain.maps.reflectance = -1;
      const Vec3 without = f64::brdf(plain, l, v, kNormal);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(own[k] / without[k], 1, 1e-14);
    }
  std::printf("worst %.1e\n", worst);
  EXPECT_LE(worst, 2e-15);  // measured 4.4e-16
  // where F is 1, or near it, R is all there is
  const Material mirror = microfacets(0.4, {});
  const Vec3 l = from_angles(0.3, 0.3), v = from_angles(0.5, 2.0);
  EXPECT_EQ(f64::brdf(bright, l, v, kNormal) * 0.25, [&] {
    Material once = mirror;
    once.compensation = Compensation::off;
    fit(once);
    return f64::brdf(once, l, v, kNormal, Vec3(1), under(Vec3(0.25)));
  }());
  EXPECT_EQ(f64::fresnel_from(1 - 1e-8, 1 - 1e-7, 0.25), 0.25);
}

// A mean over texels is the BRDF of the mean texel: what mip levels rest on.
TEST(ReflectanceMap, IsLinear) {
  for (const Material& m : {microfacets(0.1, kN, kK), microfacets(0.8, kN, kK),
                            microfacets(0.5, Vec3(1.5)), microfacets(0.5, {})}) {
    for (const double polar : {0.1, 0.9, 1.4}) {
      const Vec3 l = from_angles(polar, 0.3), v = from_angles(0.7, 2.0);
      const auto f = [&](double r) {
        return f64::brdf(m, l, v, kNormal, Vec3(1), under(r * m.fits.f0));
      };
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(f(0.3)[k], 0.7 * f(0)[k] + 0.3 * f(1)[k], 1e-14 * f(1)[k]);
    }
  }
}

// Whatever a map says, no light is gained, and more R is never less light.
TEST(ReflectanceMap, NoMapGainsEnergy) {
  std::vector<std::pair<const char*, Material>> all;
  for (const double slope : {0.05, 0.3, 1.0}) {
    all.push_back({"F = 1", microfacets(slope, {})});
    all.push_back({"conductors", microfacets(slope, kN, kK)});
    all.push_back({"dielectric", microfacets(slope, Vec3(1.5))});
    Material m = microfacets(slope, kN, kK);
    m.coat = Coat{.index = 1.5};
    fit(m);
    all.push_back({"conductors under a coat", m});
    m.specular_brdf = Mirror{};
    fit(m);
    all.push_back({"mirrors under a coat", m});
  }
  for (const auto& [name, m] : all) {
    const double slope = slopes_of(m).value_or(Vec2(0.5)).x;
    double most = 0;
    for (const double mu : {0.02, 0.2, 1.0}) {
      Vec3 last(0);
      for (const double r : {0.0, 0.1, 0.6, 1.0}) {
        const Vec3 albedo = directional_albedo(m, mu, 0, Vec3(r));
        for (int k = 0; k < 3; ++k) {
          EXPECT_GE(albedo[k], last[k]) << name << ' ' << mu << ' ' << r;
          most = std::max(most, albedo[k]);
        }
        last = albedo;
      }
      // own quadrature, of what has no mirror's direction
      if (!(slope > 0.2) || m.coat) continue;
      for (const double r : {0.1, 1.0}) {
        const Vec3 v(std::sqrt(1 - mu * mu), 0, mu);
        const double found = cosine_integral(
            [&, &m = m](const Vec3& l) {
              return f64::brdf(m, l, v, kNormal, Vec3(1), under(Vec3(r))).y;
            },
            96);
        EXPECT_NEAR(found, directional_albedo(m, mu, 0, Vec3(r)).y, 2e-3) << name << ' ' << mu;
      }
    }
    std::printf("%-24s slope %g: at most %.6f\n", name, slope, most);
    EXPECT_LE(most, 1 + 2e-4);  // measured 1.06e-4
    EXPECT_GE(energy_gain(m).albedo, most - 2e-3);
  }
}

// White everywhere, under an even sky: microfacets that scatter more than once send all of it back.
TEST(ReflectanceMap, WhiteFurnace) {
  double worst = 0;
  for (const double slope : {0.3, 0.6, 1.0}) {
    const Material m = microfacets(slope, {});
    ASSERT_TRUE(brdf_model_of(m).compensated);
    for (const double mu : {0.05, 0.2, 0.5, 1.0})
      worst = std::max(worst, std::fabs(directional_albedo(m, mu, 0, Vec3(1)).x - 1));
  }
  std::printf("worst %.1e\n", worst);
  EXPECT_LE(worst, 3e-4);  // measured 1.8e-4
}

// Float follows double whatever the map says.
TEST(ReflectanceMap, ReportLooksAtAllOfIt) {
  const std::array<double, 1> mus{0.5};
  for (const Material& m : {microfacets(0.3, kN, kK), microfacets(0.3, Vec3(1.5))}) {
    const MaterialReport c = material_report(m, mus);
    std::printf("float: worst %.1e, rms %.1e\n", c.f32_error, c.f32_rms);
    EXPECT_LE(c.f32_rms, 2e-6);  // measured 1.1e-6
  }
  EXPECT_NE(brdf_in_words(microfacets(0.3, kN, kK)).find("of mapped reflectance"),
            std::string::npos);
}

TEST(ReflectanceMap, WithoutFacetsItIsIdle) {
  Fields fields;
  fields.maps = Maps{.reflectance = 0};
  const auto notes = [&] {
    DiagnosticLog log;
    resolved(fields, {}, log);
    return to_text(log);
  };
  EXPECT_NE(notes().find("reflectance_map has no effect, because only cook"), std::string::npos);
  fields.specular = Vec3(1);
  fields.blinn_phong = BlinnPhong{20};
  EXPECT_NE(notes().find("reflectance_map has no effect, because only cook"), std::string::npos);
  fields.blinn_phong = {};
  fields.ggx = Ggx{0.2, 0.2};
  fields.specular_model = SpecularModel::ggx;
  EXPECT_EQ(notes().find("reflectance_map"), std::string::npos);
  fields.specular = Vec3(0);
  EXPECT_NE(notes().find("reflectance_map has no effect, because the specular colour is 0"),
            std::string::npos);
}

}  // namespace
}  // namespace panwright::materials::reflectance_map_test
