// Albedos of materials by quadrature, in double, the same bits everywhere.
#pragma once

#include <optional>

#include "base/math.h"
#include "materials/material.h"

namespace panwright::materials {

// Microfacets about +z, x along +x, without the Fresnel term.
struct Microfacets {
  SpecularModel brdf = SpecularModel::beckmann;  // cook_torrance (slope_x alone), beckmann or ggx
  double slope_x = 0.5;                          // 1e-6 to 1000
  double slope_y = 0.5;
};

// Returns ∫ f cosθ dω over all lights for one viewer: 1 less the multiple scattering.
//
//   to_viewer  unit, above the horizon
//   nodes      of Gauss and Legendre's quadrature over each of radius and quarters of the azimuth:
//              16, 32, 64 or 128. Smith's forms converge exponentially (1e-4 with 16, for cosines
//              from 0.02 on), V-cavities with 1/nodes².
[[nodiscard]] double microfacet_albedo(const Microfacets& microfacets, const Vec3& to_viewer,
                                       int nodes = 64);

// Returns 2∫E μ dμ, the mean over the azimuth for anisotropic microfacets.
[[nodiscard]] double microfacet_mean_albedo(const Microfacets& microfacets, int nodes = 32);

// Returns ∫ D G1(v) max(0, v·h) dω / (n·v), which is 1 when D and G1 are consistent, whatever the
// energy loss. E. Heitz, "Understanding the masking-shadowing function in microfacet-based BRDFs",
// 2014.
[[nodiscard]] double weak_furnace(const Microfacets& microfacets, const Vec3& to_viewer,
                                  int nodes = 64);

// Returns the directional albedo of a fitted material, which is also its radiance under a uniform
// sky: mirrors and coats included, tint 1, a Sun without a disc.
//
//   mu       cosine of the direction, > 0 to 1
//   azimuth  from the tangent, radians
//   reflectance  texel of the reflectance map, if the material has one; none: F0
//   nodes    as of microfacet_albedo(); its cost is their square
//   returns  RGB, within 2e-5 if no peak is narrower than 0.01
[[nodiscard]] Vec3 directional_albedo(const Material& material, double mu, double azimuth = 0,
                                      const std::optional<Vec3>& reflectance = {}, int nodes = 128);

// Returns 2∫E μ dμ, RGB.
[[nodiscard]] Vec3 hemispherical_albedo(const Material& material);

// Largest directional albedo found, of any channel, and its direction. Under a reflectance map that
// of R = 1: the BRDFs rise with it.
struct Gain {
  double albedo = 0;
  double mu = 1;
};
[[nodiscard]] Gain energy_gain(const Material& material);

// The same, none if at most 1 + tolerance. A material below 0.8 at a few nodes is not examined
// further. Cost: 0.1 ms, or that of energy_gain() beyond 0.8.
[[nodiscard]] std::optional<Gain> gain_above(const Material& material, double tolerance);

// Returns the largest |f(l, v) − f(v, l)|/f over pairs at 1e-4 to 1 above the horizon.
[[nodiscard]] double reciprocity_residual(const Material& material);

}  // namespace panwright::materials
