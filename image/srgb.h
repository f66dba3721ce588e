// The sRGB transfer function (IEC 61966-2-1) and its 8-bit codes.
#pragma once

#include <cstdint>

namespace panwright::image {

// The linear value of an encoded one, both 0 to 1. Same bits on any processor (base/math.h).
double linear_from_srgb(double encoded);

// The linear value of an 8-bit code: linear_from_srgb(code / 255).
double srgb_decoded(std::uint8_t code);

// Returns the 8-bit code nearest to a linear value in encoded space, ties upwards; values outside
// [0, 1] are clamped, NaN gives 0. Exact: the thresholds are computed in double.
std::uint8_t srgb_code(double linear);

}  // namespace panwright::image
