// Directions and parameters that break reflectance formulas, and every formula with its cases.
// Shared by tests, benches and the comparison with OpenGL.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "materials/internal/formulas.h"

namespace panwright::hard_cases {

// Inputs of one evaluation: 16 floats, in the shader's layout.
struct Inputs {
  glm::vec3 l{0, 0, 1};  // to light, unit to rounding
  glm::vec3 v{0, 0, 1};  // to viewer
  glm::vec3 n{0, 0, 1};
  std::array<float, 7> p{};  // the formula's parameters
};
static_assert(sizeof(Inputs) == 64);

inline constexpr std::array kCosines{0.0, 1e-7, 1e-4, 0.01, 0.5, 1 - 1e-7, 1.0};
inline constexpr std::array kAzimuths{0.0, 1e-6, kPi / 2, kPi - 1e-6, kPi};
inline constexpr std::array kSlopes{0.0, 1e-4, 1.64e-3, 0.01, 0.15, 1.0, 10.0};
inline constexpr std::array kIndices{1.0, 1 + 1e-6, 1.5, 100.0};
inline constexpr std::array kSigmas{0.0, 1e-3, 0.1, 0.3, 1.0, kPi / 2};
inline constexpr std::array kShines{0.0, 1.0, 10.0, 128.0, 1000.0};
// w, h, B0, roughness in radians, b, c, K
inline constexpr std::array<std::array<double, 7>, 9> kHapke{
    {{0.21, 0.07, 1, 0, 0.25, 0.3, 1},
     {0.21, 0.07, 1, 20 * kDegree, 0.25, 0.3, 1.7},
     {1, 0, 0, 0, 0, 0, 1},
     {0.9, 0, 1, 1 * kDegree, 0, 0, 1},
     {0.6, 1e-4, 3, 60 * kDegree, 0, 0, 1},
     {0.3, 1, 0.5, 1e-4, 0.9, -1, 1},
     {0, 0.05, 1, 0.3, 0, 0, 1},
     {0.95, 0.05, 1, 0.3, 0.6, 0.8, 3.4},
     {1, 100, 100, 80 * kDegree, 0, 0, 1}}};
inline constexpr std::array kRoughnesses{0.0, 1e-7, 1e-3, 0.25, 0.5, 1.0};

inline glm::dvec3 direction(double cosine, double azimuth) {
  const double sine = std::sqrt((1 - cosine) * (1 + cosine));
  return {sine * det::cos(azimuth), sine * det::sin(azimuth), cosine};
}

// All pairs of cosines with all azimuths, about +z (7*7*5). Sines of π are exactly 0 here.
inline std::vector<Inputs> grid() {
  std::vector<Inputs> all;
  for (const double cos_nl : kCosines)
    for (const double cos_nv : kCosines)
      for (const double azimuth : kAzimuths) {
        glm::dvec3 l = direction(cos_nl, azimuth);
        if (azimuth == kPi) l.y = 0;
        all.push_back({glm::vec3(l), glm::vec3(direction(cos_nv, 0)), {0, 0, 1}, {}});
      }
  return all;
}

// The same about a normal with no zero components. note: cosines are then only known to 1e-7, so
// relative errors at grazing angles do not test the formula.
inline std::vector<Inputs> tilted_grid() {
  const glm::dmat3 tilt = glm::mat3_cast(glm::normalize(glm::dquat(0.3, -0.5, 0.7, 0.2)));
  std::vector<Inputs> all = grid();
  for (Inputs& one : all) {
    one.l = glm::vec3(glm::normalize(tilt * glm::dvec3(one.l)));
    one.v = glm::vec3(glm::normalize(tilt * glm::dvec3(one.v)));
    one.n = glm::vec3(tilt[2]);
  }
  return all;
}

// Uniform in [0, 1): splitmix64.
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : state_(seed) {}
  double operator()() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  // A direction about +z, its cosine uniform in [least, 1]. (Arguments have no order in C++.)
  glm::dvec3 direction_above(double least) {
    const double cosine = least + (1 - least) * (*this)();
    return direction(cosine, 2 * kPi * (*this)());
  }

 private:
  std::uint64_t state_;
};

// Pairs whose half vector lies within 2.5 slopes of the normal, about normals of all directions.
inline std::vector<Inputs> near_specular(double slope, std::size_t count, std::uint64_t seed = 1) {
  Uniform uniform(seed);
  std::vector<Inputs> all;
  while (all.size() < count) {
    const glm::dvec3 n = uniform.direction_above(-1);
    const glm::dvec3 x = glm::normalize(
        glm::cross(n, std::fabs(n.z) < 0.5 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
    const glm::dvec3 y = glm::cross(n, x);
    const auto about_n = [&](const glm::dvec3& d) { return d.x * x + d.y * y + d.z * n; };
    const double tangent = 2.5 * slope * std::sqrt(uniform());
    const glm::dvec3 h =
        about_n(direction(1 / std::sqrt(1 + tangent * tangent), 2 * kPi * uniform()));
    const glm::dvec3 v = about_n(uniform.direction_above(0.05));
    const glm::dvec3 l = 2 * glm::dot(v, h) * h - v;
    if (glm::dot(n, l) < 0.05) continue;
    all.push_back({glm::vec3(l), glm::vec3(v), glm::vec3(n), {}});
  }
  return all;
}

// Pairs of uniform directions at least `least` above the horizon, about +z.
inline std::vector<Inputs> random_pairs(double least, std::size_t count, std::uint64_t seed = 2) {
  Uniform uniform(seed);
  std::vector<Inputs> all;
  for (std::size_t i = 0; i < count; ++i)
    all.push_back({glm::vec3(uniform.direction_above(least)),
                   glm::vec3(uniform.direction_above(least)),
                   {0, 0, 1},
                   {}});
  return all;
}

// Every case with every set of parameters.
template <class Sets>
std::vector<Inputs> with_parameters(const std::vector<Inputs>& directions, const Sets& sets) {
  std::vector<Inputs> all;
  for (const auto& set : sets)
    for (Inputs one : directions) {
      for (std::size_t k = 0; k < set.size(); ++k) one.p[k] = static_cast<float>(set[k]);
      all.push_back(one);
    }
  return all;
}

// Hapke's parameters, with the coherent backscatter that goes with them and H of 2002, whose
// reciprocal 1 - w x (r0 + (1/2 - r0 x) ln(1 + 1/x)) has the form of the fit.
#define PANWRIGHT_HAPKE_SURFACE                                                                  \
  SurfaceFields hapke_surface(Real w, Real h, Real b0, Real rough, Real b, Real c, Real dense) { \
    SurfaceFields s;                                                                             \
    s.diffuse = Vec3(Real(1));                                                                   \
    s.hapke_w = w;                                                                               \
    s.hapke_h = h;                                                                               \
    s.hapke_b0 = b0;                                                                             \
    s.hapke_rough = rough;                                                                       \
    s.hapke_b = b;                                                                               \
    s.hapke_c = c;                                                                               \
    s.hapke_hc = Real(0.5) * h;                                                                  \
    s.hapke_bc0 = Real(0.25) * b0;                                                               \
    s.hapke_k = dense;                                                                           \
    Real root = sqrt(Real(1) - w);                                                               \
    Real r0 = (Real(1) - root) / (Real(1) + root);                                               \
    s.hapke_h0 = w * r0;                                                                         \
    s.hapke_h1 = Real(0);                                                                        \
    s.hapke_h2 = Real(0);                                                                        \
    s.hapke_h3 = Real(0);                                                                        \
    s.hapke_h4 = Real(0.5) * w;                                                                  \
    s.hapke_h5 = -w * r0;                                                                        \
    s.hapke_h6 = Real(0);                                                                        \
    s.hapke_h7 = Real(0);                                                                        \
    return s;                                                                                    \
  }
#define PANWRIGHT_TEXT(...) #__VA_ARGS__
#define PANWRIGHT_TEXT_OF(...) PANWRIGHT_TEXT(__VA_ARGS__)

// GLSL called by the expressions beyond the formulas. Placed after Real and Vec3 are defined.
inline const std::string kHelpers =
    "#define SurfaceFields Surface\n" PANWRIGHT_TEXT_OF(PANWRIGHT_HAPKE_SURFACE) "\n";

}  // namespace panwright::hard_cases

namespace panwright::materials::f32 {
inline PANWRIGHT_HAPKE_SURFACE
}
namespace panwright::materials::f64 {
inline PANWRIGHT_HAPKE_SURFACE
}

namespace panwright::hard_cases {

// Formula and its cases. The expression is read by C++ twice and by GLSL; it may use Real, Vec3, l,
// v, n and p[].
struct Formula {
  std::string name;
  std::string expression;
  glm::vec3 (*f32)(const Inputs&);
  glm::dvec3 (*f64)(const Inputs&);
  std::vector<Inputs> cases;
  bool of_directions = true;  // false: a function of numbers only
};

// NOLINTBEGIN
#define PANWRIGHT_FORMULA(name, ...)                                                     \
  ::panwright::hard_cases::Formula {                                                     \
    name, #__VA_ARGS__,                                                                  \
        [](const ::panwright::hard_cases::Inputs& i) {                                   \
          using namespace ::panwright::materials::f32;                                   \
          using Real [[maybe_unused]] = float;                                           \
          using Vec3 = glm::vec3;                                                        \
          [[maybe_unused]] const Vec3 l = i.l, v = i.v, n = i.n;                         \
          [[maybe_unused]] const auto& p = i.p;                                          \
          return Vec3(__VA_ARGS__);                                                      \
        },                                                                               \
        [](const ::panwright::hard_cases::Inputs& i) {                                   \
          using namespace ::panwright::materials::f64;                                   \
          using Real [[maybe_unused]] = double;                                          \
          using Vec3 = glm::dvec3;                                                       \
          [[maybe_unused]] const Vec3 l(i.l), v(i.v), n(i.n);                            \
          [[maybe_unused]] const std::array<double, 7> p{i.p[0], i.p[1], i.p[2], i.p[3], \
                                                         i.p[4], i.p[5], i.p[6]};        \
          return Vec3(__VA_ARGS__);                                                      \
        },                                                                               \
    {}                                                                                   \
  }
// NOLINTEND

// Numbers for formulas of one or two numbers: p[0] from each decade of [1e-8, most], p[1] as well.
inline std::vector<Inputs> numbers(double most) {
  std::vector<Inputs> all(1);
  for (double x = 1e-8; x <= most; x *= 1.0173)
    for (const double y : {0.0, 1e-7, 0.01, 1.0}) {
      all.emplace_back();
      all.back().p[0] = static_cast<float>(x);
      all.back().p[1] = static_cast<float>(y);
    }
  return all;
}

// Places, footprints, gap, fingers and their width for the pattern of solar cells, in numbers exact
// in float: beside an edge rounding decides.
inline std::vector<Inputs> cell_cases() {
  std::vector<Inputs> all;
  for (const double u : {0.0, 0.25, 0.984375, 17.5, -3.0625})
    for (const double v : {0.0, 0.5, 4096.75})
      for (const double width : {0.0, 0.0009765625, 0.125, 0.75, 1.0, 3.0, 100.5})
        for (const double height : {0.0, 0.0625, 2.25})
          for (const double gap : {0.0, 0.03125, 0.5})
            for (const double fingers : {0.0, 1.0, 32.0}) {
              all.emplace_back();
              const double p[] = {u, v, width, height, gap, fingers, 0.0625};
              for (std::size_t k = 0; k < 7; ++k) all.back().p[k] = static_cast<float>(p[k]);
            }
  return all;
}

// All formulas over the hard cases.
inline std::vector<Formula> formulas() {
  const auto pairs_of = [](const auto& first, const auto& second) {
    std::vector<std::array<double, 2>> sets;
    for (const double a : first)
      for (const double b : second) sets.push_back({a, b});
    return sets;
  };
  const auto singles = [](const auto& values) {
    std::vector<std::array<double, 1>> sets;
    for (const double a : values) sets.push_back({a});
    return sets;
  };
  std::vector<double> cosines;
  for (int i = 0; i <= 1000; ++i) cosines.push_back(i * 1e-3);
  cosines.insert(cosines.end(), {1e-7, 1e-4, 1 - 1e-7});
  std::vector<double> indices{0.0, 0.5, 1.33, 1.7, 2.4, 4.2};
  indices.insert(indices.end(), kIndices.begin(), kIndices.end());

  std::vector<std::array<double, 3>> conductors;
  for (const double n : {0.0, 0.05, 0.9, 1.5, 50.0})
    for (const double k : {0.0, 1e-6, 1.0, 7.0, 50.0})
      for (const double c : cosines) conductors.push_back({c, n, k});

  std::vector<Formula> all;
  const auto add = [&](Formula formula, std::vector<Inputs> cases, bool of_directions = true) {
    formula.cases = std::move(cases);
    formula.of_directions = of_directions;
    all.push_back(std::move(formula));
  };
  add(PANWRIGHT_FORMULA("exp_negative", Vec3(exp_negative(p[0]), one_minus_exp(p[0]), Real(0))),
      numbers(90), false);
  add(PANWRIGHT_FORMULA("log_one_plus", Vec3(log_one_plus(p[0]))), numbers(1e20), false);
  add(PANWRIGHT_FORMULA("angle_of", Vec3(angle_of(p[0], p[1]))), numbers(1), false);
  add(PANWRIGHT_FORMULA("tangent", Vec3(tangent(p[0]))), numbers(1.5), false);
  add(PANWRIGHT_FORMULA("fresnel", Vec3(fresnel_dielectric(p[0], p[1]))),
      with_parameters({Inputs{}}, pairs_of(cosines, indices)), false);
  add(PANWRIGHT_FORMULA("lambert", lambert(Vec3(p[0]), l, v, n)),
      with_parameters(grid(), singles(std::array{0.8})));
  add(PANWRIGHT_FORMULA("oren_nayar",
                        oren_nayar(Vec3(p[0], Real(0.5) * p[0], Real(0)), p[1], l, v, n)),
      with_parameters(grid(), pairs_of(std::array{1.0, 0.3}, kSigmas)));
  add(PANWRIGHT_FORMULA("blinn_phong", Vec3(blinn_phong(p[0], l, v, n))),
      with_parameters(grid(), singles(kShines)));
  add(PANWRIGHT_FORMULA("cook_torrance", Vec3(fresnel_dielectric(half_cosine(l, v), p[1]) *
                                              cook_torrance(p[0], l, v, n))),
      with_parameters(grid(), pairs_of(kSlopes, kIndices)));
  add(PANWRIGHT_FORMULA("eon", eon(Vec3(p[0], Real(0.5) * p[0], Real(0)), p[1], l, v, n)),
      with_parameters(grid(), pairs_of(std::array{1.0, 0.3}, kRoughnesses)));
  add(PANWRIGHT_FORMULA("fon", Vec3(fon(p[0], l, v, n))),
      with_parameters(grid(), singles(kRoughnesses)));
  add(PANWRIGHT_FORMULA("fon_albedo_deficit",
                        Vec3(fon_albedo_deficit(p[0], sqrt(max(Real(1) - p[0] * p[0], Real(0)))))),
      numbers(1), false);
  add(PANWRIGHT_FORMULA(
          "hapke", Vec3(hapke(hapke_surface(p[0], p[1], p[2], p[3], p[4], p[5], p[6]), l, v, n))),
      with_parameters(grid(), kHapke));
  add(PANWRIGHT_FORMULA("cell_shares",
                        cell_shares(p[0], p[1], p[2], p[3], p[4], Real(0.5) * p[4], p[5], p[6])),
      cell_cases(), false);
  add(PANWRIGHT_FORMULA("conductor", Vec3(fresnel_conductor(p[0], p[1], p[2]))),
      with_parameters({Inputs{}}, conductors), false);
  // slopes p[0] along x and p[1] across it
  add(PANWRIGHT_FORMULA("beckmann_smith",
                        Vec3(beckmann_smith(max(p[0], Real(1e-6)), max(p[1], Real(1e-6)),
                                            Vec3(Real(1), Real(0), Real(0)), l, v, n))),
      with_parameters(grid(), pairs_of(kSlopes, kSlopes)));
  add(PANWRIGHT_FORMULA("ggx_smith", Vec3(ggx_smith(max(p[0], Real(1e-6)), max(p[1], Real(1e-6)),
                                                    Vec3(Real(1), Real(0), Real(0)), l, v, n))),
      with_parameters(grid(), pairs_of(kSlopes, kSlopes)));
  add(PANWRIGHT_FORMULA("lommel_seeliger", Vec3(lommel_seeliger(p[0], l, v, n))),
      with_parameters(grid(), singles(std::array{1.0, 0.1})));
  return all;
}

// Lobes of Smith's microfacets near their peaks.
inline std::vector<Formula> facets_near_specular(double slope, std::size_t count) {
  std::vector<Formula> all{
      PANWRIGHT_FORMULA("beckmann_smith", Vec3(beckmann_smith(p[0], p[0], Vec3(Real(0)), l, v, n))),
      PANWRIGHT_FORMULA("ggx_smith", Vec3(ggx_smith(p[0], p[0], Vec3(Real(0)), l, v, n)))};
  for (Formula& formula : all)
    formula.cases = with_parameters(near_specular(slope, count), std::vector{std::array{slope}});
  return all;
}

// The distribution D of the half vector, sampled near its peak.
inline Formula beckmann_near_specular(double slope, std::size_t count) {
  Formula formula = PANWRIGHT_FORMULA(
      "beckmann", Vec3(beckmann(half_tan2(l, v, n, dot3(n, l) + dot3(n, v)), p[0])));
  formula.cases = with_parameters(near_specular(slope, count), std::vector{std::array{slope}});
  return formula;
}

// ---- comparison

struct Worst {
  double error = 0;
  std::size_t at = 0;  // index of the case
  int channel = 0;
  std::size_t bad = 0;  // values that are not finite or negative
};

// The largest relative error of f32 against f64 on the same float inputs. Values below `floor`
// count as their distance to the reference over the floor.
inline Worst worst_error(const Formula& formula, double floor = 1e-30) {
  Worst worst;
  for (std::size_t i = 0; i < formula.cases.size(); ++i) {
    const glm::vec3 got = formula.f32(formula.cases[i]);
    const glm::dvec3 want = formula.f64(formula.cases[i]);
    for (int k = 0; k < 3; ++k) {
      if (!(std::isfinite(got[k]) && got[k] >= 0 && std::isfinite(want[k]) && want[k] >= 0)) {
        ++worst.bad;
        worst.at = i;
        continue;
      }
      const double error =
          std::fabs(static_cast<double>(got[k]) - want[k]) / std::max(want[k], floor);
      if (error > worst.error && worst.bad == 0) worst = {error, i, k, 0};
    }
  }
  return worst;
}

}  // namespace panwright::hard_cases
