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

// The value of an expression, and what it measures as far as that can be told.
struct Measured {
  double value = 0;  // lengths and their powers in the root's unit, angles in radians, else in SI
  QuantityKind kind;
  // of a bare number, as in Quantity
  double length = 0;
  double angle = 0;
  int pi = 0;
  bool ratio = false;
};

// Evaluates expressions, and keeps what it has read of them: an expression of the same place is
// read once, however often it is evaluated.
//
// Elementary functions are those of base/math.h: the same bits on every machine. Every operation
// that is evaluated must have a finite result; the branch of ?: that is not taken is not evaluated.
//
// Lengths are in the root's unit throughout, so that bare numbers among them are in it too; bare
// numbers that stand for angles are taken from the root's unit to radians (dimensions.h).
//
// What a value measures is told by the kinds of its operands (dimensions.h), or where these leave
// it open by scaling all lengths, then all angles, and looking at how the value follows: with an n
// of 2, "width^n" grows fourfold and is an area.
class Expressions {
 public:
  Expressions();
  ~Expressions();
  Expressions(const Expressions&) = delete;
  Expressions& operator=(const Expressions&) = delete;

  // What bare numbers are; forgets what was read. Metres and degrees before.
  void set_units(const BareUnits& bare);
  const BareUnits& units() const;

  // text: between the braces. place: the same number for the same text and need only.
  //
  // A parameter whose bare number stood for a length, where a length's unit is not the metre, for
  // an angle, where it is not the radian, and for something else (E1212) keeps its first uses.
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
