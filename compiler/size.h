// How large models are, in words.
#pragma once

#include <string>

#include "base/math.h"

namespace panwright::compiler {

// A length in the unit that a person would say it in, to three digits: "1.1 km", "34 mm".
std::string length_in_words(double metres);

// Extents along x, y and z in one unit, and something of that size: "2.1 x 1.4 x 6.8 m (about a
// bus)". The unit and the thing are those of the largest one.
std::string size_in_words(const Vec3& extents);

}  // namespace panwright::compiler
