// Bounds of values of settings. Private to workspace.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <type_traits>

#include "workspace/settings.h"

namespace panwright::workspace {

// Returns a direction with the largest coordinate 1, as squares of the largest and the smallest
// numbers overflow or underflow; none: zero.
inline std::optional<Vec3> scaled_direction(const Vec3& v) {
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  if (!(largest > 0)) return std::nullopt;
  return v / largest;
}

template <class T>
bool in_bounds(const SettingInfo& info, const T& value) {
  if constexpr (std::is_same_v<T, Vec3>) {
    return in_bounds(info, value.x) && in_bounds(info, value.y) && in_bounds(info, value.z);
  } else if constexpr (std::is_same_v<T, Vec4>) {  // intrinsics
    return value.x > 0 && value.y > 0 && std::isfinite(value.z) && std::isfinite(value.w);
  } else if constexpr (std::is_same_v<T, ImageSize>) {
    constexpr std::uint32_t kMostSide = 16384;
    return std::min(value.width, value.height) > 0 &&
           std::max(value.width, value.height) <= kMostSide;
  } else if constexpr (requires { value.word; }) {
    return !value.number || in_bounds(info, *value.number);
  } else if constexpr (std::is_same_v<T, double> || std::is_same_v<T, std::uint32_t> ||
                       std::is_same_v<T, std::uint64_t>) {
    const auto number = static_cast<double>(value);
    return std::isfinite(number) &&
           ((info.flags & kAbove) != 0 ? number > info.least : number >= info.least) &&
           ((info.flags & kBelow) != 0 ? number < info.most : number <= info.most);
  } else {
    return true;
  }
}

// Returns the words after "expected …" for a value out of bounds; empty: it is in them.
template <class T>
std::string expected_instead(const SettingInfo& info, const T& value) {
  if constexpr (std::is_same_v<T, Vec3>)
    if ((info.flags & kDirection) != 0 && in_bounds(info, value))
      return scaled_direction(value) ? "" : "a direction, not all zeros";
  if constexpr (std::is_same_v<T, Quat>)
    return unit_quaternion(value) ? "" : "a unit quaternion w x y z";
  return in_bounds(info, value) ? std::string() : std::string(info.accepts);
}

}  // namespace panwright::workspace
