// The GLSL texts as they are embedded: what each variant holds, and that everything is precise.
#include "materials/formula_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace panwright::materials {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::array kDiffuse{DiffuseLaw::lambert, DiffuseLaw::oren_nayar, DiffuseLaw::hapke};
constexpr std::array kSpecular{SpecularLaw::none, SpecularLaw::blinn_phong,
                               SpecularLaw::cook_torrance};

TEST(FormulaText, HoldsOnlyItsPairOfLaws) {
  const char* diffuse_functions[] = {"Vec3 lambert(", "Vec3 oren_nayar(", "Real hapke("};
  const char* specular_functions[] = {"Vec3 no_specular_law(", "Real blinn_phong(",
                                      "Vec3 cook_torrance("};
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t s = 0; s < 3; ++s) {
      const std::string text = glsl_formulas(kDiffuse[d], kSpecular[s]);
      for (std::size_t k = 0; k < 3; ++k) {
        if (k == d)
          EXPECT_THAT(text, HasSubstr(diffuse_functions[k]));
        else
          EXPECT_THAT(text, Not(HasSubstr(diffuse_functions[k])));
        if (k == s)
          EXPECT_THAT(text, HasSubstr(specular_functions[k]));
        else
          EXPECT_THAT(text, Not(HasSubstr(specular_functions[k])));
      }
      EXPECT_THAT(text, HasSubstr("Vec3 surface_radiance("));
    }
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
  for (const DiffuseLaw d : kDiffuse)
    for (const SpecularLaw s : kSpecular) {
      const std::string text = glsl_formulas(d, s);
      const auto macros = all_behind(text, "#define ", " \n");
      EXPECT_EQ(macros.size(), 5u);
      for (const std::string& macro : macros) EXPECT_THAT(text, HasSubstr("#undef " + macro));
    }
}

// No value is computed outside a precise variable: locals are declared so, and what is returned is
// one of them or a constant.
TEST(FormulaText, EveryValueIsPrecise) {
  const std::string text = glsl_all_laws() + glsl_formulas({}, {});
  EXPECT_GT(all_behind(text, "  precise ", "\n").size(), 100u);
  for (const char* type : {"  Real ", "  Vec3 "})
    for (const std::string& rest : all_behind(text, type, "/\n"))
      EXPECT_THAT(rest, Not(HasSubstr(" = "))) << rest;
  const auto returned = all_behind(text, "return ", ";");
  EXPECT_GT(returned.size(), 40u);
  for (const std::string& value : returned)
    EXPECT_THAT(value, testing::AnyOf("exact_result", "Real(0)", "Real(1)", "Vec3(Real(0))"));
}

}  // namespace
}  // namespace panwright::materials
