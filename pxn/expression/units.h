// Units of numbers, and decimal numbers in them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "schemas/generated/pxn_schema.h"

namespace panwright::pxn {

// One unit is times·10^shift in SI, or, where `low` is not 0, factor + low.
struct Unit {
  std::string_view name;
  schemas::Dimension dimension;
  std::uint32_t times;
  int shift;
  double factor;  // the same, rounded
  double low;     // the rest of an irrational factor
};

// All that can be written behind a number. µm may be written um.
std::span<const Unit> all_units();

const Unit* find_unit(std::string_view name);
// The unit of a dimension with this factor; nullptr when there is none.
const Unit* find_unit(schemas::Dimension dimension, double factor);

// How many bytes at the start of a text are a decimal number: sign, digits, point, exponent.
std::size_t number_length(std::string_view text);

// A decimal number in a unit (nullptr: SI) as a number in SI. 12mm is the double nearest to 0.012
// whatever the digits are; angles are the double nearest to the number's double times the unit.
//
//   returns  nothing when the text is no decimal number (base/text.h), or is past 1.8e308 in SI
std::optional<double> read_number(std::string_view number, const Unit* unit);

// A number with a unit of length, in another one: 12mm in cm is 1.2. Rounded once where `in` is km,
// m, cm, mm, um or nm, and to an ulp where it is in or ft.
//
//   returns  nothing when the text is no decimal number, or past 1.8e308
std::optional<double> read_length(std::string_view number, const Unit& unit, const Unit& in);

// A number of a unit in SI. Of decimal units the quotient or product by a power of ten, so that 12
// of mm are exactly 12mm; of angles as read_number has it.
double to_si(double x, const Unit& unit);
// The same back: the number with the fewest digits that to_si makes `si` of, as far as 15 digits
// are enough, else the quotient.
double from_si(double si, const Unit& unit);
// A number of one unit of length in another.
double in_unit(double x, const Unit& from, const Unit& to);

// What a dimension is called, with its article: "a length", "a plain number".
std::string_view name_of(schemas::Dimension dimension);
// Units of a dimension, for messages: "km, m or cm".
std::string units_of(schemas::Dimension dimension);

}  // namespace panwright::pxn
