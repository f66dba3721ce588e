// Lengths of ridges.
#pragma once

#include <array>
#include <cstdint>

#include "mli/recipe.h"

namespace panwright::mli {

// Returns the length of a ridge by four random words, metres.
double ridge_length(const Crease& crease, const std::array<std::uint32_t, 4>& words);

// Returns the largest distance of the middles of ridges beyond the edges of a sheet, metres: half
// the longest.
double crease_margin(const Crease& crease);

// Returns the mean number of ridges over a point, per ridge per square metre: the mean area of
// their outlines, square metres. (Log-normal lengths are cut at 20 lengths.)
double crease_overlap(const Crease& crease);

}  // namespace panwright::mli
