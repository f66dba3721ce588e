// Parameters of a material as GLSL.
#pragma once

#include <fmt/core.h>

#include <bit>
#include <cstdint>
#include <string>

#include "materials/internal/formulas.h"

namespace panwright::hard_cases {

// Returns statements that make a Surface `s` of the same bits.
inline std::string surface_text(const materials::f32::SurfaceFields& s) {
  std::string text = "  Surface s;\n";
  const auto bits = [](float value) {
    return fmt::format("uintBitsToFloat({}u)", std::bit_cast<std::uint32_t>(value));
  };
  const auto real = [&](const char* name, float value) {
    text += fmt::format("  s.{} = {};\n", name, bits(value));
  };
  const auto vector = [&](const char* name, const glm::vec3& v) {
    text += fmt::format("  s.{} = vec3({}, {}, {});\n", name, bits(v.x), bits(v.y), bits(v.z));
  };
#define VECTOR(name) vector(#name, s.name);
#define REAL(name) real(#name, s.name);
#include "materials/internal/generated/surface_fields.def"
#undef VECTOR
#undef REAL
  return text;
}

}  // namespace panwright::hard_cases
