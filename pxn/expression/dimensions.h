// Dimensions of expressions' values, as far as their text determines them.
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

// Units of bare numbers of the root; neither is nullptr.
struct BareUnits {
  const Unit* length = find_unit("m");
  const Unit* angle = find_unit("deg");
};

// Kind of an operand before its evaluation. As in Quantity, but units are given only if they differ
// from the expression's.
struct OperandKind {
  schemas::Dimension dimension = schemas::Dimension::none;
  double other_length = 0;
  double other_angle = 0;
  int pi = 0;
  bool ratio = false;
  bool operator==(const OperandKind&) const = default;
};

// Required kind of a value.
struct Need {
  schemas::Dimension dimension = schemas::Dimension::none;
  bool radians = false;  // a bare angle is in radians, whatever the root's unit
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
  double other_length = 0;  // of the files of its bare numbers, if not this one's
  double other_angle = 0;
  std::vector<Program::Scaling> scalings;  // bare numbers used as angles
  std::vector<NameUse> uses;               // bare numbers by their names alone
};

// Derives the kind of a formula's value from those of its operands, in their order. Operands of
// addition, comparison, min, max, mod, hypot and atan2 must be of one kind, as must the whole and
// the required kind; sin, cos and tan take angles, their inverses give them.
//
// A bare number is compatible with every kind, in the root's unit: "span + 0.1" is a length, and so
// is 0.1. As an angle it is converted to radians (scalings), unless it contains pi: a factor of pi
// counts as an angle, so that 30*pi/180 is one and asin(x)*180/pi is none. Products with powers of
// angles or pixels may be unknown, which is compatible with every kind.
//
//   text     of the expression, for messages
//   need     required kind of the whole, if known
//   returns  nothing if kinds clash, or a bare number is ambiguous:
//   trigonometry
//            of one while the root's angles are degrees, one of a file with other units, a ratio of
//            lengths as an angle. `problem` has the place
//
// Problems: E1212. Expects a formula without a problem. Cost: O(bytes), with no recursion.
std::optional<Analysis> analyse(const Formula& formula, std::string_view text,
                                std::span<const OperandKind> operands, const BareUnits& bare,
                                const std::optional<Need>& need, ExpressionProblem& problem);

}  // namespace panwright::pxn
