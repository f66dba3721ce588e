// Reflectance of materials, evaluated on the CPU.
//
// Each formula (materials/formulas/*.glsl) is compiled as GLSL and twice as C++: f32 computes what
// a shader computes, f64 is the reference for the error of f32. Both give the same bits on every
// processor and with every compiler: they use sums, products, divisions and square roots only.
#pragma once

#include <memory>
#include <optional>

#include "base/math.h"
#include "materials/incidence.h"
#include "materials/material.h"

namespace panwright::materials {

// Shading context: inputs of a BRDF besides material, normal, light and viewer.
struct ShadingContext {
  panwright::Vec3 tangent{
      0};  // unit, perpendicular to the normal; 0 where microfacets are isotropic
  // texel of a material's reflectance map; none: F0 of the indices
  std::optional<panwright::Vec3> reflectance = std::nullopt;
};

namespace f64 {

using Vec3 = glm::dvec3;

// Returns the reflectance f of a material (docs/conventions.md, reflection), 1/sr, RGB. Finite and
// at least 0 for unit vectors and a material whose numbers are at least 0.
//
//   light                        its irradiance is of no account; a direction stands for a point
//   to_viewer, normal            unit vectors, pointing away from the surface
//   tint                         colour of a texture or vertex; multiplies diffuse
//   material                     fitted, see fit()
//   returns                      0 for light below the horizon. A viewer below it is moved to it:
//                                near the limb of a smoothly shaded mesh the interpolated normal
//                                may face away from the viewer.
//
// Reciprocal while both directions are 1e-6 or more above the horizon.
Vec3 brdf(const Material& material, const materials::Incidence& light, const Vec3& to_viewer,
          const Vec3& normal, const Vec3& tint = Vec3(1), const ShadingContext& local = {});

// Returns the reflected radiance towards the viewer: irradiance/sr.
Vec3 radiance(const Material& material, const materials::Incidence& light, const Vec3& to_viewer,
              const Vec3& normal, const Vec3& tint = Vec3(1), const ShadingContext& local = {});

// Returns the emitted radiance, whatever the light: white/sr. white: the irradiance that a white
// Lambert surface would need for the radiance of emission 1.
Vec3 emission(const Material& material, const Vec3& white);

// Compiled BRDF: the parameters are converted once, for many directions. brdf() spends most of its
// time on that. Thread-safe.
class CompiledBrdf {
 public:
  explicit CompiledBrdf(const Material& material);
  ~CompiledBrdf();
  CompiledBrdf(CompiledBrdf&&) noexcept;
  CompiledBrdf& operator=(CompiledBrdf&&) noexcept;

  // As brdf(), the same bits.
  Vec3 brdf(const materials::Incidence& light, const Vec3& to_viewer, const Vec3& normal,
            const Vec3& tint = Vec3(1), const ShadingContext& local = {}) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace f64

// The same in float, material included, as computed by a shader.
namespace f32 {

using Vec3 = glm::vec3;

Vec3 brdf(const Material& material, const materials::Incidence& light, const Vec3& to_viewer,
          const Vec3& normal, const Vec3& tint = Vec3(1), const ShadingContext& local = {});
Vec3 radiance(const Material& material, const materials::Incidence& light, const Vec3& to_viewer,
              const Vec3& normal, const Vec3& tint = Vec3(1), const ShadingContext& local = {});
Vec3 emission(const Material& material, const Vec3& white);

// See f64.
class CompiledBrdf {
 public:
  explicit CompiledBrdf(const Material& material);
  ~CompiledBrdf();
  CompiledBrdf(CompiledBrdf&&) noexcept;
  CompiledBrdf& operator=(CompiledBrdf&&) noexcept;

  // As brdf(), the same bits.
  Vec3 brdf(const materials::Incidence& light, const Vec3& to_viewer, const Vec3& normal,
            const Vec3& tint = Vec3(1), const ShadingContext& local = {}) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace f32

}  // namespace panwright::materials
