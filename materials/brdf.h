// Reflectance of materials, evaluated on the CPU.
//
// Each formula (materials/formulas/*.glsl) is compiled as GLSL and twice as C++: f32 computes what
// a shader computes, f64 is the reference for the error of f32. Both give the same bits on every
// processor and with every compiler: they use sums, products, divisions and square roots only.
#pragma once

#include <memory>
#include <optional>

#include "base/math.h"
#include "materials/material.h"

namespace panwright::materials {

// An eighth of the square of the Sun's angular radius, 4.6504e-3 rad, at 1 AU: the contribution of
// a uniform disc to the squares of alpha for light and viewer at the normal. Half vectors spread by
// ρ²/16 along each axis there, and alpha² is twice that; elsewhere see
// materials/formulas/sun_disc.glsl.
inline constexpr double kSunAlpha2 = 2.7033e-6;

// Shading context: inputs of a BRDF besides material, normal and directions.
struct ShadingContext {
  panwright::Vec3 tangent{
      0};                 // unit, perpendicular to the normal; 0 where microfacets are isotropic
  double sun_alpha2 = 0;  // kSunAlpha2 over the square of the distance in AU; 0: a point Sun
  // texel of a material's reflectance map; none: F0 of the indices
  std::optional<panwright::Vec3> reflectance = std::nullopt;
  double sun_limb = 0;  // limb darkening u of the Sun's disc, I = 1 − u·(1 − μ), 0 to 1
};

namespace f64 {

using Vec3 = glm::dvec3;

// Returns the reflectance f of a material (docs/conventions.md, reflection), 1/sr, RGB. Finite and
// at least 0 for unit vectors and a material whose numbers are at least 0.
//
//   to_light, to_viewer, normal  unit vectors, pointing away from the surface
//   tint                         colour of a texture or vertex; multiplies diffuse
//   material                     fitted, see fit()
//   returns                      0 for light below the horizon. A viewer below it is moved to it:
//                                near the limb of a smoothly shaded mesh the interpolated normal
//                                may face away from the viewer.
//
// Reciprocal while both directions are 1e-6 or more above the horizon.
Vec3 brdf(const Material& material, const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal,
          const Vec3& tint = Vec3(1), const ShadingContext& local = {});

// Returns the radiance towards the viewer under a distant light, emission included: irradiance/sr.
// The irradiance is that on a plane that faces the light.
Vec3 radiance(const Material& material, const Vec3& to_light, const Vec3& to_viewer,
              const Vec3& normal, const Vec3& irradiance, const Vec3& tint = Vec3(1),
              const ShadingContext& local = {});

// Compiled BRDF: the parameters are converted once, for many directions. brdf() spends most of its
// time on that. Thread-safe.
class CompiledBrdf {
 public:
  explicit CompiledBrdf(const Material& material);
  ~CompiledBrdf();
  CompiledBrdf(CompiledBrdf&&) noexcept;
  CompiledBrdf& operator=(CompiledBrdf&&) noexcept;

  // As brdf(), the same bits.
  Vec3 brdf(const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal,
            const Vec3& tint = Vec3(1), const ShadingContext& local = {}) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace f64

// The same in float, material included, as computed by a shader.
namespace f32 {

using Vec3 = glm::vec3;

Vec3 brdf(const Material& material, const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal,
          const Vec3& tint = Vec3(1), const ShadingContext& local = {});
Vec3 radiance(const Material& material, const Vec3& to_light, const Vec3& to_viewer,
              const Vec3& normal, const Vec3& irradiance, const Vec3& tint = Vec3(1),
              const ShadingContext& local = {});

// See f64.
class CompiledBrdf {
 public:
  explicit CompiledBrdf(const Material& material);
  ~CompiledBrdf();
  CompiledBrdf(CompiledBrdf&&) noexcept;
  CompiledBrdf& operator=(CompiledBrdf&&) noexcept;

  // As brdf(), the same bits.
  Vec3 brdf(const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal,
            const Vec3& tint = Vec3(1), const ShadingContext& local = {}) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace f32

}  // namespace panwright::materials
