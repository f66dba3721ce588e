// Programs of formulas against arithmetic done here, step by step.

#include "pxn/expression/program.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace panwright::pxn::program_test {
namespace {

Formula read(const std::string& text) {
  Formula formula = read_formula(text);
  EXPECT_FALSE(formula.problem) << text;
  return formula;
}

std::optional<double> value(const std::string& text) {
  const Formula formula = read(text);
  std::vector<double> operands;
  for (const Formula::Operand& operand : formula.operands) operands.push_back(operand.value);
  return Program(formula).run(operands);
}

TEST(Program, ChoicesInEveryPlace) {
  const std::pair<const char*, double> cases[] = {{"1 ? 2 : 3", 2},
                                                  {"0 ? 2 : 3", 3},
                                                  {"0 ? 1 : 0 ? 2 : 0 ? 3 : 4", 4},
                                                  {"1 ? 0 ? 2 : 1 ? 3 : 4 : 5", 3},
                                                  {"10 + (1 ? 2 : 3)*(0 ? 4 : 5)", 20},
                                                  {"max(1 ? 2 : 3, 0 ? 4 : 5, 1)", 5},
                                                  {"hypot(0 ? 4 : 3, 1 ? 4 : 3)", 5},
                                                  {"1 < 2 ? 3 + 4 : 5*6", 7},
                                                  {"(0 || 0 ? 1 : 0) ? 7 : -(1 ? 8 : 9)^2", -64},
                                                  {"-2^-1^2*4 + !(3 < 2)", -1}};
  for (const auto& [text, expected] : cases) EXPECT_EQ(value(text), expected) << text;
}

TEST(Program, SaysWhichOperationBroke) {
  const Formula formula = read("a*2 + 1/(b - c) + sqrt(a)");
  Program program(formula);
  // operands in their order: a 2 1 b c a
  EXPECT_EQ(program.run(std::vector<double>{9, 2, 1, 4, 2, 9}), 21.5);
  EXPECT_FALSE(program.run(std::vector<double>{9, 2, 1, 4, 4, 9}));
  EXPECT_EQ(formula.operations[program.broken().operation].name, "/");
  EXPECT_EQ(program.broken().values[0], 1);
  EXPECT_EQ(program.broken().values[1], 0);
  EXPECT_FALSE(program.run(std::vector<double>{-9, 2, 1, 4, 2, -9}));
  EXPECT_EQ(formula.operations[program.broken().operation].name, "sqrt");
  EXPECT_EQ(program.broken().values[0], -9);
  EXPECT_TRUE(program.run(std::vector<double>{9, 2, 1, 4, 2, 9}));
}

// The branch that is not taken is not evaluated; both sides of && are.
TEST(Program, WhatIsEvaluated) {
  EXPECT_EQ(value("1 ? 2 : 1/0"), 2);
  EXPECT_EQ(value("0 ? log(0) : 3"), 3);
  EXPECT_EQ(value("0 && 1/0"), std::nullopt);
  const Formula formula = read("a");
  Program program(formula);
  EXPECT_FALSE(program.run(std::vector<double>{std::numeric_limits<double>::infinity()}));
  EXPECT_EQ(program.broken().operation, Program::kNone);
}

// As deep and as long as texts may be: no recursion, and memory of the size of the text.
TEST(Program, LongAndDeep) {
  const std::size_t depth = (kLongestExpression - 1) / 2;
  EXPECT_EQ(value(std::string(depth, '(') + "7" + std::string(depth, ')')), 7);
  std::string sum = "1";
  while (sum.size() + 2 <= kLongestExpression) sum += "+1";
  EXPECT_EQ(value(sum), static_cast<double>((sum.size() + 1) / 2));
  std::string choice = "9";
  while (choice.size() + 4 <= kLongestExpression) choice = "0?1:" + choice;
  EXPECT_EQ(value(choice), 9);
  std::string power = "1";
  while (power.size() + 2 <= kLongestExpression) power += "^1";
  EXPECT_EQ(value(power), 1);
}

}  // namespace
}  // namespace panwright::pxn::program_test
