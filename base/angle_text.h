// Bare angles that look like radians where degrees are expected.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace panwright {

// Returns the degrees of a decimal number that is a multiple of 5 degrees in radians, to its
// last digit: "1.5708" gives "90". Quarter turns count from 2 decimals on, multiples of 15 degrees
// from 3, others from 4, up to a full turn. Nothing for other numbers.
std::optional<std::string> degrees_of_radians(std::string_view number);

// Returns the message of W1214: "1.5708 degrees are 90 degrees as radians", and its hint.
struct RadiansWarning {
  std::string message;
  std::string hint;
};
std::optional<RadiansWarning> warning_of_radians(std::string_view number);

}  // namespace panwright
