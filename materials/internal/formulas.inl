// The C++ reading of the formulas, included once for each precision inside its namespace, which has
// Real and Vec3. glm's + - * / on vectors are those of GLSL.

#if !defined(PANWRIGHT_FORMULA)
#define PANWRIGHT_FORMULA inline
#endif
#define FORMULA PANWRIGHT_FORMULA

FORMULA Real min(Real a, Real b) { return b < a ? b : a; }
FORMULA Real max(Real a, Real b) { return a < b ? b : a; }
FORMULA Real abs(Real a) { return a < Real(0) ? -a : a; }
FORMULA Real sqrt(Real a) { return std::sqrt(a); }
FORMULA Real floor(Real a) { return std::floor(a); }
// a·2^k. Expects: 2^k is a normal number.
FORMULA Real ldexp(Real a, int k) {
  using Bits = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
  constexpr int kDigits = std::numeric_limits<Real>::digits - 1;
  constexpr int kBias = std::numeric_limits<Real>::max_exponent - 1;
  return a * std::bit_cast<Real>(static_cast<Bits>(kBias + k) << kDigits);
}
// a as f·2^k, f in [1/2, 1). Expects: normal, > 0.
FORMULA Real frexp(Real a, int& k) {
  using Bits = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
  constexpr int kDigits = std::numeric_limits<Real>::digits - 1;
  constexpr int kBias = std::numeric_limits<Real>::max_exponent - 1;
  const auto bits = std::bit_cast<Bits>(a);
  k = static_cast<int>(bits >> kDigits) - kBias + 1;
  return std::bit_cast<Real>((bits & ((Bits(1) << kDigits) - 1)) | Bits(kBias - 1) << kDigits);
}

// BRDFs take their parameters by value in GLSL, by reference here
#define Surface SurfaceParameters
#include "materials/internal/generated/parameters.glsl"
#undef Surface
struct SurfaceFields : SurfaceParameters {
  const HapkeHCorrection* exact_h = nullptr;  // none: H as fitted
};
using Surface = const SurfaceFields&;
#define Incidence IncidenceFields
#include "materials/formulas/incidence.glsl"
#undef Incidence
using Incidence = const IncidenceFields&;
// light from one direction
inline IncidenceFields from_point(const Vec3& to_light) {
  return {to_light, Vec3(Real(1)), Real(0), Real(0)};
}
FORMULA Real hapke_h_function(Surface s, Real x);
FORMULA Real hapke_h_of(Surface s, Real x) {
  const Real fitted = hapke_h_function(s, x);
  if (!s.exact_h) return fitted;
  return fitted * static_cast<Real>((*s.exact_h)(static_cast<double>(x)));
}
#define PANWRIGHT_H hapke_h_of
#include "materials/internal/generated/formula_includes.inl"
#undef FORMULA
#undef PANWRIGHT_FORMULA
#undef PANWRIGHT_H

// surface_brdf and surface_radiance of any BRDFs.
struct Composition {
  BrdfModel brdf_model;

#include "materials/internal/generated/brdf_choice.inl"

  // by the indices, whatever a map says
  Vec3 own_fresnel(Surface s, Real cosine, Real outer) const {
    switch (brdf_model.fresnel) {
      case FresnelModel::none:
        break;
      case FresnelModel::dielectric:
        return dielectric_fresnel(s, cosine, outer);
      case FresnelModel::conductor:
        return conductor_fresnel(s, cosine, outer);
    }
    return no_fresnel(s, cosine, outer);
  }
  Vec3 fresnel(Surface s, Real cosine, Real outer) const {
    if (!brdf_model.mapped) return own_fresnel(s, cosine, outer);
    if (brdf_model.fresnel == FresnelModel::none) return mapped_no_fresnel(s, cosine, outer);
    return mapped_fresnel(s, own_fresnel(s, cosine, outer));
  }
  Vec3 compensation(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) const {
    if (!brdf_model.compensated) return no_compensation(s, to_light, to_viewer, normal);
    return brdf_model.mapped ? mapped_compensation(s, to_light, to_viewer, normal)
                       : microfacet_compensation(s, to_light, to_viewer, normal);
  }
  Vec3 layers(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal) {
    if (!brdf_model.coated) return bare(s, light, to_viewer, normal);
    return brdf_model.specular == SpecularModel::mirror ? coated_mirror(s, light, to_viewer, normal)
                                                : coated(s, light, to_viewer, normal);
  }

#define FORMULA
#define PANWRIGHT_DIFFUSE diffuse
#define PANWRIGHT_FROM lobe_from
#define PANWRIGHT_LOBE lobe
#define PANWRIGHT_FRESNEL fresnel
#define PANWRIGHT_COMPENSATION compensation
#define PANWRIGHT_LAYERS layers
#include "materials/formulas/surface.glsl"
#undef FORMULA
#undef PANWRIGHT_DIFFUSE
#undef PANWRIGHT_FROM
#undef PANWRIGHT_LOBE
#undef PANWRIGHT_FRESNEL
#undef PANWRIGHT_COMPENSATION
#undef PANWRIGHT_LAYERS
};

#include "materials/internal/generated/surface_of.inl"

inline Composition composition_of(const Material& material) { return {brdf_model_of(material)}; }
