// Surface materials: what an author writes, and what the renderer evaluates.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"

namespace panwright::materials {

// Pictures that a surface takes its fields from, by texture coordinates. Indices into the model's
// textures; −1: none.
struct Maps {
  std::int32_t albedo = -1;     // multiplies the diffuse colour
  std::int32_t normal = -1;     // linear; RGB·2 − 1 is the normal: +x along u, +y along v, +z outwards
  std::int32_t roughness = -1;  // linear, red: multiplies the slope m of cook and the σ of oren
  std::int32_t cutout = -1;     // alpha: the surface is there where it reaches the threshold
  double threshold = 0.5;       // 0..1
  Vec2 repeat{1};               // texture coordinates are multiplied by it
  bool any() const { return albedo >= 0 || normal >= 0 || roughness >= 0 || cutout >= 0; }
  bool operator==(const Maps&) const = default;
};

// The fields of a <material> as written; absent ones are inherited from the appearance around it.
struct Fields {
  std::optional<Vec3> diffuse;                 // linear RGB
  std::optional<Vec3> specular;                // linear RGB
  std::optional<double> shine;                 // Blinn-Phong exponent, 0..128
  std::optional<Vec3> emissive;                // linear RGB
  std::optional<Vec3> reflect;                 // weights of diffuse, specular, emissive
  std::optional<Vec3> refract;                 // real refractive index per channel
  std::optional<std::array<double, 4>> cook;   // factor of D, RMS slope m, factors of F and G
  std::optional<double> oren;                  // σ, radians
  std::optional<std::array<double, 4>> hapke;  // w, h, B0, mean roughness θ̄ in degrees
  std::optional<Maps> maps;                    // all of them together

  // Every field that `inner` gives replaces the one here.
  Fields overridden_by(const Fields& inner) const;
  bool operator==(const Fields&) const = default;
};

enum class DiffuseLaw : std::uint32_t { lambert, oren_nayar, hapke };
enum class SpecularLaw : std::uint32_t { none, blinn_phong, cook_torrance };

// A complete material (docs/conventions.md 6): f = weights.x·diffuse·f_d + weights.y·specular·f_s,
// radiance L = f·E·cosθ + weights.z·emissive·E/π.
struct Material {
  std::string name;
  DiffuseLaw diffuse_law = DiffuseLaw::lambert;
  SpecularLaw specular_law = SpecularLaw::none;
  Vec3 diffuse{0.8};
  Vec3 specular{0};
  Vec3 emissive{0};
  Vec3 weights{1, 0, 0};        // diffuse, specular, emissive
  std::optional<Vec3> refract;  // none: F = 1
  double shine = 0;             // Blinn-Phong exponent
  std::array<double, 4> cook{1, 0.5, 1, 1};
  double oren = 0;                          // σ, radians
  std::array<double, 4> hapke{0, 0, 0, 0};  // w, h, B0, θ̄ in radians
  Maps maps;
  bool operator==(const Material&) const = default;
};

// Fills in the defaults and settles which laws are used. A part that adds nothing gets the law that
// costs nothing: lambert or none. A specular colour without shine or cook is Blinn-Phong's lobe of
// exponent 0.
//
// Expects: numbers within the ranges of the schema; they are finite, >= 0, and cook's slope is > 0.
// Reports at `where`: N1401, W1402, W1403, W1404, N1405. Never fails.
Material resolved(const Fields& fields, SourceSpan where, DiagnosticLog& log);

}  // namespace panwright::materials
