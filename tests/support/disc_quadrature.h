// Radiance of a flat plate under the Sun's disc: quadrature of the published BRDFs, in long double.
// Shares nothing with the formulas of materials.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

namespace panwright::disc_quadrature {

using Long = long double;
inline constexpr Long kLongPi = 3.14159265358979323846L;
inline constexpr Long kRadius = 4.6504e-3L;  // of the Sun at 1 AU

struct Dir {
  Long x, y, z;
};
inline Dir operator+(const Dir& a, const Dir& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Dir operator*(Long k, const Dir& a) { return {k * a.x, k * a.y, k * a.z}; }
inline Long dot(const Dir& a, const Dir& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Dir unit(const Dir& a) { return 1 / std::sqrt(dot(a, a)) * a; }

inline Long fresnel(Long cosine, Long n) {
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

inline const std::vector<std::array<Long, 2>>& gauss_nodes() {
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
inline Long panels(Long from, Long to, Long about, Long width, const std::function<Long(Long)>& f) {
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

// Returns the radiance over irradiance of a lobe under the disc: the mean over it, brightness
// included. Places are in radii along the plane of incidence and across it.
inline Long over_disc(const Lobe& lobe, const Dir& l, const Dir& v, Long radius, Long limb) {
  const Dir e2 = l.z < 0.999999L ? unit({-l.y, l.x, 0}) : Dir{0, 1, 0};
  const Dir e1{e2.y * l.z - e2.z * l.y, e2.z * l.x - e2.x * l.z, e2.x * l.y - e2.y * l.x};
  const Dir m{-v.x, -v.y, v.z};
  const Long c1 = dot(m, e1) / radius;
  const Long w1 = 2 * std::min(lobe.ax, lobe.ay) / radius;
  const auto light = [&](Long x, Long y) {
    return radius * x * e1 + radius * y * e2 + std::sqrt(1 - radius * radius * (x * x + y * y)) * l;
  };
  return panels(-1, 1, c1, w1,
                [&](Long x) {
                  const Long h = std::sqrt(std::max(1 - x * x, Long(0)));
                  // the lobe's place on this chord, and its width: a parabola through three points
                  const Long below = lobe.square(light(x, -h), v),
                             middle = lobe.square(light(x, 0), v),
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

}  // namespace panwright::disc_quadrature
