// Narrow lobes under the Sun's disc against a quadrature over the disc of the BRDFs as the papers
// print them, in long double. It shares nothing with the formulas.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "materials/brdf.h"
#include "materials/material.h"

namespace panwright::materials {
namespace {

using Long = long double;
constexpr Long kLongPi = 3.14159265358979323846L;
constexpr Long kRadius = 4.6504e-3L;  // of the Sun at 1 AU

struct Dir {
  Long x, y, z;
};
Dir operator+(const Dir& a, const Dir& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Dir operator*(Long k, const Dir& a) { return {k * a.x, k * a.y, k * a.z}; }
Long dot(const Dir& a, const Dir& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Dir unit(const Dir& a) { return 1 / std::sqrt(dot(a, a)) * a; }
Vec3 rounded(const Dir& a) {
  return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
}

Long fresnel(Long cosine, Long n) {
  const Long t = std::sqrt(1 - (1 - cosine * cosine) / (n * n));
  const Long s = (cosine - n * t) / (cosine + n * t);
  const Long p = (t - n * cosine) / (t + n * cosine);
  return (s * s + p * p) / 2;
}

enum class Brdf { cook_torrance, beckmann, ggx, blinn_phong };

struct Lobe {
  Brdf brdf;
  Long ax, ay, index;

  Long lambda(const Dir& d) const {
    const Long slope = std::sqrt(ax * ax * d.x * d.x + ay * ay * d.y * d.y) / d.z;
    if (brdf == Brdf::ggx) return (std::sqrt(1 + slope * slope) - 1) / 2;
    if (slope < 0.1L) return 0;
    const Long a = 1 / slope;
    return (std::exp(-a * a) / (a * std::sqrt(kLongPi)) - std::erfc(a)) / 2;
  }
  // of the half vector's slopes over alpha
  Long square(const Dir& l, const Dir& v) const {
    const Dir h = l + v;
    const Long x = h.x / (ax * h.z), y = h.y / (ay * h.z);
    return x * x + y * y;
  }
  // f cos(l)
  Long operator()(const Dir& l, const Dir& v) const {
    if (!(l.z > 0 && v.z > 0)) return 0;
    const Dir h = unit(l + v);
    const Long vh = dot(v, h);
    const Long f = index > 0 ? fresnel(vh, index) : 1;
    const Long slopes2 = square(l, v);
    const Long area = kLongPi * ax * ay * h.z * h.z * h.z * h.z;
    switch (brdf) {
      case Brdf::cook_torrance:
        return f * std::exp(-slopes2) / area *
               std::min({Long(1), 2 * h.z * v.z / vh, 2 * h.z * l.z / vh}) / (4 * v.z);
      case Brdf::beckmann:
        return f * std::exp(-slopes2) / area / (1 + lambda(l) + lambda(v)) / (4 * v.z);
      case Brdf::ggx:
        return f / ((1 + slopes2) * (1 + slopes2)) / area / (1 + lambda(l) + lambda(v)) / (4 * v.z);
      case Brdf::blinn_phong: {
        const Long s = 2 / (ax * ax);
        return f * (s + 2) * (s + 4) / (8 * kLongPi * (std::exp2(-s / 2) + s)) *
               std::exp(s * std::log(h.z)) * l.z;
      }
    }
    return 0;
  }
};

const std::vector<std::array<Long, 2>>& gauss_nodes() {
  static const std::vector<std::array<Long, 2>> nodes = [] {
    constexpr int n = 16;
    std::vector<std::array<Long, 2>> all;
    for (int i = 0; i < n; ++i) {
      Long x = std::cos(kLongPi * (i + 0.75L) / (n + 0.5L)), slope = 1;
      for (int k = 0; k < 60; ++k) {
        Long p0 = 1, p1 = x;
        for (int j = 2; j <= n; ++j) {
          const Long p2 = ((2 * j - 1) * x * p1 - (j - 1) * p0) / j;
          p0 = p1;
          p1 = p2;
        }
        slope = n * (x * p1 - p0) / (x * x - 1);
        x -= p1 / slope;
      }
      all.push_back({x, 2 / ((1 - x * x) * slope * slope)});
    }
    return all;
  }();
  return nodes;
}

// ∫ over [from, to] in panels that are short near `about`, as short as `width`.
Long panels(Long from, Long to, Long about, Long width, const std::function<Long(Long)>& f) {
  std::vector<Long> cuts{from};
  for (const Long k : {-40, -12, -4, -1, 1, 4, 12, 40}) {
    const Long cut = about + k * width;
    if (cut > cuts.back() && cut < to) cuts.push_back(cut);
  }
  cuts.push_back(to);
  Long sum = 0;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const Long half = (cuts[i + 1] - cuts[i]) / 2, middle = (cuts[i + 1] + cuts[i]) / 2;
    // ends where the disc ends have square roots: cubic there
    for (const auto& [x, w] : gauss_nodes())
      sum += half * w * Long(1.5) * (1 - x * x) * f(middle + half * (3 * x - x * x * x) / 2);
  }
  return sum;
}

// Radiance over irradiance of a lobe under the disc: the mean over it, brightness included.
// Places count in radii along the plane of incidence and across it.
Long over_disc(const Lobe& lobe, const Dir& l, const Dir& v, Long radius, Long limb) {
  const Dir e2 = l.z < 0.999999L ? unit({-l.y, l.x, 0}) : Dir{0, 1, 0};
  const Dir e1{e2.y * l.z - e2.z * l.y, e2.z * l.x - e2.x * l.z, e2.x * l.y - e2.y * l.x};
  const Dir m{-v.x, -v.y, v.z};
  const Long c1 = dot(m, e1) / radius;
  const Long w1 = 2 * std::min(lobe.ax, lobe.ay) / radius;
  const auto light = [&](Long x, Long y) {
    return radius * x * e1 + radius * y * e2 + std::sqrt(1 - radius * radius * (x * x + y * y)) * l;
  };
  return panels(-1, 1, c1, w1, [&](Long x) {
           const Long h = std::sqrt(std::max(1 - x * x, Long(0)));
           // where the lobe is on this chord, and how wide: a parabola through three points
           const Long below = lobe.square(light(x, -h), v), middle = lobe.square(light(x, 0), v),
                      above = lobe.square(light(x, h), v);
           const Long bend = std::max((above + below) / 2 - middle, Long(1e-12)) / (h * h);
           const Long about = -(above - below) / (4 * h * bend);
           return panels(-h, h, about, 1 / std::sqrt(bend), [&](Long y) {
             const Long r2 = x * x + y * y;
             const Long height = std::sqrt(std::max(1 - r2, Long(0)));
             const Long cosine = std::sqrt(1 - radius * radius * r2);
             const Dir from = light(x, y);
             return (1 - limb * (1 - height)) / (1 - limb / 3) / cosine * lobe(from, v);
           });
         }) /
         kLongPi;
}

Material material_of(const Lobe& lobe) {
  Material m;
  m.diffuse = Vec3(0);
  m.specular = Vec3(1);
  m.weights = Vec3(0, 1, 0);
  if (lobe.index > 0) m.refract = Vec3(static_cast<double>(lobe.index));
  const auto ax = static_cast<double>(lobe.ax), ay = static_cast<double>(lobe.ay);
  switch (lobe.brdf) {
    case Brdf::cook_torrance:
      m.specular_brdf = CookTorrance{.alpha = ax};
      break;
    case Brdf::beckmann:
      m.specular_brdf = Beckmann{ax, ay};
      break;
    case Brdf::ggx:
      m.specular_brdf = Ggx{ax, ay};
      break;
    case Brdf::blinn_phong:
      m.specular_brdf = BlinnPhong{.shine = 2 / (ax * ax)};
      break;
  }
  fit(m);
  return m;
}

struct Residuals {
  double peak = 0;      // relative, at the specular direction
  double profile = 0;   // over the largest, ±1° about it
  double single = 0;    // f32 − f64 over the largest
};

// Views in the plane of incidence, across it and between.
constexpr double kPlaces_deg[][2] = {{0, 0},    {0.1, 0},   {-0.1, 0},  {0.25, 0}, {-0.25, 0},
                                     {0.6, 0},  {-0.6, 0},  {1, 0},     {-1, 0},   {0, 0.03},
                                     {0, 0.1},  {0, 0.2},   {0, 0.27},  {0, 0.4},  {0, 0.7},
                                     {0, 1},    {0.2, 0.2}, {-0.4, 0.3}};

// phi: azimuth of the plane of incidence against the tangent
Residuals residuals(const Lobe& lobe, Long theta, Long phi, Long au, Long limb) {
  const Material m = material_of(lobe);
  const Long radius = kRadius / au;
  const ShadingContext local{Vec3(1, 0, 0), kSunAlpha2 / static_cast<double>(au * au), std::nullopt,
                             static_cast<double>(limb)};
  const auto turned = [&](const Dir& d) {
    return Dir{d.x * std::cos(phi) - d.y * std::sin(phi), d.x * std::sin(phi) + d.y * std::cos(phi), d.z};
  };
  const Dir l = turned({-std::sin(theta), 0, std::cos(theta)});
  const Vec3 normal(0, 0, 1);
  std::vector<double> want, got, single;
  for (const auto& place : kPlaces_deg) {
    const Long in = theta + place[0] * kLongPi / 180, out = place[1] * kLongPi / 180;
    const Dir v = turned({std::sin(in) * std::cos(out), std::sin(out), std::cos(in) * std::cos(out)});
    want.push_back(static_cast<double>(over_disc(lobe, l, v, radius, limb)));
    const Vec3 white(1);
    got.push_back(f64::radiance(m, rounded(l), rounded(v), normal, white, white, local).x);
    single.push_back(static_cast<double>(f32::radiance(m, glm::vec3(rounded(l)), glm::vec3(rounded(v)),
                                                       glm::vec3(normal), glm::vec3(1), glm::vec3(1), local)
                                             .x));
  }
  Residuals r;
  double largest = 0;
  for (const double one : want) largest = std::max(largest, one);
  r.peak = std::fabs(got[0] / want[0] - 1);
  for (std::size_t i = 0; i < want.size(); ++i) {
    EXPECT_TRUE(std::isfinite(got[i]) && got[i] >= 0 && std::isfinite(single[i]) && single[i] >= 0);
    r.profile = std::max(r.profile, std::fabs(got[i] - want[i]) / largest);
    r.single = std::max(r.single, std::fabs(single[i] - got[i]) / largest);
  }
  return r;
}

constexpr Long kDegreeLong = kLongPi / 180;

struct Case {
  const char* name;
  Brdf brdf;
  Long index;
};
const Case kCases[] = {{"cook_torrance", Brdf::cook_torrance, 1.5L},
                       {"beckmann", Brdf::beckmann, 0},
                       {"ggx", Brdf::ggx, 1.5L},
                       {"blinn_phong", Brdf::blinn_phong, 0}};

TEST(SunDisc, FlatPlate) {
  for (const Case& each : kCases) {
    Residuals worst;
    for (const Long slope : {0.001L, 0.003L, 0.02L, 0.1L})
      for (const Long theta : {0.0L, 45.0L, 75.0L, 85.0L})
        for (const Long au : {0.3L, 1.0L, 5.0L}) {
          const Residuals r = residuals({each.brdf, slope, slope, each.index}, theta * kDegreeLong, 0.3L, au,
                                        au == 1 ? 0.6L : 0.0L);
          if (r.profile > 0.02)
            std::printf("  %s slope %g, %g deg, %g AU: %.1e %.1e %.1e\n", each.name, double(slope), double(theta),
                        double(au), r.peak, r.profile, r.single);
          worst.peak = std::max(worst.peak, r.peak);
          worst.profile = std::max(worst.profile, r.profile);
          worst.single = std::max(worst.single, r.single);
        }
    std::printf("%s: peak %.1e, profile %.1e, single precision %.1e\n", each.name, worst.peak, worst.profile,
                worst.single);
    EXPECT_LE(worst.peak, 0.02) << each.name;
    EXPECT_LE(worst.profile, 0.02) << each.name;
    EXPECT_LE(worst.single, 2e-3) << each.name;
  }
}

TEST(SunDisc, Anisotropic) {
  for (const Case& each : {kCases[1], kCases[2]}) {
    Residuals worst;
    for (const auto& [x, y] : {std::pair{0.001L, 0.01L}, std::pair{0.02L, 0.002L}, std::pair{0.1L, 0.01L}})
      for (const Long theta : {0.0L, 60.0L, 80.0L})
        for (const Long phi : {0.0L, 30.0L, 45.0L, 90.0L}) {
          const Residuals r = residuals({each.brdf, x, y, each.index}, theta * kDegreeLong, phi * kDegreeLong, 1, 0);
          if (r.profile > 0.02)
            std::printf("  %s slopes %g %g, %g deg, %g: %.1e %.1e %.1e\n", each.name, double(x), double(y),
                        double(theta), double(phi), r.peak, r.profile, r.single);
          worst.peak = std::max(worst.peak, r.peak);
          worst.profile = std::max(worst.profile, r.profile);
          worst.single = std::max(worst.single, r.single);
        }
    std::printf("%s: peak %.1e, profile %.1e, single precision %.1e\n", each.name, worst.peak, worst.profile,
                worst.single);
    EXPECT_LE(worst.peak, 0.02) << each.name;
    EXPECT_LE(worst.profile, 0.02) << each.name;
  }
}

// A mirror shows the disc as it is: brightness by the radius, 1 over the sphere, nothing outside.
TEST(SunDisc, Mirror) {
  Material m;
  m.diffuse = Vec3(0);
  m.specular = Vec3(1);
  m.weights = Vec3(0, 1, 0);
  m.specular_brdf = Mirror{};
  fit(m);
  for (const double theta : {0.0, 0.7, 1.48}) {
    const ShadingContext local{Vec3(0), kSunAlpha2, std::nullopt, 0.6};
    const double radius = static_cast<double>(kRadius);
    const Vec3 v(std::sin(theta), 0, std::cos(theta)), mirrored(-v.x, 0, v.z);
    const Vec3 x(v.z, 0, v.x), y(0, 1, 0);
    double sum = 0;
    constexpr int n = 400;
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < n; ++k) {
        const double a = 1.1 * (2 * (i + 0.5) / n - 1), b = 1.1 * (2 * (k + 0.5) / n - 1);
        const double r2 = a * a + b * b;
        const Vec3 l = radius * (a * x + b * y) + std::sqrt(1 - radius * radius * r2) * mirrored;
        const double got = f64::radiance(m, l, v, Vec3(0, 0, 1), Vec3(1), Vec3(1), local).x;
        sum += got * (2.2 / n) * (2.2 / n) * radius * radius;
        if (std::fabs(r2 - 1) < 1e-4) continue;
        const double want =
            r2 < 1 ? (1 - 0.6 * (1 - std::sqrt(1 - r2))) / (1 - 0.2) / (kPi * radius * radius) : 0;
        EXPECT_NEAR(got, want, 2e-2 * want + 1e-9) << theta << ' ' << a << ' ' << b;
      }
    EXPECT_NEAR(sum, 1, 2e-3);  // steps at the disc's edge
  }
}

}  // namespace
}  // namespace panwright::materials
