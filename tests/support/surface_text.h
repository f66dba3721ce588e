// The parameters of a material as GLSL.
#pragma once

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <string>

#include "materials/internal/formulas.h"

namespace panwright::hard_cases {

// Statements that make a Surface `s` of the same bits.
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
  VECTOR(diffuse)
  VECTOR(specular)
  VECTOR(emissive) VECTOR(weights) VECTOR(indices) VECTOR(extinction) REAL(shine) REAL(lobe_scale)
      REAL(alpha) REAL(alpha_y) VECTOR(tangent) REAL(sun_alpha2) VECTOR(facing) VECTOR(reflectance)
          VECTOR(many_scale) REAL(loss0) REAL(loss1) REAL(loss2) REAL(loss3) REAL(loss4) REAL(loss5)
              REAL(loss6) REAL(loss7) REAL(oren) REAL(hapke_w) REAL(hapke_h) REAL(hapke_b0)
                  REAL(hapke_rough) REAL(hapke_b) REAL(hapke_c) REAL(hapke_hc) REAL(hapke_bc0)
                      REAL(hapke_k) REAL(hapke_h0) REAL(hapke_h1) REAL(hapke_h2) REAL(hapke_h3)
                          REAL(hapke_h4) REAL(hapke_h5) REAL(hapke_h6) REAL(hapke_h7)
                              REAL(coat_index) REAL(coat_alpha) REAL(coat_share) VECTOR(coat_depth)
                                  VECTOR(coat_return) REAL(tilt_x) REAL(tilt_y)
#undef VECTOR
#undef REAL
                                      return text;
}

}  // namespace panwright::hard_cases
