// Reflectance formulas as GLSL, for shaders.
#pragma once

#include <span>
#include <string>

#include "materials/material.h"

namespace panwright::materials {

// Returns the formulas of one BRDF model, as GLSL 4.00 or later, for insertion after #version and
// before the calling code. Defines no macros, and these names:
//
//   struct Surface   the parameters (generated from schemas/material.toml); fill in every
//                    member that the BRDFs use
//   struct Incidence   one light: to_light, irradiance, alpha2, limb (materials/incidence.h)
//   vec3 surface_brdf(Surface s, Incidence light, vec3 to_viewer, vec3 normal)       1/sr
//   vec3 surface_radiance(Surface s, Incidence light, vec3 to_viewer, vec3 normal)   reflected,
//                                                                               irradiance/sr
//   vec3 surface_emission(Surface s, vec3 white)                                     white/sr
//   vec3 bare_diffuse(Surface s, vec3 to_light, vec3 to_viewer, vec3 normal)         1/sr
//   vec3 bare_reflection(Surface s, float cosine)                                    of mirrors
//   and coated_diffuse, coated_reflection, coat_first of coats (materials/formulas)
//
// Directions are unit vectors that point away from the surface. A texture's or vertex's colour is
// multiplied into s.diffuse. Every operation is `precise`: the bits are those of f32 in
// materials/brdf.h if sums, products, divisions and square roots are rounded by IEEE 754.
[[nodiscard]] std::string glsl_formulas(const BrdfModel& brdf_model);

// The same for one or more BRDF models; surface_brdf and surface_radiance take a further first
// argument, `uint brdf_model`, their index.
[[nodiscard]] std::string glsl_formulas(std::span<const BrdfModel> brdf_models);

// Returns every BRDF and helper, without surface_brdf and surface_radiance: for programs that call
// single formulas.
[[nodiscard]] std::string glsl_all_brdfs();

// Returns functions that read a material of a pan in a shader, for insertion after glsl_formulas().
// The shader defines
//
//   vec4 material_row(int i)   the i-th vec4 of the section of materials
//
// and has
//
//   const int kMaterialRows                        vec4 of a record
//   float, vec2 ... material_SLOT(int row)         one slot of the record that begins at a row
//   Surface surface_of(int row)                    its parameters; tangent 0
[[nodiscard]] std::string glsl_material_loader();

}  // namespace panwright::materials
