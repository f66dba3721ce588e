// Reflectance of materials, evaluated on the CPU.
//
// One text for each formula (materials/formulas/*.glsl) is read by GLSL and twice by C++: f32 does
// what a shader does, f64 is the reference that the error of f32 is measured with. Both give the
// same bits on every processor and with every compiler: they use sums, products, divisions and
// square roots only.
#pragma once

#include "base/math.h"
#include "materials/material.h"

namespace panwright::materials {

namespace f64 {

using Vec3 = glm::dvec3;

// The reflectance f of a material (docs/conventions.md, reflection), 1/sr, RGB. Finite and at least
// 0 for unit vectors and a material whose numbers are at least 0.
//
//   to_light, to_viewer, normal  unit vectors, pointing away from the surface
//   tint                         colour of a texture or vertex; multiplies diffuse
//   returns                      0 where the light is below the horizon. A viewer below it is taken
//                                to it: near the limb of a smoothly shaded mesh the interpolated
//                                normal may face away from who sees the facet.
//
// Reciprocal while both directions are 1e-6 or more above the horizon.
Vec3 brdf(const Material& material, const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal,
          const Vec3& tint = Vec3(1));

// The radiance towards the viewer under a distant light, emission included: irradiance/sr. The
// irradiance is that on a plane that faces the light.
Vec3 radiance(const Material& material, const Vec3& to_light, const Vec3& to_viewer,
              const Vec3& normal, const Vec3& irradiance, const Vec3& tint = Vec3(1));

}  // namespace f64

// The same in float, material and all: what a shader computes.
namespace f32 {

using Vec3 = glm::vec3;

Vec3 brdf(const Material& material, const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal,
          const Vec3& tint = Vec3(1));
Vec3 radiance(const Material& material, const Vec3& to_light, const Vec3& to_viewer,
              const Vec3& normal, const Vec3& irradiance, const Vec3& tint = Vec3(1));

}  // namespace f32

}  // namespace panwright::materials
