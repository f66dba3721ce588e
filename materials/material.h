// Surface materials: authored fields, and evaluated materials.
//
// The structs are generated from schemas/material.toml: `Fields` are the authored ones, `Material`
// is one diffuse and one specular BRDF out of a closed set, with Fresnel's indices, coat, cells and
// maps. To add a parameter or a BRDF see docs/adding-a-brdf.md.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"
#include "materials/generated/material_record.h"

namespace panwright::materials {

enum class FresnelModel : std::uint32_t { none, dielectric, conductor };

// Formulas of a material: materials of equal BRDFs share one shader.
struct BrdfModel {
  DiffuseModel diffuse = DiffuseModel::lambert;
  SpecularModel specular = SpecularModel::none;
  FresnelModel fresnel = FresnelModel::none;
  bool compensated = false;  // multiple scattering between microfacets
  bool coated = false;
  bool mapped = false;  // microfacets with a reflectance map
  auto operator<=>(const BrdfModel&) const = default;
};

BrdfModel brdf_model_of(const Material& material);

// Returns RMS slopes of the microfacets of cook_torrance, beckmann and ggx along u and v; none for
// others.
std::optional<Vec2> slopes_of(const Material& material);

// Returns the RMS slope of the half vectors of a Blinn-Phong lobe, whose density over the projected
// hemisphere is (shine + 2)/2π cos^shine: its mean of tan² is 2/shine, exactly.
double slope_of_shine(double shine);

// Lobes of a material by use.
enum class Lobes {
  about_normal,  // all but a retroreflector's: they turn with the normal
  finite,        // all but mirrors and smooth coats
};
// Returns the RMS slope of a material's narrowest lobe, along the narrower axis; 0: a mirror or a
// smooth coat, as far as no rough coat blurs it. None: no such lobe. Roughness maps are ignored.
std::optional<double> narrowest_slope(const Material& material, Lobes lobes);

// Returns a model with these slopes along u and v; cook_torrance takes the first, a model without
// slopes has its defaults.
SpecularBrdf with_slopes(SpecularModel model, const Vec2& alpha);

// Returns true for an anisotropic material: slopes that differ along u and v, or tilted cells.
bool is_anisotropic(const Material& material);

// Returns the roughness of eon whose terms have the same ratio as those of Oren and Nayar's BRDF
// for slopes of standard deviation σ, radians: 0 to 0.9.
double eon_roughness(double sigma);

// Returns the degrees whose product with kDegree is `radians`, to the last bit if there are such.
double exact_degrees(double radians);

// Limit of shader variants: 0 to kMostVariants − 1. Materials of equal BRDFs share one; beyond the
// limit, the rarest share the last.
inline constexpr std::uint32_t kMostVariants = 8;
std::vector<std::uint32_t> variants_of(std::span<const Material> materials);

// Returns K of a filling factor φ: −ln(1 − 1.209 φ^⅔)/(1.209 φ^⅔); 1 at 0. Expects: 0 ≤ φ ≤ 0.7. B.
// Hapke, "Bidirectional reflectance spectroscopy: 6. Effects of porosity", 2008.
double porosity_factor(double filling);

// Computes material.fits from the parameters. Materials of resolved() and of a pan are already
// fitted. Cost: a millisecond for compensated microfacets, more for anisotropic ones, less for
// Hapke's BRDF. Repeated fits of equal microfacets are cached.
void fit(Material& material);

// Applies the defaults, selects the BRDFs and fits. A part without effect gets the cheapest BRDF:
// lambert or none. A specular colour without another model is Blinn-Phong's lobe of exponent 0.
//
// Expects: numbers within the ranges of the schema; they are finite, >= 0, and slopes are > 0.
// Reports at `where`: N1401, W1402, W1403, W1404, N1405. Never fails.
Material resolved(const Fields& fields, SourceSpan where, DiagnosticLog& log);

}  // namespace panwright::materials
