// The material as a whole: weights, colours, emission, tint (docs/conventions.md, reflection).
#include "materials/brdf.h"

#include <gtest/gtest.h>

#include "tests/materials/quadrature.h"
#include "tests/support/hard_cases.h"

namespace panwright::materials::brdf_test {
namespace {

const Vec3 kNormal(0, 0, 1);
const Vec3 kLight = from_angles(0.6, 0.4);
const Vec3 kViewer = from_angles(0.5, 2.8);

Material figure8() {
  Material m;
  m.diffuse = {0.7038, 0.27048, 0.0828};
  m.specular = Vec3(1);
  m.refract = Vec3(1.5);
  m.weights = {0.9, 0.1, 0};
  m.specular_brdf = CookTorrance{.alpha = 0.15};
  return m;
}

TEST(Brdf, WeightsTimesColorTimesBrdf) {
  const double lobe = f64::fresnel_dielectric(f64::half_cosine(kLight, kViewer), 1.5) *
                      f64::cook_torrance(0.15, kLight, kViewer, kNormal);
  ASSERT_GT(lobe, 0.01);
  const Vec3 want = 0.9 / kPi * Vec3(0.7038, 0.27048, 0.0828) + Vec3(0.1 * lobe);
  const Vec3 got = f64::brdf(figure8(), kLight, kViewer, kNormal);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(got[k], want[k], 1e-15);
}

TEST(Brdf, EveryPairOfBrdfs) {
  for (const auto diffuse : {DiffuseModel::lambert, DiffuseModel::oren_nayar, DiffuseModel::hapke,
                             DiffuseModel::eon, DiffuseModel::lommel_seeliger})
    for (const auto specular :
         {SpecularModel::none, SpecularModel::blinn_phong, SpecularModel::cook_torrance}) {
      Material m = figure8();
      if (diffuse == DiffuseModel::lambert) m.diffuse_brdf = Lambert{};
      if (diffuse == DiffuseModel::oren_nayar) m.diffuse_brdf = OrenNayar{0.3};
      if (diffuse == DiffuseModel::hapke)
        m.diffuse_brdf = Hapke{.w = 0.4, .h = 0.06, .b0 = 1, .roughness = 0.3};
      if (diffuse == DiffuseModel::eon) m.diffuse_brdf = Eon{0.3};
      if (diffuse == DiffuseModel::lommel_seeliger) m.diffuse_brdf = LommelSeeliger{0.4};
      if (specular == SpecularModel::none) m.specular_brdf = NoSpecular{};
      if (specular == SpecularModel::blinn_phong) m.specular_brdf = BlinnPhong{12};
      m.weights = {0.6, 0.4, 0};
      fit(m);
      Vec3 want(0);
      const Vec3 rho = m.diffuse;
      if (diffuse == DiffuseModel::lambert) want = 0.6 * rho / kPi;
      if (diffuse == DiffuseModel::oren_nayar)
        want = 0.6 * f64::oren_nayar(rho, 0.3, kLight, kViewer, kNormal);
      if (diffuse == DiffuseModel::hapke)
        want = 0.6 * rho * f64::hapke(f64::surface_of(m), kLight, kViewer, kNormal);
      if (diffuse == DiffuseModel::eon) want = 0.6 * f64::eon(rho, 0.3, kLight, kViewer, kNormal);
      if (diffuse == DiffuseModel::lommel_seeliger)
        want = 0.6 * rho * 0.4 / (4 * kPi * (kLight.z + kViewer.z));
      if (specular == SpecularModel::blinn_phong)
        want += 0.4 * f64::blinn_phong(12.0, kLight, kViewer, kNormal);
      if (specular == SpecularModel::cook_torrance)
        want += 0.4 * Vec3(f64::fresnel_dielectric(f64::half_cosine(kLight, kViewer), 1.5) *
                           f64::cook_torrance(0.15, kLight, kViewer, kNormal));
      const Vec3 got = f64::brdf(m, kLight, kViewer, kNormal);
      const glm::vec3 single = f32::brdf(m, kLight, glm::vec3(kViewer), glm::vec3(kNormal));
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(got[k], want[k], 1e-15);
        EXPECT_NEAR(static_cast<double>(single[k]), want[k], 2e-6 * want[k]);
      }
    }
}

TEST(Brdf, RadianceOfReflectionAndEmission) {
  Material m;
  m.diffuse = Vec3(0.5);
  m.emissive = {0.2, 0.4, 0.6};
  m.weights = {1, 0, 0.5};
  const Vec3 irradiance(3, 2, 1);
  const Vec3 white(7, 0.5, 0);
  const Vec3 lit = f64::radiance(m, {kLight, irradiance}, kViewer, kNormal);
  const Vec3 emitted = f64::emission(m, white);
  EXPECT_EQ(f64::radiance(m, {-kLight, irradiance}, kViewer, kNormal), Vec3(0));
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(lit[k], 0.5 / kPi * irradiance[k] * kLight.z, 1e-15);
    EXPECT_NEAR(emitted[k], 0.5 * m.emissive[k] * white[k] / kPi, 1e-15);
    EXPECT_NEAR(static_cast<double>(f32::emission(m, glm::vec3(white))[k]), emitted[k],
                1e-7 * emitted[k]);
  }
}

// A white Lambert plate at normal Sun has π L = E.
TEST(Brdf, WhitePlate) {
  Material m;
  m.diffuse = Vec3(1);
  EXPECT_NEAR(f64::radiance(m, kNormal, kViewer, kNormal).x * kPi, 1, 1e-15);
}

TEST(Brdf, TintMultipliesDiffuseOnly) {
  Material m = figure8();
  m.diffuse_brdf = OrenNayar{0.5};
  const Vec3 tint(0.5, 0.25, 0);
  Material tinted = m;
  tinted.diffuse = m.diffuse * tint;
  EXPECT_EQ(f64::brdf(m, kLight, kViewer, kNormal, tint),
            f64::brdf(tinted, kLight, kViewer, kNormal));
  EXPECT_GT(f64::brdf(m, kLight, kViewer, kNormal, Vec3(0)).x, 0);
}

TEST(Brdf, CookFactorsMultiply) {
  Material m = figure8();
  m.diffuse = Vec3(0);
  const double plain = f64::brdf(m, kLight, kViewer, kNormal).x;
  m.specular_brdf = CookTorrance{2, 0.15, 0.5, 3};
  EXPECT_NEAR(f64::brdf(m, kLight, kViewer, kNormal).x, 3 * plain, 1e-14 * plain);
}

TEST(Brdf, NoIndexIsAMirror) {
  Material m = figure8();
  m.diffuse = Vec3(0);
  const double glass = f64::brdf(m, kLight, kViewer, kNormal).x;
  m.refract.reset();
  const double cos_vh = 0.5 * glm::length(kLight + kViewer);
  EXPECT_NEAR(f64::brdf(m, kLight, kViewer, kNormal).x * f64::fresnel_dielectric(cos_vh, 1.5),
              glass, 1e-15);
}

// Smooth normals near the limb: the BRDF goes on as at the horizon, without a dark rim and without
// a step; light from below gives nothing.
TEST(Brdf, HorizonOfTheViewer) {
  Material m = figure8();
  const Vec3 light = from_angles(1.0, kPi / 2);
  const Vec3 above = hard_cases::direction(2e-6, 0);
  Vec3 below = above;
  below.z = -0.05;
  below = glm::normalize(below);
  EXPECT_NEAR(f64::brdf(m, light, below, kNormal).x, f64::brdf(m, light, above, kNormal).x, 1e-5);
  EXPECT_GE(f64::brdf(m, light, below, kNormal).x, 0.9 * 0.7038 / kPi);
  EXPECT_EQ(f64::brdf(m, -light, above, kNormal), Vec3(0));
  for (const double z : {0.0, -1e-9, -0.5, -1.0}) {
    const Vec3 v(std::sqrt(1 - z * z), 0, z);
    EXPECT_TRUE(is_finite(f64::brdf(m, light, v, kNormal))) << z;
    const glm::vec3 single = f32::brdf(m, light, glm::vec3(v), glm::vec3(kNormal));
    EXPECT_TRUE(is_finite(Vec3(single))) << z;
  }
}

TEST(Brdf, CompiledIsTheSame) {
  Material m = figure8();
  for (int kind = 0; kind < 3; ++kind) {
    if (kind == 1) m.coat = Coat{.index = 1.5, .alpha = 0.1, .depth = Vec3(0.1)};
    if (kind == 2) m.specular_brdf = Ggx{0.15, 0.5};
    fit(m);
    const f64::CompiledBrdf prepared(m);
    const f32::CompiledBrdf prepared32(m);
    const ShadingContext local{Vec3(1, 0, 0)};
    const Vec3 tint(0.5, 1, 0.25);
    for (const double angle : {0.1, 0.7, 1.5}) {
      const Incidence l = sunlight(from_angles(angle, 2.0));
      EXPECT_EQ(prepared.brdf(l, kViewer, kNormal, tint, local),
                f64::brdf(m, l, kViewer, kNormal, tint, local));
      EXPECT_EQ(prepared32.brdf(l, glm::vec3(kViewer), glm::vec3(kNormal), glm::vec3(tint), local),
                f32::brdf(m, l, glm::vec3(kViewer), glm::vec3(kNormal), glm::vec3(tint), local));
    }
  }
}

}  // namespace
}  // namespace panwright::materials::brdf_test
