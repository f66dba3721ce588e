// What the value of an expression measures, as far as its text tells.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "pxn/expression/formula.h"

namespace panwright::pxn {

// Plain numbers go with everything: "span + 0.1" is a length, as {0.1} is where one is needed.
struct QuantityKind {
  enum class Measure : std::uint8_t { unknown, plain, length, angle, ratio, pixels, other };
  Measure measure = Measure::unknown;
  int power = 0;  // of other: metres to this power, never 0 or 1
  bool operator==(const QuantityKind&) const = default;
};

QuantityKind quantity_kind_of(schemas::Dimension dimension);
// "a length", "an area".
std::string name_of(const QuantityKind& kind);

// The kind of a formula's value from those of its operands, in their order. What is added, compared
// or given to min, max, mod, hypot and atan2 must be of one kind; sin, cos and tan take angles.
// Products with powers of angles or pixels may be unknown, and then say nothing against anything.
//
//   returns  nothing where kinds clash: `problem` has the place of what clashes
//
// Problems: E1212. Expects a formula without a problem. Cost: O(bytes), with no recursion.
std::optional<QuantityKind> quantity_kind_of(const Formula& formula,
                                             std::span<const schemas::Dimension> dimensions,
                                             ExpressionProblem& problem);

}  // namespace panwright::pxn
