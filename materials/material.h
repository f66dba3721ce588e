// Surface materials: what an author writes, and what the renderer evaluates.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"

namespace panwright::materials {

// Pictures that a surface takes its fields from, by texture coordinates. Indices into the model's
// textures; −1: none.
struct Maps {
  std::int32_t albedo = -1;  // multiplies the diffuse colour
  std::int32_t normal = -1;  // linear; RGB·2 − 1 is the normal: +x along u, +y along v, +z outwards
  std::int32_t roughness = -1;  // linear, red: multiplies the slope m of cook and the σ of oren
  // sRGB: reflectance R of the mirror facets at normal incidence, in place of F0 of their indices.
  // F becomes R + (F − F0)(1 − R)/(1 − F0): exact for Schlick's curve; R F/F0 where F dips below F0
  std::int32_t reflectance = -1;
  std::int32_t cutout = -1;  // alpha: the surface is there where it reaches the threshold
  double threshold = 0.5;    // 0..1
  Vec2 repeat{1};            // texture coordinates are multiplied by it
  bool any() const {
    return albedo >= 0 || normal >= 0 || roughness >= 0 || reflectance >= 0 || cutout >= 0;
  }
  bool operator==(const Maps&) const = default;
};

enum class DiffuseLaw : std::uint32_t { lambert, oren_nayar, hapke, eon, lommel_seeliger };
enum class SpecularLaw : std::uint32_t { none, blinn_phong, cook_torrance, beckmann, ggx, mirror };
enum class FresnelLaw : std::uint32_t { none, dielectric, conductor };

// Whether light that the facets of beckmann and ggx scatter more than once is added.
enum class Compensation : std::uint32_t { automatic, on, off };

// What Hapke's law knows of the grains beyond the numbers of level 0.
struct HapkeGrains {
  double b = 0;         // asymmetry of the two Henyey-Greenstein lobes, 0 to 1
  double c = 0;         // which is the stronger: 1 all backward, −1 all forward
  double h_c = 0;       // width of the coherent backscatter
  double b_c0 = 0;      // its strength
  double porosity = 0;  // filling factor φ, 0 to 0.7; 0: K = 1
  bool operator==(const HapkeGrains&) const = default;
};

// A clear layer over the surface: cover glass, silica over silver, Kapton over aluminium. Light
// that passes it is refracted, weakened and sent back and forth (incoherently).
struct Coat {
  double index = 1.5;  // n, 1 to 4
  double alpha = 0;    // RMS slope of its outer surface
  Vec3 depth{0};       // optical thickness across it, absorption times thickness
  bool operator==(const Coat&) const = default;
};

// Solar cells over the shape's texture coordinates: between the cells gaps, over each cell fingers.
// The material is that of a cell. Fingers are Lambert's, under its coat; gaps are Lambert's,
// without coat and emission; the weights of the cell are not theirs.
struct Cells {
  Vec2 count{1};            // cells along u and v of one unit of texture coordinates, > 0
  Vec2 gap{0};              // between them, parts of a cell's pitch, 0 to 0.9
  double fingers = 0;       // grid lines over a cell, across u; 0: none
  double finger_width = 0;  // part of their pitch, 0 to 0.9
  Vec3 gap_color{0.5};      // diffuse, linear RGB
  Vec3 finger_color{0.6};   // diffuse, linear RGB
  Vec2 tilt{0};  // angle of the cells to their cover glass, as seen, about v and u, radians
  bool operator==(const Cells&) const = default;
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

  // level 1; of several laws of one part the one given last holds
  std::optional<DiffuseLaw> diffuse_law;
  std::optional<SpecularLaw> specular_law;
  std::optional<Vec3> extinction;              // k per channel; refract is then n
  std::optional<std::array<double, 2>> alpha;  // of beckmann and ggx, along u and v
  std::optional<HapkeGrains> hapke_grains;
  std::optional<double> lommel;  // w of Lommel and Seeliger
  std::optional<Compensation> compensation;
  std::optional<Coat> coat;
  std::optional<Cells> cells;
  std::optional<std::string> preset;  // name of the library's material it comes from

  // Every field that `inner` gives replaces the one here.
  Fields overridden_by(const Fields& inner) const;
  bool operator==(const Fields&) const = default;
};

// Which formulas a material needs: a family of materials that one shader serves.
struct Laws {
  DiffuseLaw diffuse = DiffuseLaw::lambert;
  SpecularLaw specular = SpecularLaw::none;
  FresnelLaw fresnel = FresnelLaw::none;
  bool compensated = false;  // light scattered by facets more than once
  bool coated = false;
  bool mapped = false;  // facets whose reflectance comes from a map
  auto operator<=>(const Laws&) const = default;
};

// Numbers that follow from a material's fields, computed once in double; what a shader needs in
// the place of integrals. All 0 where the laws do not use them.
struct Fits {
  std::array<double, 8> loss{};     // 1 − E(cos): seven coefficients and a bend; see facets.glsl
  Vec3 many_scale{0};               // factor of loss(l)·loss(v), 1/sr
  std::array<double, 8> hapke_h{};  // of H(x); see hapke.glsl
  // share of diffuse light from below that the coat sends back, times the albedo below over diffuse
  Vec3 coat_return{0};
  Vec3 reflectance{0};  // of the facets at normal incidence, F0, under the coat if there is one
  double error = 0;     // largest error of loss at any azimuth, or relative one of H
  bool operator==(const Fits&) const = default;
};

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
  std::optional<Vec3> refract;  // n per channel; none: F = 1
  Vec3 extinction{0};           // k per channel; all 0: a dielectric
  double shine = 0;             // Blinn-Phong exponent
  // factor of D, RMS slope m (α along u of beckmann and ggx), factors of F and G
  std::array<double, 4> cook{1, 0.5, 1, 1};
  double alpha_y = 0.5;  // of beckmann and ggx, along v
  double oren = 0;       // oren_nayar: σ, radians; eon: roughness 0 to 1
  // w, h, B0, θ̄ in radians; lommel_seeliger: w alone
  std::array<double, 4> hapke{0, 0, 0, 0};
  HapkeGrains grains;
  Compensation compensation = Compensation::automatic;
  std::optional<Coat> coat;
  std::optional<Cells> cells;
  Maps maps;
  Fits fits;  // by fit()
  bool operator==(const Material&) const = default;
};

// The family of a material.
Laws laws_of(const Material& material);

// The roughness of eon whose terms have the same ratio as those of Oren and Nayar's law for slopes
// of standard deviation σ, radians: 0 to 0.9.
double eon_roughness(double sigma);

// A shader for each material: 0 to kMostVariants − 1. Materials of one family share one; when there
// are more families than variants, the rarest share the last.
inline constexpr std::uint32_t kMostVariants = 8;
std::vector<std::uint32_t> variants_of(std::span<const Material> materials);

// K of a filling factor φ: −ln(1 − 1.209 φ^⅔)/(1.209 φ^⅔); 1 at 0. Expects: 0 ≤ φ ≤ 0.7.
// B. Hapke, "Bidirectional reflectance spectroscopy: 6. Effects of porosity", 2008.
double porosity_factor(double filling);

// Computes material.fits from the fields. What resolved() and a pan give has been fitted.
// Cost: a millisecond for facets that are compensated, some more where they are not the same all
// around, and less for Hapke's law. Facets that have been seen before cost nothing.
void fit(Material& material);

// Fills in the defaults, settles which laws are used and fits. A part that adds nothing gets the
// law that costs nothing: lambert or none. A specular colour without shine or cook is Blinn-Phong's
// lobe of exponent 0.
//
// Expects: numbers within the ranges of the schema; they are finite, >= 0, and cook's slope is > 0.
// Reports at `where`: N1401, W1402, W1403, W1404, N1405. Never fails.
Material resolved(const Fields& fields, SourceSpan where, DiagnosticLog& log);

}  // namespace panwright::materials
