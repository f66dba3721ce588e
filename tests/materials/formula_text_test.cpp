// The GLSL texts as they are embedded: what each variant holds, and that everything is precise.
#include "materials/formula_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace panwright::materials::formula_text_test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::array kDiffuse{DiffuseModel::lambert, DiffuseModel::oren_nayar, DiffuseModel::hapke,
                              DiffuseModel::eon, DiffuseModel::lommel_seeliger};
constexpr std::array kSpecular{SpecularModel::none,          SpecularModel::blinn_phong,
                               SpecularModel::cook_torrance, SpecularModel::beckmann,
                               SpecularModel::ggx,           SpecularModel::mirror};

// The text of a BRDF model has the BRDFs that it calls, and none of the long ones that it does not.
TEST(FormulaText, HoldsItsBrdfs) {
  const std::pair<DiffuseModel, const char*> diffuse[] = {
      {DiffuseModel::oren_nayar, "Vec3 oren_nayar_brdf("},
      {DiffuseModel::hapke, "Vec3 hapke_brdf("},
      {DiffuseModel::eon, "Vec3 eon_brdf("},
      {DiffuseModel::lommel_seeliger, "Vec3 lommel_seeliger_brdf("}};
  for (const DiffuseModel d : kDiffuse)
    for (const SpecularModel s : kSpecular) {
      const std::string text = glsl_formulas({.diffuse = d, .specular = s});
      for (const auto& [brdf, function] : diffuse) {
        if (brdf == d)
          EXPECT_THAT(text, HasSubstr(function));
        else
          EXPECT_THAT(text, Not(HasSubstr(function)));
      }
      EXPECT_EQ(text.find("Real blinn_phong_lobe(") != std::string::npos,
                s == SpecularModel::blinn_phong);
      EXPECT_THAT(text, HasSubstr("Vec3 surface_radiance("));
    }
}

// Several BRDF models stand side by side under names of their own.
TEST(FormulaText, FamiliesAreChosenByNumber) {
  const BrdfModel brdf_models[] = {{.diffuse = DiffuseModel::hapke},
                                   {.specular = SpecularModel::ggx, .coated = true}};
  const std::string text = glsl_formulas(brdf_models);
  EXPECT_THAT(text, HasSubstr("if (brdf_model == 0u) return surface_brdf_0(s"));
  EXPECT_THAT(text, HasSubstr("return surface_brdf_1(s"));
  EXPECT_THAT(text, HasSubstr("Vec3 hapke_brdf("));
}

// What stands behind each `mark`, up to `end`.
std::vector<std::string> all_behind(const std::string& text, const std::string& mark,
                                    const char* end) {
  std::vector<std::string> found;
  for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at)) {
    at += mark.size();
    found.push_back(text.substr(at, text.find_first_of(end, at) - at));
  }
  return found;
}

// Every macro that the text defines is gone at its end.
TEST(FormulaText, LeavesNoMacros) {
  for (const DiffuseModel d : kDiffuse)
    for (const SpecularModel s : kSpecular) {
      const std::string text = glsl_formulas({.diffuse = d, .specular = s});
      const auto macros = all_behind(text, "#define ", " \n");
      EXPECT_EQ(macros.size(), 10u);
      for (const std::string& macro : macros) EXPECT_THAT(text, HasSubstr("#undef " + macro));
    }
}

// No value is computed outside a precise variable: locals are declared so, and what is returned is
// one of them or a constant.
TEST(FormulaText, EveryValueIsPrecise) {
  const std::string text = glsl_all_brdfs() + glsl_formulas(BrdfModel{});
  EXPECT_GT(all_behind(text, "  precise ", "\n").size(), 100u);
  for (const char* type : {"  Real ", "  Vec3 "})
    for (const std::string& rest : all_behind(text, type, "/\n"))
      EXPECT_THAT(rest, Not(HasSubstr(" = "))) << rest;
  const auto returned = all_behind(text, "return ", ";");
  EXPECT_GT(returned.size(), 40u);
  for (const std::string& value : returned)
    EXPECT_THAT(value, testing::AnyOf("exact_result", "Real(0)", "Real(1)", "Real(1e-30)",
                                      "Vec3(Real(0))", "Vec3(Real(1))"));
}

}  // namespace
}  // namespace panwright::materials::formula_text_test
