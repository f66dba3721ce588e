// The GLSL texts as they are embedded: what each variant holds, and that everything is precise.
#include "materials/formula_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <regex>

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

// Every macro that the text defines is gone at its end.
TEST(FormulaText, LeavesNoMacros) {
  const std::regex definition("#define (\\w+)");
  for (const DiffuseLaw d : kDiffuse)
    for (const SpecularLaw s : kSpecular) {
      const std::string text = glsl_formulas(d, s);
      int found = 0;
      for (auto i = std::sregex_iterator(text.begin(), text.end(), definition);
           i != std::sregex_iterator(); ++i, ++found)
        EXPECT_THAT(text, HasSubstr("#undef " + (*i)[1].str()));
      EXPECT_EQ(found, 5);
    }
}

// No value is computed outside a precise variable: locals are declared so, and what is returned is
// one of them or a constant.
TEST(FormulaText, EveryValueIsPrecise) {
  const std::string text = glsl_all_laws() + glsl_formulas({}, {});
  const std::regex declaration("\n\\s+(Real|Vec3) \\w+ =");
  EXPECT_FALSE(std::regex_search(text, declaration));
  const std::regex returned("return ([^;]*);");
  const std::regex harmless("exact_result|(Vec3\\()?Real\\([0-9.]+\\)\\)?");
  int returns = 0;
  for (auto i = std::sregex_iterator(text.begin(), text.end(), returned);
       i != std::sregex_iterator(); ++i, ++returns)
    EXPECT_TRUE(std::regex_match((*i)[1].str(), harmless)) << (*i)[0].str();
  EXPECT_GT(returns, 40);
}

}  // namespace
}  // namespace panwright::materials
