// Sizes of models, in words.
#pragma once

#include <string>

#include "base/math.h"

namespace panwright::compiler {

// Returns a length in its natural unit, to three digits: "1.1 km", "34 mm".
std::string length_in_words(double metres);

// Returns extents along x, y and z in one unit, and an object of that size: "2.1 x 1.4 x 6.8 m
// (about a bus)". Unit and object are those of the largest extent.
std::string size_in_words(const Vec3& extents);

}  // namespace panwright::compiler
