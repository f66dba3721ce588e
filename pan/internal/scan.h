// Tests of whole runs of numbers, several at once. Compiled with -O3.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace panwright::pan::internal {

// The largest difference of a stored normal's squared length from 1. Rounding a unit vector to
// float leaves 1.2e-7, normalising in float 5e-7.
inline constexpr float kUnitTolerance = 1e-5f;

// Returns true if n values each are below the limit.
bool all_below(const std::uint16_t* values, std::size_t n, std::uint32_t limit);
bool all_below(const std::uint32_t* values, std::size_t n, std::uint32_t limit);

// Returns true if n values are at least `low` and at most `high`; NaN is neither.
bool all_between(const float* values, std::size_t n, float low, float high);

// Returns true if n vectors of three lie in a box with finite corners; NaN lies in none.
bool all_within(const float* vectors, std::size_t n, const float low[3], const float high[3]);

// Returns true if n vectors of three have a squared length within kUnitTolerance of 1.
bool all_unit(const float* vectors, std::size_t n);

// Returns true if a text is UTF-8 (RFC 3629) without U+0000.
bool is_text(std::string_view bytes);

}  // namespace panwright::pan::internal
