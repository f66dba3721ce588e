// glTF's own BRDF, and how far a material of ours is from it.
#pragma once

#include <optional>
#include <span>

#include "materials/material.h"

namespace panwright::materials {

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

// The reflectance, 1/sr: appendix B of the specification of glTF 2.0 as its authors' renderer has
// it (masking and shadowing of GGX correlated), with the three extensions as their texts define
// them. The normal is +z.
//
//   to_light, to_viewer  unit, above the horizon
Vec3 gltf_brdf(const GltfSurface& surface, const Vec3& to_light, const Vec3& to_viewer);

// A part of a surface, and its share of the area.
struct SurfacePart {
  Material material;  // fitted
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

// ---- coats. glTF's is a coloured fraction of its Fresnel reflectance over whatever is below:
// base·(1 − c·F(n·v)) + c·F(n·v)·D. Ours refracts, and sends light back and forth. The two have the
// same reflectance at normal incidence, and the same light from below it at 37 degrees, if colours
// are converted.

// What glTF's coat of strength c lets through of light that leaves at 37 degrees.
double passed_by_gltf_coat(double strength);

// The albedo of diffuse light as glTF must have it below its coat, by the diffuse colour x of ours:
// gain·x/(1 − back·x). Without a coat, the albedo of the diffuse BRDF.
struct DiffuseCurve {
  Vec3 gain{0};
  Vec3 back{0};

  Vec3 operator()(const Vec3& x) const;
  Vec3 inverse(const Vec3& albedo) const;
};
// Cost: some ms where there is a coat or a BRDF other than Lambert's.
DiffuseCurve diffuse_curve(const Material& material);

// The reflectance at normal incidence that glTF must have below its coat for one below ours, seen
// from inside of it; and the other way round. Without a coat the same.
Vec3 reflectance_below_gltf_coat(const Material& material, const Vec3& reflectance);
Vec3 reflectance_below_our_coat(const Coat& coat, const Vec3& reflectance);

// The strength of glTF's coat for ours, at most 1; 0 without one.
double gltf_coat_strength(const Material& material);
// Our coat's index for a strength, 0 to 1.
double coat_index_of_strength(double strength);

}  // namespace panwright::materials
