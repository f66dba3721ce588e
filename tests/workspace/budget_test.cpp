// Budgets as text.
#include "workspace/budget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace panwright::workspace::budget_test {
namespace {

using testing::HasSubstr;

TEST(BudgetText, TermsInAnyOrder) {
  DiagnosticLog log;
  const auto budget = budget_of_text(
      "flux=0.1%, nearest=5km  ifov=0.1mrad,centroid=0.01px approach=wide/dock corridor=20deg",
      log);
  ASSERT_TRUE(budget) << to_text(log);
  EXPECT_EQ(budget->nearest, 5000);
  EXPECT_EQ(budget->ifov, 1e-4);
  EXPECT_EQ(budget->flux, 1e-3);
  EXPECT_EQ(budget->centroid, 0.01);
  EXPECT_EQ(budget->pixels, 0.25) << "as in <budget>";
  EXPECT_EQ(budget->approach, "wide/dock");
  EXPECT_DOUBLE_EQ(budget->corridor, 20 * kDegree);
  EXPECT_FALSE(budget->tolerance);
  EXPECT_EQ(budget_of_text("tolerance=2mm", log)->tolerance, 2e-3);
  EXPECT_EQ(budget_of_text("nearest=1 ifov=1 pixels=3", log)->ifov, kDegree) << "degrees";
  EXPECT_FALSE(budget_of_text("none", log)->any());
  EXPECT_FALSE(log.has_errors());
}

TEST(BudgetText, WrongOnesAreNamed) {
  const std::pair<const char*, const char*> wrong[] = {
      {"", "no requirement is given"},
      {"pixels=1", "no requirement is given"},
      {"nearest=5", "require each other"},
      {"flux=1% ifov=1mrad", "require each other"},
      {"flux=1% pixels=1", "need nearest"},
      {"flux=1% centroid=1", "need nearest"},
      {"nearest=5 ifov=1mrad corridor=5deg", "needs an approach"},
      {"flux=1% flux=2%", "twice"},
      {"flux", "is not a term"},
      {"fluks=1%", "is not a term"},
      {"flux=", "flux is ''"},
      {"flux=0", "flux is '0'"},
      {"flux=-1%", "flux is '-1%'"},
      {"flux=200%", "flux is '200%'"},
      {"flux=nan", "flux is 'nan'"},
      {"nearest=0 ifov=1mrad", "nearest is '0'"},
      {"nearest=5furlong ifov=1mrad", "nearest is '5furlong'"},
      {"nearest=5 ifov=2rad", "ifov is '2rad'"},
      {"nearest=5 ifov=1mrad approach=", "approach is empty"},
      {"nearest=5 ifov=1mrad approach=a corridor=200deg", "corridor is '200deg'"},
      {"nearest=inf ifov=1mrad", "nearest is 'inf'"},
      {"tolerance=1e99", "tolerance is '1e99'"},
  };
  for (const auto& [text, problem] : wrong) {
    DiagnosticLog log;
    EXPECT_FALSE(budget_of_text(text, log)) << text;
    ASSERT_EQ(log.entries().size(), 1u) << text;
    EXPECT_EQ(log.entries()[0].code, Code("E0201"));
    EXPECT_THAT(log.entries()[0].message, HasSubstr(problem)) << text;
  }
  DiagnosticLog log;
  EXPECT_FALSE(budget_of_text("nearst=5", log));
  EXPECT_THAT(log.entries()[0].hint, HasSubstr("'nearest='"));
}

}  // namespace
}  // namespace panwright::workspace::budget_test
