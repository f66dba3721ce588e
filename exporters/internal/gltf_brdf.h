// glTF's own BRDF, and how far a material of ours is from it. Private to exporters.
#pragma once

#include <optional>
#include <span>

#include "materials/material.h"

namespace panwright::exporters {

// The factors of a glTF material, named as there; linear.
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

// Reflectance at normal incidence of a refractive index in air.
double reflectance_of_index(double index);

// The reflectance, 1/sr: appendix B of the specification of glTF 2.0, with the three extensions as
// their texts define them. The normal is +z.
//
//   to_light, to_viewer  unit, above the horizon
Vec3 gltf_brdf(const GltfSurface& surface, const Vec3& to_light, const Vec3& to_viewer);

// A part of a surface, and its share of the area.
struct SurfacePart {
  materials::Material material;  // fitted
  double share = 1;
  std::optional<Vec3> reflectance;  // mean of its reflectance map
};

// How much of the light that a surface reflects goes elsewhere, or is more or less, as glTF has it:
// ∫|f − g| cosθ dω over ∫f cosθ dω, both of all parts and channels, the larger of two viewers at 18
// and 60 degrees. Lobes narrower than slopes of 0.05 are compared as if they had those: mirrors
// are.
//
// returns  0: the same; a narrow lobe that goes elsewhere altogether counts twice. Within 0.01.
// Cost: a few ms for each part.
double changed_share(std::span<const SurfacePart> parts, const GltfSurface& surface);

}  // namespace panwright::exporters
