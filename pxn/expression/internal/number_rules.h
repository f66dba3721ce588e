// Numbers of the tables and their tokens, as reading and reporting both need them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "pxn/expression/units.h"
#include "schemas/generated/pxn_schema.h"

namespace panwright::pxn {

inline const schemas::Number& number_at(const schemas::Value& value, std::size_t index) {
  static constexpr schemas::Number kAny = {"value", -1.7976931348623157e308, 1.7976931348623157e308,
                                           false, false};
  if (value.numbers.empty()) return kAny;
  return value.numbers[std::min(index, value.numbers.size() - 1)];
}

inline bool is_si(const Unit* unit) { return unit == nullptr || unit->factor == 1; }

inline bool is_expression(std::string_view token) {
  return token.find('{') != std::string_view::npos;
}

}  // namespace panwright::pxn
