// What the value of an expression measures, as far as its text tells.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pxn/expression/formula.h"
#include "pxn/expression/kinds.h"
#include "pxn/expression/program.h"
#include "pxn/expression/scope.h"
#include "pxn/expression/units.h"

namespace panwright::pxn {

// What bare numbers of the root are; neither is nullptr.
struct BareUnits {
  const Unit* length = find_unit("m");
  const Unit* angle = find_unit("deg");
};

// What is known of an operand before its value is. As in Quantity, but that the units are given
// only where they are not those of the expression.
struct OperandKind {
  schemas::Dimension dimension = schemas::Dimension::none;
  double other_length = 0;
  double other_angle = 0;
  int pi = 0;
  bool ratio = false;
  bool operator==(const OperandKind&) const = default;
};

// What a value has to be.
struct Need {
  schemas::Dimension dimension = schemas::Dimension::none;
  bool radians = false;  // a bare angle is in radians, whatever the root says
  bool operator==(const Need&) const = default;
};

// Kinds and units of a formula's values.
struct Analysis {
  struct NameUse {
    std::uint32_t operand = 0;
    Quantity::Use use = Quantity::as_plain;
  };
  QuantityKind kind;
  int pi = 0;  // of a bare number, as in Quantity
  bool ratio = false;
  double other_length = 0;  // of the files that bare numbers in it are from, where not this one's
  double other_angle = 0;
  std::vector<Program::Scaling> scalings;  // bare numbers that stand for angles
  std::vector<NameUse> uses;               // bare numbers by their names alone
};

// The kind of a formula's value from those of its operands, in their order. What is added, compared
// or given to min, max, mod, hypot and atan2 must be of one kind, and so must the whole and what is
// needed; sin, cos and tan take angles, their inverses give them.
//
// A bare number goes with everything, and is in the root's unit there: "span + 0.1" is a length,
// and so is 0.1. As an angle it has to be taken to radians (scalings), except where pi is in it: a
// factor of pi counts as an angle by itself, so that 30*pi/180 is one and asin(x)*180/pi is none.
// Products with powers of angles or pixels may be unknown, and then say nothing against anything.
//
//   text     of the expression, for messages
//   need     what the whole has to be, where that is known
//   returns  nothing where kinds clash, or a bare number may mean one thing or another:
//   trigonometry
//            of one while the root's angles are degrees, one of a file with other units, a ratio of
//            lengths as an angle. `problem` has the place
//
// Problems: E1212. Expects a formula without a problem. Cost: O(bytes), with no recursion.
std::optional<Analysis> analyse(const Formula& formula, std::string_view text,
                                std::span<const OperandKind> operands, const BareUnits& bare,
                                const std::optional<Need>& need, ExpressionProblem& problem);

}  // namespace panwright::pxn
