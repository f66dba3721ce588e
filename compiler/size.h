// Sizes of models: in words, and warnings of unlikely ones.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/axis_box.h"
#include "base/diagnostic.h"
#include "base/math.h"
#include "scene/scene.h"

namespace panwright::compiler {

// Returns a length in its natural unit, to three digits: "1.1 km", "34 mm".
std::string length_in_words(double metres);

// Returns extents along x, y and z in one unit, and an object of that size: "2.1 x 1.4 x 6.8 m
// (about a bus)". Unit and object are those of the largest extent.
std::string size_in_words(const Vec3& extents);

// An instance's box in the world.
struct PartBox {
  std::int32_t node = 0;
  AxisBox box;
};

// Reports a model of more than 200 m or less than 5 cm (W2022), or instances whose sizes differ by
// more than 1e5 (W2023, instead of W2022): most often a wrong unit. Sizes are the largest extents
// along the axes of the world. A single sphere, ellipsoid or mesh may be a celestial body and is
// never reported.
void check_sizes(const scene::Scene& scene, std::span<const PartBox> parts, DiagnosticLog& log);

}  // namespace panwright::compiler
