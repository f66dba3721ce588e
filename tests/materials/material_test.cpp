#include "materials/material.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace panwright::materials::material_test {
namespace {

using testing::HasSubstr;

struct Outcome {
  Material material;
  std::vector<Code> codes;
  std::string messages;
};

Outcome settle(const Fields& fields) {
  DiagnosticLog log;
  Outcome outcome;
  outcome.material = resolved(fields, {}, log);
  for (const Diagnostic& entry : log.entries()) {
    outcome.codes.push_back(entry.code);
    outcome.messages += entry.message + "\n";
  }
  return outcome;
}

using Codes = std::vector<Code>;

TEST(Material, NothingGiven) {
  const Outcome o = settle({});
  EXPECT_EQ(o.material, Material{});
  EXPECT_EQ(o.material.diffuse, Vec3(0.8));
  EXPECT_EQ(o.material.weights, Vec3(1, 0, 0));
  EXPECT_EQ(o.codes, Codes{});
}

TEST(Material, Figure8HasNoRemarks) {
  Fields f;
  f.diffuse = Vec3(0.7038, 0.27048, 0.0828);
  f.specular = Vec3(1);
  f.refract = Vec3(1.5);
  f.cook_torrance = CookTorrance{1, 0.15, 1, 1};
  f.reflect = Vec3(0.9, 0.1, 0);
  const Outcome o = settle(f);
  EXPECT_EQ(o.codes, Codes{}) << o.messages;
  EXPECT_EQ(o.material.diffuse_model(), DiffuseModel::lambert);
  EXPECT_EQ(o.material.specular_model(), SpecularModel::cook_torrance);
  EXPECT_EQ(std::get<CookTorrance>(o.material.specular_brdf).alpha, 0.15);
  EXPECT_EQ(o.material.weights, Vec3(0.9, 0.1, 0));
}

TEST(Material, OnlySpecular) {
  Fields f;
  f.specular = Vec3(0.6);
  f.blinn_phong = BlinnPhong{30};
  const Outcome o = settle(f);
  EXPECT_EQ(o.codes, Codes{}) << o.messages;
  EXPECT_EQ(o.material.weights, Vec3(0, 1, 0));
  EXPECT_EQ(o.material.specular_model(), SpecularModel::blinn_phong);
  EXPECT_EQ(std::get<BlinnPhong>(o.material.specular_brdf).shine, 30);
}

TEST(Material, SpecularWithoutShineIsTheBroadestLobe) {
  Fields f;
  f.specular = Vec3(0.5);
  f.reflect = Vec3(0.5, 0.5, 0);
  const Outcome o = settle(f);
  EXPECT_EQ(o.codes, Codes{});
  EXPECT_EQ(o.material.specular_model(), SpecularModel::blinn_phong);
  EXPECT_EQ(std::get<BlinnPhong>(o.material.specular_brdf).shine, 0);
}

TEST(Material, CookWinsOverShine) {
  Fields f;
  f.specular = Vec3(1);
  f.blinn_phong = BlinnPhong{30};
  f.cook_torrance = CookTorrance{1, 0.2, 1, 1};
  f.reflect = Vec3(0.8, 0.2, 0);
  const Outcome o = settle(f);
  EXPECT_EQ(o.codes, Codes{Code("N1401")});
  EXPECT_THAT(o.messages, HasSubstr("shine 30 is not used, because cook is given"));
  EXPECT_EQ(o.material.specular_model(), SpecularModel::cook_torrance);
}

TEST(Material, HapkeWinsOverOren) {
  Fields f;
  f.diffuse = Vec3(1);
  f.oren_nayar = OrenNayar{0.3};
  f.hapke = Hapke{.w = 0.21, .h = 0.07, .b0 = 1, .roughness = 20 * kDegree};
  const Outcome o = settle(f);
  EXPECT_EQ(o.codes, (Codes{Code("W1404"), Code("N1401")}));
  EXPECT_EQ(o.material.diffuse_model(), DiffuseModel::hapke);
  EXPECT_NEAR(std::get<Hapke>(o.material.diffuse_brdf).roughness, 20 * kDegree, 1e-16);
  EXPECT_THAT(o.messages, HasSubstr("mean roughness 20 degrees"));
  f.hapke.reset();
  EXPECT_EQ(settle(f).codes, Codes{});
  EXPECT_EQ(settle(f).material.diffuse_model(), DiffuseModel::oren_nayar);
  EXPECT_EQ(std::get<OrenNayar>(settle(f).material.diffuse_brdf).sigma, 0.3);
}

TEST(Material, EnergyOfWeights) {
  Fields f;
  f.specular = Vec3(1);
  f.blinn_phong = BlinnPhong{5};
  f.reflect = Vec3(0.9, 0.2, 0);
  EXPECT_EQ(settle(f).codes, Codes{Code("W1402")});
  EXPECT_THAT(settle(f).messages, HasSubstr("0.9 0.2 0 of reflect add up to 1.1"));
  f.reflect = Vec3(0.7, 0.2, 0.1);  // adds up to 1 but for rounding
  f.emissive = Vec3(1);
  EXPECT_EQ(settle(f).codes, Codes{});
}

TEST(Material, EnergyOfColors) {
  Fields f;
  f.diffuse = Vec3(0.2, 1.5, 0.2);
  EXPECT_EQ(settle(f).codes, Codes{Code("W1402")});
  EXPECT_THAT(settle(f).messages, HasSubstr("1.5 in green"));
  EXPECT_THAT(settle(f).messages, testing::Not(HasSubstr("8-bit")));
  // IEC 61966-2-1 by a pocket calculator: ((128/255 + 0.055)/1.055)^2.4 = 0.2159
  f.diffuse = Vec3(255, 128, 0);
  EXPECT_THAT(settle(f).messages, HasSubstr("the 8-bit codes 255 128 0 of diffuse are 1 0.216 0"));
  f.diffuse = Vec3(0.2, 1.5, 0.2);
  f.reflect = Vec3(0.5, 0, 0);
  EXPECT_EQ(settle(f).codes, Codes{});
}

TEST(Material, CookFactors) {
  Fields f;
  f.specular = Vec3(1);
  f.reflect = Vec3(0.9, 0.1, 0);
  f.cook_torrance = CookTorrance{2, 0.15, 1, 1};
  EXPECT_EQ(settle(f).codes, Codes{Code("W1403")});
  EXPECT_EQ(std::get<CookTorrance>(settle(f).material.specular_brdf).d_scale, 2);
}

TEST(Material, FieldsWithoutTheirPartner) {
  const auto one_note = [](const Fields& f, const char* words) {
    const Outcome o = settle(f);
    EXPECT_EQ(o.codes, Codes{Code("N1405")}) << words << ": " << o.messages;
    EXPECT_THAT(o.messages, HasSubstr(words));
  };
  Fields f;
  f.reflect = Vec3(0.9, 0.1, 0);
  one_note(f, "the specular weight 0.1 of reflect");
  f.cook_torrance = CookTorrance{1, 0.15, 1, 1};
  one_note(f, "cook has no effect, because the specular colour is 0");
  f.cook_torrance.reset();
  f.blinn_phong = BlinnPhong{20};
  one_note(f, "shine has no effect");
  f = {};
  f.reflect = Vec3(0.9, 0, 0.1);
  one_note(f, "the emissive weight 0.1");
  f = {};
  f.refract = Vec3(1.5);
  one_note(f, "refract has no effect");
  f = {};
  f.diffuse = Vec3(0.5);
  f.specular = Vec3(0.5);
  one_note(f, "specular has no effect, because diffuse is given as well");
  f.specular.reset();
  f.specular_model = SpecularModel::ggx;
  one_note(f, "ggx has no effect, because diffuse is given as well");
  f = {};
  f.emissive = Vec3(1);
  one_note(f, "emissive has no effect");
  f = {};
  f.specular = Vec3(0.5);
  f.oren_nayar = OrenNayar{0.2};
  one_note(f, "oren has no effect");
}

// What an explicit weight of 0 switches off is meant, and silent.
TEST(Material, ExplicitWeightsAreMeant) {
  Fields f;
  f.diffuse = Vec3(0.5);
  f.specular = Vec3(0.5);
  f.blinn_phong = BlinnPhong{9};
  f.emissive = Vec3(1);
  f.oren_nayar = OrenNayar{0.4};
  f.reflect = Vec3(0, 1, 0);
  EXPECT_EQ(settle(f).codes, Codes{});
  EXPECT_EQ(settle(f).material.diffuse_model(), DiffuseModel::lambert);
  f.reflect = Vec3(1, 0, 0);
  EXPECT_EQ(settle(f).codes, Codes{});
  EXPECT_EQ(settle(f).material.specular_model(), SpecularModel::none);
}

TEST(Material, OverridesFieldByField) {
  Fields outer, inner;
  outer.diffuse = Vec3(0.1);
  outer.specular = Vec3(0.2);
  outer.blinn_phong = BlinnPhong{3};
  outer.emissive = Vec3(0.4);
  outer.reflect = Vec3(0.5);
  outer.refract = Vec3(1.6);
  outer.cook_torrance = CookTorrance{1, 2, 3, 4};
  outer.oren_nayar = OrenNayar{0.7};
  outer.hapke = Hapke{5, 6, 7, 8};
  EXPECT_EQ(outer.overridden_by({}), outer);
  EXPECT_EQ(Fields{}.overridden_by(outer), outer);
  inner.specular = Vec3(0.9);
  inner.oren_nayar = OrenNayar{0.1};
  Fields want = outer;
  want.specular = Vec3(0.9);
  want.oren_nayar = OrenNayar{0.1};
  EXPECT_EQ(outer.overridden_by(inner), want);
}

TEST(Material, RemarksPointAtTheirPlace) {
  DiagnosticLog log;
  const FileId file = log.sources().add({"m.pxn", nullptr, Encoding::utf8, {}});
  Fields f;
  f.reflect = Vec3(1, 1, 1);
  (void)resolved(f, {file, 3, 9}, log);
  ASSERT_FALSE(log.entries().empty());
  for (const Diagnostic& entry : log.entries()) {
    EXPECT_EQ(entry.where.file, file);
    EXPECT_EQ(entry.where.begin, 3u);
    EXPECT_EQ(entry.where.end, 9u);
  }
}

}  // namespace
}  // namespace panwright::materials::material_test
