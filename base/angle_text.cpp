#include "base/angle_text.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "base/text.h"

namespace panwright {

std::optional<std::string> degrees_of_radians(std::string_view number) {
  const std::size_t point = number.find('.');
  constexpr int kMostDecimals = 17;
  if (point == number.npos || number.size() - point > kMostDecimals + 1) return std::nullopt;
  const auto value = parse_double(number);
  if (!value || number.find_first_of("eE") != number.npos) return std::nullopt;
  const int decimals = static_cast<int>(number.size() - point - 1);
  constexpr int kStep = 5, kTurn = 360;  // degrees
  const double steps = std::round(std::fabs(*value) / (kStep * kDegree));
  if (!(steps >= 1 && steps <= double{kTurn} / kStep)) return std::nullopt;
  const int degrees = kStep * static_cast<int>(steps);
  const int fewest = degrees % 90 == 0 ? 2 : degrees % 15 == 0 ? 3 : 4;
  // the last digit may be rounded or cut off
  const double unit = std::max(std::pow(10.0, -decimals), 1e-15);
  const double below = degrees * kDegree - std::fabs(*value);
  if (decimals < fewest || below > unit || below < -0.5 * unit) return std::nullopt;
  return fmt::format("{}{}", *value < 0 ? "-" : "", degrees);
}

std::optional<RadiansWarning> warning_of_radians(std::string_view number) {
  const auto degrees = degrees_of_radians(number);
  if (!degrees) return std::nullopt;
  return RadiansWarning{
      fmt::format("{} is read as degrees, and would be {} degrees as radians", number, *degrees),
      fmt::format("write {}rad or {}deg; {}deg keeps it", number, *degrees, number)};
}

}  // namespace panwright
