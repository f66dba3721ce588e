// Units of numbers, and decimal numbers in them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "schemas/generated/pxn_schema.h"

namespace panwright::pxn {

// Unit: times·10^shift in SI, or, if `low` is not 0, factor + low.
struct Unit {
  std::string_view name;
  schemas::Dimension dimension;
  std::uint32_t times;
  int shift;
  double factor;  // the same, rounded
  double low;     // the rest of an irrational factor
};

// Returns all units of the language. µm may be written um.
std::span<const Unit> all_units();

const Unit* find_unit(std::string_view name);
// Returns the unit of a dimension with this factor; nullptr if none.
const Unit* find_unit(schemas::Dimension dimension, double factor);

// Returns the length in bytes of the decimal number at the start of a text: sign, digits, point,
// exponent.
std::size_t number_length(std::string_view text);

// Converts a decimal number in a unit (nullptr: SI) to SI. 12mm is the double nearest to 0.012
// whatever the digits are; angles are the double nearest to the number's double times the unit.
//
//   returns  nothing when the text is no decimal number (base/text.h), or is past 1.8e308 in SI
std::optional<double> read_number(std::string_view number, const Unit* unit);

// Converts a decimal number between units of length: 12mm in cm is 1.2. Rounded once if `in` is km,
// m, cm, mm, um or nm, and to an ulp if it is in or ft.
//
//   returns  nothing when the text is no decimal number, or past 1.8e308
std::optional<double> read_length(std::string_view number, const Unit& unit, const Unit& in);

// Converts a number of a unit to SI. Decimal units by a power of ten, so that 12 of mm are exactly
// 12mm; angles as in read_number.
double to_si(double x, const Unit& unit);
// Converts back: the number with the fewest digits that to_si maps to `si`, if 15 digits suffice,
// else the quotient.
double from_si(double si, const Unit& unit);
// Converts a number between units of length.
double in_unit(double x, const Unit& from, const Unit& to);

// Returns a dimension's name with its article: "a length", "a plain number".
std::string_view name_of(schemas::Dimension dimension);
// Returns the units of a dimension, for messages: "km, m or cm".
std::string units_of(schemas::Dimension dimension);

}  // namespace panwright::pxn
