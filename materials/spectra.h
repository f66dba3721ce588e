// Optical constants of metals and other solids.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "base/math.h"

namespace panwright::materials {

// n + ik for the bands about 650, 550 and 450 nm.
struct Conductor {
  Vec3 n{1};
  Vec3 k{0};
};

// Optical constants by chemical symbol or name, as "Al"; nothing for one that is not known.
std::optional<Conductor> metal(std::string_view name);

// What metal() knows, in alphabetical order.
std::span<const std::string_view> metal_names();

}  // namespace panwright::materials
