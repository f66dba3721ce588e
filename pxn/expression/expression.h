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

// Value of an expression, and its dimension as far as known.
struct Measured {
  double value = 0;  // lengths and their powers in the root's unit, angles in radians, else in SI
  QuantityKind kind;
  // of a bare number, as in Quantity
  double length = 0;
  double angle = 0;
  int pi = 0;
  bool ratio = false;
};

// Evaluator of expressions, which caches their parsed form: an expression of one place is read
// once, however often it is evaluated.
//
// Elementary functions are those of base/math.h: the same bits on every machine. Every operation
// that is evaluated must have a finite result; the other branch of ?: is not evaluated.
//
// Lengths are in the root's unit throughout, so bare numbers among them are in it too; bare numbers
// used as angles are converted from the root's unit to radians (dimensions.h).
//
// The dimension of a value follows from the kinds of its operands (dimensions.h). If these leave it
// open, all lengths, then all angles are scaled: with an n of 2, "width^n" grows fourfold and is an
// area.
class Expressions {
 public:
  Expressions();
  ~Expressions();
  Expressions(const Expressions&) = delete;
  Expressions& operator=(const Expressions&) = delete;

  // Sets the units of bare numbers, and clears the cache. Default: metres and degrees.
  void set_units(const BareUnits& bare);
  const BareUnits& units() const;

  // text: between the braces. place: the same number for the same text and need only.
  //
  // A bare number used both as a length (unit not the metre) or an angle (unit not the radian) and
  // as something else is E1212; the parameter keeps its first uses.
  //
  // Problems: E1212, E1213, E1221 to E1223.
  std::optional<Measured> evaluate(std::string_view text, std::uint64_t place, const Scope* scope,
                                   ExpressionProblem& problem,
                                   const std::optional<Need>& need = std::nullopt);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace panwright::pxn
