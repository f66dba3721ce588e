// The C++ reading of the formulas, included once for each precision inside its namespace, which has
// Real and Vec3. glm's + - * / on vectors are those of GLSL.

inline Real min(Real a, Real b) { return b < a ? b : a; }
inline Real max(Real a, Real b) { return a < b ? b : a; }
inline Real abs(Real a) { return a < Real(0) ? -a : a; }
inline Real sqrt(Real a) { return std::sqrt(a); }
// a·2^k. Expects: 2^k is a normal number.
inline Real ldexp(Real a, int k) {
  using Bits = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
  constexpr int kDigits = std::numeric_limits<Real>::digits - 1;
  constexpr int kBias = std::numeric_limits<Real>::max_exponent - 1;
  return a * std::bit_cast<Real>(static_cast<Bits>(kBias + k) << kDigits);
}

#define FORMULA inline
#include "materials/formulas/parameters.glsl"
//
#include "materials/formulas/common.glsl"
//
#include "materials/formulas/fresnel.glsl"
//
#include "materials/formulas/blinn_phong.glsl"
#include "materials/formulas/cook_torrance.glsl"
#include "materials/formulas/hapke.glsl"
#include "materials/formulas/lambert.glsl"
#include "materials/formulas/no_specular.glsl"
#include "materials/formulas/oren_nayar.glsl"
#undef FORMULA

using Law = Vec3 (*)(Surface, Vec3, Vec3, Vec3);

// surface_brdf and surface_radiance for one pair of laws.
template <Law kDiffuse, Law kSpecular>
struct Pair {
#define FORMULA static
#define PANWRIGHT_DIFFUSE_LAW kDiffuse
#define PANWRIGHT_SPECULAR_LAW kSpecular
#include "materials/formulas/surface.glsl"
#undef FORMULA
#undef PANWRIGHT_DIFFUSE_LAW
#undef PANWRIGHT_SPECULAR_LAW
};

inline Vec3 rounded(const panwright::Vec3& v) {
  return Vec3(static_cast<Real>(v.x), static_cast<Real>(v.y), static_cast<Real>(v.z));
}

inline Surface surface_of(const Material& material) {
  Surface s;
  s.diffuse = rounded(material.diffuse);
  s.specular = rounded(material.specular);
  s.emissive = rounded(material.emissive);
  s.weights = rounded(material.weights);
  s.indices = material.refract ? rounded(*material.refract) : Vec3(Real(0));
  s.shine = static_cast<Real>(material.shine);
  s.cook_d = static_cast<Real>(material.cook[0]);
  s.cook_m = static_cast<Real>(material.cook[1]);
  s.cook_f = static_cast<Real>(material.cook[2]);
  s.cook_g = static_cast<Real>(material.cook[3]);
  s.oren = static_cast<Real>(material.oren);
  s.hapke_w = static_cast<Real>(material.hapke[0]);
  s.hapke_h = static_cast<Real>(material.hapke[1]);
  s.hapke_b0 = static_cast<Real>(material.hapke[2]);
  s.hapke_rough = static_cast<Real>(material.hapke[3]);
  s.hapke_b = Real(0);
  s.hapke_c = Real(0);
  return s;
}

// Calls `use` with the Pair of a material's laws.
template <Law kDiffuse, class Use>
auto with_specular(SpecularLaw specular, Use use) {
  switch (specular) {
    case SpecularLaw::none:
      break;
    case SpecularLaw::blinn_phong:
      return use(Pair<kDiffuse, blinn_phong_law>());
    case SpecularLaw::cook_torrance:
      return use(Pair<kDiffuse, cook_torrance_law>());
  }
  return use(Pair<kDiffuse, no_specular_law>());
}

template <class Use>
auto with_laws(const Material& material, Use use) {
  switch (material.diffuse_law) {
    case DiffuseLaw::lambert:
      break;
    case DiffuseLaw::oren_nayar:
      return with_specular<oren_nayar_law>(material.specular_law, use);
    case DiffuseLaw::hapke:
      return with_specular<hapke_law>(material.specular_law, use);
  }
  return with_specular<lambert_law>(material.specular_law, use);
}
