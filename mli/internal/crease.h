// The lengths of ridges.
#pragma once

#include <array>
#include <cstdint>

#include "mli/recipe.h"

namespace panwright::mli {

// The length of a ridge by four random words, metres.
double ridge_length(const Crease& crease, const std::array<std::uint32_t, 4>& words);

// How far beyond the edges of a sheet the middles of ridges lie, metres: the longest half.
double crease_margin(const Crease& crease);

// How many ridges lie over a point, on average, for each ridge per square metre: the mean area of
// their outlines, square metres. (What the limit of 20 lengths takes from the log-normal ones
// counts.)
double crease_overlap(const Crease& crease);

}  // namespace panwright::mli
