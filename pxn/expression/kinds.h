// Kinds of expressions' values, and their combination by operators.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "schemas/generated/pxn_schema.h"

namespace panwright::pxn {

struct QuantityKind {
  enum class Measure : std::uint8_t { unknown, plain, length, angle, ratio, pixels, other };
  Measure measure = Measure::unknown;
  int power = 0;  // of other: the length's unit to this power, never 0 or 1
  bool operator==(const QuantityKind&) const = default;
};

inline constexpr QuantityKind kPlain{QuantityKind::Measure::plain, 0};
inline constexpr int kMostPower = 100;  // beyond it, a kind is unknown

QuantityKind quantity_kind_of(schemas::Dimension dimension);
// Returns "a length", "an area".
std::string name_of(const QuantityKind& kind);

// Returns the power of lengths in a kind; angles, ratios and pixels have none.
int power_of(const QuantityKind& kind);
// Returns true if it is known, and no plain number.
bool is_measured(const QuantityKind& kind);

QuantityKind product(const QuantityKind& a, const QuantityKind& b);
QuantityKind quotient(const QuantityKind& a, const QuantityKind& b);
QuantityKind root(const QuantityKind& a);
// exponent: if it is a number of the text.
QuantityKind to_the_power(const QuantityKind& a, std::optional<double> exponent);

}  // namespace panwright::pxn
