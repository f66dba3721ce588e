// The C++ reading of the formulas, included once for each precision inside its namespace, which has
// Real and Vec3. glm's + - * / on vectors are those of GLSL.

inline Real min(Real a, Real b) { return b < a ? b : a; }
inline Real max(Real a, Real b) { return a < b ? b : a; }
inline Real abs(Real a) { return a < Real(0) ? -a : a; }
inline Real sqrt(Real a) { return std::sqrt(a); }
inline Real floor(Real a) { return std::floor(a); }
// a·2^k. Expects: 2^k is a normal number.
inline Real ldexp(Real a, int k) {
  using Bits = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
  constexpr int kDigits = std::numeric_limits<Real>::digits - 1;
  constexpr int kBias = std::numeric_limits<Real>::max_exponent - 1;
  return a * std::bit_cast<Real>(static_cast<Bits>(kBias + k) << kDigits);
}

#define FORMULA inline
// laws take their parameters by value in GLSL, by reference here
#define Surface SurfaceParameters
#include "materials/formulas/parameters.glsl"
#undef Surface
struct SurfaceFields : SurfaceParameters {
  const HapkeHCorrection* exact_h = nullptr;  // none: H as fitted
};
using Surface = const SurfaceFields&;
inline Real hapke_h_function(Surface s, Real x);
inline Real hapke_h_of(Surface s, Real x) {
  const Real fitted = hapke_h_function(s, x);
  if (!s.exact_h) return fitted;
  return fitted * static_cast<Real>((*s.exact_h)(static_cast<double>(x)));
}
#define PANWRIGHT_H hapke_h_of
#include "materials/formulas/common.glsl"
//
#include "materials/formulas/fresnel.glsl"
//
#include "materials/formulas/blinn_phong.glsl"
#include "materials/formulas/cook_torrance.glsl"
#include "materials/formulas/hapke.glsl"
#include "materials/formulas/lambert.glsl"
#include "materials/formulas/lommel_seeliger.glsl"
#include "materials/formulas/no_specular.glsl"
#include "materials/formulas/oren_nayar.glsl"
//
#include "materials/formulas/eon.glsl"
#include "materials/formulas/facets.glsl"
//
#include "materials/formulas/cells.glsl"
#include "materials/formulas/coat.glsl"
#undef FORMULA
#undef PANWRIGHT_H

// surface_brdf and surface_radiance of any laws.
struct Composition {
  Laws laws;

  Vec3 diffuse(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) const {
    switch (laws.diffuse) {
      case DiffuseLaw::lambert:
        break;
      case DiffuseLaw::oren_nayar:
        return oren_nayar_law(s, to_light, to_viewer, normal);
      case DiffuseLaw::hapke:
        return hapke_law(s, to_light, to_viewer, normal);
      case DiffuseLaw::eon:
        return eon_law(s, to_light, to_viewer, normal);
      case DiffuseLaw::lommel_seeliger:
        return lommel_seeliger_law(s, to_light, to_viewer, normal);
    }
    return lambert_law(s, to_light, to_viewer, normal);
  }
  Real lobe(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) const {
    switch (laws.specular) {
      case SpecularLaw::none:
        break;
      case SpecularLaw::blinn_phong:
        return blinn_phong_lobe(s, to_light, to_viewer, normal);
      case SpecularLaw::cook_torrance:
        return cook_torrance_lobe(s, to_light, to_viewer, normal);
      case SpecularLaw::beckmann:
        return beckmann_lobe(s, to_light, to_viewer, normal);
      case SpecularLaw::ggx:
        return ggx_lobe(s, to_light, to_viewer, normal);
      case SpecularLaw::mirror:
        return mirror_lobe(s, to_light, to_viewer, normal);
    }
    return no_specular_lobe(s, to_light, to_viewer, normal);
  }
  // by the indices, whatever a map says
  Vec3 own_fresnel(Surface s, Real cosine, Real outer) const {
    switch (laws.fresnel) {
      case FresnelLaw::none:
        break;
      case FresnelLaw::dielectric:
        return dielectric_fresnel(s, cosine, outer);
      case FresnelLaw::conductor:
        return conductor_fresnel(s, cosine, outer);
    }
    return no_fresnel(s, cosine, outer);
  }
  Vec3 fresnel(Surface s, Real cosine, Real outer) const {
    if (!laws.mapped) return own_fresnel(s, cosine, outer);
    if (laws.fresnel == FresnelLaw::none) return mapped_no_fresnel(s, cosine, outer);
    return mapped_fresnel(s, own_fresnel(s, cosine, outer));
  }
  Vec3 many(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) const {
    if (!laws.compensated) return no_many(s, to_light, to_viewer, normal);
    return laws.mapped ? mapped_many(s, to_light, to_viewer, normal)
                       : facet_many(s, to_light, to_viewer, normal);
  }
  Vec3 layers(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
    if (!laws.coated) return bare(s, to_light, to_viewer, normal);
    return laws.specular == SpecularLaw::mirror ? coated_mirror(s, to_light, to_viewer, normal)
                                                : coated(s, to_light, to_viewer, normal);
  }

#define FORMULA
#define PANWRIGHT_DIFFUSE diffuse
#define PANWRIGHT_LOBE lobe
#define PANWRIGHT_FRESNEL fresnel
#define PANWRIGHT_MANY many
#define PANWRIGHT_LAYERS layers
#include "materials/formulas/surface.glsl"
#undef FORMULA
#undef PANWRIGHT_DIFFUSE
#undef PANWRIGHT_LOBE
#undef PANWRIGHT_FRESNEL
#undef PANWRIGHT_MANY
#undef PANWRIGHT_LAYERS
};

inline Vec3 rounded(const panwright::Vec3& v) {
  return Vec3(static_cast<Real>(v.x), static_cast<Real>(v.y), static_cast<Real>(v.z));
}

// The parameters of a fitted material.
inline SurfaceFields surface_of(const Material& material, const Vec3& tangent = Vec3(Real(0)),
                                Real sun_alpha2 = Real(0)) {
  const auto real = [](double value) { return static_cast<Real>(value); };
  SurfaceFields s{};
  s.diffuse = rounded(material.diffuse);
  s.specular = rounded(material.specular);
  s.emissive = rounded(material.emissive);
  s.weights = rounded(material.weights);
  s.indices = material.refract ? rounded(*material.refract) : Vec3(Real(0));
  s.extinction = rounded(material.extinction);
  s.shine = real(material.shine);
  s.lobe_scale = real(material.cook[0]) * real(material.cook[2]) * real(material.cook[3]);
  s.alpha = real(material.cook[1]);
  s.alpha_y = real(material.alpha_y);
  s.tangent = tangent;
  s.sun_alpha2 = sun_alpha2;
  s.facing = rounded(material.fits.reflectance);
  s.reflectance = s.facing;
  s.many_scale = rounded(material.fits.many_scale);
  const auto& loss = material.fits.loss;
  s.loss0 = real(loss[0]);
  s.loss1 = real(loss[1]);
  s.loss2 = real(loss[2]);
  s.loss3 = real(loss[3]);
  s.loss4 = real(loss[4]);
  s.loss5 = real(loss[5]);
  s.loss6 = real(loss[6]);
  s.loss7 = real(loss[7]);
  s.oren = real(material.oren);
  s.hapke_w = real(material.hapke[0]);
  s.hapke_h = real(material.hapke[1]);
  s.hapke_b0 = real(material.hapke[2]);
  s.hapke_rough = real(material.hapke[3]);
  s.hapke_b = real(material.grains.b);
  s.hapke_c = real(material.grains.c);
  s.hapke_hc = real(material.grains.h_c);
  s.hapke_bc0 = real(material.grains.b_c0);
  s.hapke_k = real(porosity_factor(material.grains.porosity));
  const auto& h = material.fits.hapke_h;
  s.hapke_h0 = real(h[0]);
  s.hapke_h1 = real(h[1]);
  s.hapke_h2 = real(h[2]);
  s.hapke_h3 = real(h[3]);
  s.hapke_h4 = real(h[4]);
  s.hapke_h5 = real(h[5]);
  s.hapke_h6 = real(h[6]);
  s.hapke_h7 = real(h[7]);
  const Coat coat = material.coat.value_or(Coat{.index = 1});
  s.coat_index = real(coat.index);
  s.coat_alpha = real(coat.alpha);
  s.coat_share = real(material.coat ? 1 : 0);
  s.coat_depth = rounded(coat.depth);
  s.coat_return = rounded(material.fits.coat_return);
  const Vec2 tilt = material.cells ? material.cells->tilt : Vec2(0);
  s.tilt_x = real(det::tan(tilt.x));
  s.tilt_y = real(det::tan(tilt.y));
  return s;
}

inline Composition composition_of(const Material& material) { return {laws_of(material)}; }
