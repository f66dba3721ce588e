// The text of f64::hapke() for all lanes: compilers make vectors of it only where every call is
// inlined.
#include "materials/internal/hapke_lanes.h"

#include <algorithm>
#include <iterator>

namespace panwright::materials {

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

// the same text as f64, of other names
namespace lanes {
using Real = double;
using Vec3 = glm::dvec3;
#define PANWRIGHT_FORMULA inline __attribute__((always_inline))
#include "materials/internal/formulas.inl"
}  // namespace lanes

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace {

inline __attribute__((always_inline)) void fill(const f64::SurfaceFields& from, HapkeLanes& all) {
  lanes::SurfaceFields s;
  s.hapke_w = from.hapke_w;
  s.hapke_h = from.hapke_h;
  s.hapke_b0 = from.hapke_b0;
  s.hapke_rough = from.hapke_rough;
  s.hapke_b = from.hapke_b;
  s.hapke_c = from.hapke_c;
  s.hapke_hc = from.hapke_hc;
  s.hapke_bc0 = from.hapke_bc0;
  s.hapke_k = from.hapke_k;
  s.hapke_h0 = from.hapke_h0;
  s.hapke_h1 = from.hapke_h1;
  s.hapke_h2 = from.hapke_h2;
  s.hapke_h3 = from.hapke_h3;
  s.hapke_h4 = from.hapke_h4;
  s.hapke_h5 = from.hapke_h5;
  s.hapke_h6 = from.hapke_h6;
  s.hapke_h7 = from.hapke_h7;
  s.exact_h = from.exact_h;
  const auto& l = all.to_light;
  const auto& v = all.to_viewer;
  const auto& n = all.normal;
  double value[HapkeLanes::kCount];  // that nothing else points to
#if defined(__clang__)
#pragma clang loop vectorize(enable)
#endif
  for (int i = 0; i < HapkeLanes::kCount; ++i)
    value[i] = lanes::hapke(s, {l[0][i], l[1][i], l[2][i]}, {v[0][i], v[1][i], v[2][i]},
                            {n[0][i], n[1][i], n[2][i]});
  std::copy(std::begin(value), std::end(value), all.value);
}

#if defined(__x86_64__)
__attribute__((target("avx2"), flatten)) void wide_hapke(const f64::SurfaceFields& s,
                                                         HapkeLanes& all) {
  fill(s, all);
}
#endif

}  // namespace

__attribute__((flatten)) void plain_hapke(const f64::SurfaceFields& s, HapkeLanes& all) {
  fill(s, all);
}

void hapke(const f64::SurfaceFields& s, HapkeLanes& all) {
#if defined(__x86_64__)
  static const bool wide = __builtin_cpu_supports("avx2") != 0;
  if (wide) return wide_hapke(s, all);
#endif
  plain_hapke(s, all);
}

}  // namespace panwright::materials
