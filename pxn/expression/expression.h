// Values of expressions.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "pxn/expression/dimensions.h"
#include "pxn/expression/formula.h"
#include "pxn/expression/scope.h"

namespace panwright::pxn {

// The value of an expression, in SI, and what it measures as far as that can be told.
struct Measured {
  double value = 0;
  QuantityKind kind;
};

// Evaluates expressions, and keeps what it has read of them: an expression of the same place is
// read once, however often it is evaluated.
//
// Elementary functions are those of base/math.h: the same bits on every machine. Every operation
// that is evaluated must have a finite result; the branch of ?: that is not taken is not evaluated.
//
// What a value measures is told by the kinds of its operands (kinds.h), or where these leave it
// open by scaling all lengths, then all angles, and looking at how the value follows: with an n of
// 2, "width^n" grows fourfold and is an area.
class Expressions {
 public:
  Expressions();
  ~Expressions();
  Expressions(const Expressions&) = delete;
  Expressions& operator=(const Expressions&) = delete;

  // text: between the braces. place: the same number for the same text only.
  //
  // Problems: E1212, E1213, E1221 to E1223.
  std::optional<Measured> evaluate(std::string_view text, std::uint64_t place, const Scope* scope,
                                   ExpressionProblem& problem);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace panwright::pxn
