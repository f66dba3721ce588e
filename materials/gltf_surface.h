// glTF's BRDF, and the difference of our materials from it.
#pragma once

#include <optional>
#include <span>

#include "materials/material.h"

namespace panwright::materials {

// Factors of a glTF material, with glTF's names; linear.
struct GltfSurface {
  Vec3 base{1};
  double metallic = 0;
  double roughness = 1;    // perceptual: the slope is its square
  double ior = 1.5;        // KHR_materials_ior
  double specular = 1;     // KHR_materials_specular
  Vec3 specular_color{1};  // the same; may be over 1
  double clearcoat = 0;    // KHR_materials_clearcoat
  double clearcoat_roughness = 0;
};

// Returns the reflectance at normal incidence of a refractive index in air.
double reflectance_of_index(double index);

// Returns the reflectance, 1/sr: appendix B of the specification of glTF 2.0 as in its authors'
// renderer (correlated masking and shadowing of GGX), with the three extensions. The normal is +z.
//
//   to_light, to_viewer  unit, above the horizon
Vec3 gltf_brdf(const GltfSurface& surface, const Vec3& to_light, const Vec3& to_viewer);

// Part of a surface, and its share of the area.
struct SurfacePart {
  Material material;  // fitted
  double share = 1;
  std::optional<Vec3> reflectance;  // mean of its reflectance map
};

// Returns the relative difference of reflected light from glTF's: ∫|f − g| cosθ dω over ∫f cosθ dω,
// both of all parts and channels, the larger of two viewers at 18 and 60 degrees. Lobes narrower
// than slopes of 0.05, mirrors included, are compared at 0.05.
//
// returns  0: the same; a narrow lobe in another direction counts twice. Within 0.01. Cost: a few
// ms for each part.
double changed_share(std::span<const SurfacePart> parts, const GltfSurface& surface);

// ---- coats. glTF's is a coloured fraction of its Fresnel reflectance over the base: base·(1 −
// c·F(n·v)) + c·F(n·v)·D. Ours refracts and interreflects. With converted colours, both agree in
// reflectance at normal incidence and in light from below at 37 degrees.

// Returns the transmittance of glTF's coat of strength c for light that leaves at 37 degrees.
double passed_by_gltf_coat(double strength);

// Diffuse albedo for glTF below its coat, by our diffuse colour x: gain·x/(1 − back·x). Without a
// coat, the albedo of the diffuse BRDF.
struct DiffuseCurve {
  Vec3 gain{0};
  Vec3 back{0};

  Vec3 operator()(const Vec3& x) const;
  Vec3 inverse(const Vec3& albedo) const;
};
// Cost: some ms with a coat or a BRDF other than Lambert's.
DiffuseCurve diffuse_curve(const Material& material);

// Converts the reflectance at normal incidence below our coat, seen from inside it, to that below
// glTF's coat; and back. Unchanged without a coat.
Vec3 reflectance_below_gltf_coat(const Material& material, const Vec3& reflectance);
Vec3 reflectance_below_our_coat(const Coat& coat, const Vec3& reflectance);

// Returns the strength of glTF's coat for ours, at most 1; 0 without one.
double gltf_coat_strength(const Material& material);
// Returns our coat's index for a strength, 0 to 1.
double coat_index_of_strength(double strength);

}  // namespace panwright::materials
