// Expressions over names of a scope, for tests.
#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "pxn/expression/expression.h"

namespace panwright::pxn {

struct ExpressionFixture {
  Expressions expressions;
  Scope scope;
  std::uint64_t place = 0;
  ExpressionProblem problem;

  std::optional<Measured> operator()(const std::string& text) {
    problem = {};
    return expressions.evaluate(text, place++, &scope, problem);
  }
  double value(const std::string& text) {
    const auto measured = (*this)(text);
    EXPECT_TRUE(measured) << text << ": " << problem.message;
    return measured ? measured->value : std::numeric_limits<double>::quiet_NaN();
  }
  // "E1221 4-5 message (hint)"
  std::string complaint(const std::string& text) {
    if (const auto measured = (*this)(text)) return "no problem";
    std::string out = std::string(code_info(problem.code).name) + " " +
                      std::to_string(problem.begin) + "-" + std::to_string(problem.end) + " " +
                      problem.message;
    if (!problem.hint.empty()) out += " (" + problem.hint + ")";
    return out;
  }
};

}  // namespace panwright::pxn
