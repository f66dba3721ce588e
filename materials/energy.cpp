#include "materials/energy.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <span>

#include "materials/internal/fits.h"
#include "materials/internal/formulas.h"
#include "materials/sample.h"

namespace panwright::materials {
namespace {

struct Node {
  double x;  // 0..1
  double weight;
};

// Gauss and Legendre's nodes, by Newton's method on the polynomial.
template <int kOrder>
const std::array<Node, kOrder>& gauss() {
  static const std::array<Node, kOrder> nodes = [] {
    std::array<Node, kOrder> made{};
    for (int i = 0; i < kOrder; ++i) {
      double x = det::cos(kPi * (i + 0.75) / (kOrder + 0.5));
      double slope = 1;
      for (int iteration = 0; iteration < 8; ++iteration) {
        double p = 1, q = 0;
        for (int k = 0; k < kOrder; ++k) {
          const double r = q;
          q = p;
          p = ((2 * k + 1) * x * q - k * r) / (k + 1);
        }
        slope = kOrder * (x * p - q) / (x * x - 1);
        x -= p / slope;
      }
      made[static_cast<std::size_t>(i)] = {0.5 * (1 - x), 1 / ((1 - x * x) * slope * slope)};
    }
    return made;
  }();
  return nodes;
}

std::span<const Node> gauss(int order) {
  if (order <= 8) return gauss<8>();
  if (order <= 16) return gauss<16>();
  if (order <= 32) return gauss<32>();
  if (order <= 64) return gauss<64>();
  return gauss<128>();
}

// ---- over half vectors

// Slopes (x, y) = r (slope_x cosφ, slope_y sinφ), which spread lobes of any width evenly.
struct HalfSpace {
  double slope_x;
  double slope_y;
  bool thin_tail;  // exp(−r²); else 1/(1 + r²)², whose r is taken as sinh
};

// The r, at most `end`, to which v's reflections about h = (r x, r y, 1) keep above a cosine.
double end_above(const Vec3& h, const Vec3& v, double edge, double end) {
  const auto above = [&](double r) {
    const Vec3 at(r * h.x, r * h.y, 1);
    return 2 * glm::dot(v, at) >= (edge + v.z) * glm::dot(at, at);
  };
  if (above(end)) return end;
  double inside = 0;
  for (int i = 0; i < 50 && end - inside > 1e-12 * end; ++i) {
    const double middle = 0.5 * (inside + end);
    (above(middle) ? inside : end) = middle;
  }
  return end;
}

// Sums visit(h, weight) over half vectors h whose reflection of v is above +z (`lit`) or which v
// sees; weights are those of dω. Both domains end in r, for every φ, at the root of a polynomial,
// or where the reflection of a v above `edge` sinks to a cosine of `edge`.
template <class Visit>
void over_half_vectors(const HalfSpace& space, const Vec3& v, bool lit, double edge, int order,
                       Visit visit) {
  const std::span<const Node> nodes = gauss(order);
  const Vec2 stretched(v.x * space.slope_x, v.y * space.slope_y);
  const double size = std::sqrt(glm::dot(stretched, stretched));
  const Vec2 ahead = size > 0 ? stretched / size : Vec2(1, 0);
  const bool round = space.slope_x == space.slope_y;
  const double area = space.slope_x * space.slope_y;
  // the domain's end moves fastest where r grows perpendicular to v: nodes are densest there
  for (int quarter = 0; quarter < (round ? 2 : 4); ++quarter)
    for (const Node& a : nodes) {
      const double inner = 1 - a.x * a.x;
      const double angle = kPi / 2 * (quarter % 2 == 0 ? inner : 2 - inner);
      const double weight_a = kPi / 2 * 2 * a.x * a.weight * (round ? 2 : 1);
      const det::SinCos turn = det::sincos(quarter < 2 ? angle : -angle);
      const Vec2 out(ahead.x * turn.cos - ahead.y * turn.sin,
                     ahead.y * turn.cos + ahead.x * turn.sin);
      const Vec2 slopes(out.x * space.slope_x, out.y * space.slope_y);
      const double p = size * turn.cos;
      const double q = glm::dot(slopes, slopes);
      const double root = std::sqrt(p * p + v.z * v.z * q);
      // v.z q r² − 2 p r − v.z < 0, or p r + v.z > 0
      double end = p < 0 ? v.z / (lit ? root - p : -p) : lit ? (p + root) / (v.z * q) : 1e300;
      // what a thin tail holds beyond 6 is 1e-16, a thick one beyond 1e9 as little
      end = space.thin_tail ? std::min(end, 6.0) : std::min(end, 1e9);
      if (edge > 0) end = end_above(Vec3(slopes, 1), v, edge, end);
      if (!space.thin_tail) end = det::log(end + std::sqrt(end * end + 1));
      for (const Node& b : nodes) {
        double r = end * b.x;
        double weight = weight_a * end * b.weight;
        if (!space.thin_tail) {
          const double power = det::exp(r);
          r = 0.5 * (power - 1 / power);
          weight *= 0.5 * (power + 1 / power);
        }
        const double cosine = 1 / std::sqrt(1 + r * r * q);
        visit(Vec3(r * slopes.x, r * slopes.y, 1) * cosine,
              weight * area * r * cosine * cosine * cosine);
      }
    }
}

// ∫ f(l) cos_l dω over lights, f RGB or a number; h about +z, light and viewer as they are there.
// edge: f is 0 where the light's cosine is less, and v's is not; 0: none
template <class Value, class Lobe>
Value over_lights(const HalfSpace& space, const Vec3& v, int order, Lobe f, double edge = 0) {
  Value sum(0);
  over_half_vectors(space, v, true, edge, order, [&](const Vec3& h, double weight) {
    const double cos_vh = glm::dot(v, h);
    const Vec3 l = 2 * cos_vh * h - v;
    if (l.z > 0 && cos_vh > 0) sum += weight * 4 * cos_vh * l.z * f(l);
  });
  return sum;
}

const Vec3 kUp(0, 0, 1);
const Vec3 kTangent(1, 0, 0);

double lobe(const Microfacets& microfacets, const Vec3& l, const Vec3& v) {
  switch (microfacets.brdf) {
    case SpecularModel::beckmann:
      return f64::beckmann_smith(microfacets.slope_x, microfacets.slope_y, kTangent, l, v, kUp);
    case SpecularModel::ggx:
      return f64::ggx_smith(microfacets.slope_x, microfacets.slope_y, kTangent, l, v, kUp);
    default:
      return f64::cook_torrance(microfacets.slope_x, l, v, kUp);
  }
}

HalfSpace space_of(const Microfacets& microfacets) {
  const bool ggx = microfacets.brdf == SpecularModel::ggx;
  const double y =
      microfacets.brdf == SpecularModel::cook_torrance ? microfacets.slope_x : microfacets.slope_y;
  return {microfacets.slope_x, y, !ggx};
}

// ---- materials

// A light direction's share of ∫ … cosθ dω over the hemisphere; nodes are dense about the viewer,
// where opposition peaks, and at the horizon.
template <class F>
Vec3 over_hemisphere(const Vec3& v, int order, F f) {
  const std::span<const Node> nodes = gauss(order);
  const double theta_v = det::acos(std::min(v.z, 1.0));
  const double phi_v = det::atan2(v.y, v.x);
  Vec3 sum(0);
  for (int side = 0; side < 2; ++side)
    for (const Node& a : nodes) {
      const double width = side == 0 ? theta_v : kPi / 2 - theta_v;
      const double theta = side == 0 ? theta_v - width * a.x * a.x : theta_v + width * a.x * a.x;
      const double weight_a = width * 2 * a.x * a.weight;
      const det::SinCos polar = det::sincos(theta);
      for (const Node& b : nodes) {
        const double phi = phi_v + kPi * b.x * b.x;
        const det::SinCos turn = det::sincos(phi);
        const Vec3 l(polar.sin * turn.cos, polar.sin * turn.sin, polar.cos);
        if (!(l.z > 0)) continue;
        sum += weight_a * b.weight * 2 * kPi * 2 * b.x * polar.sin * polar.cos * f(l);
      }
    }
  return sum;
}

Microfacets microfacets_of(const Material& material) {
  const Vec2 alpha = slopes_of(material).value_or(Vec2(0.5));
  return {material.specular_model(), f64::microfacet_slope(alpha.x),
          f64::microfacet_slope(alpha.y)};
}

// The half vectors of a material's own lobe; of a mirror those that a rough coat lends it.
HalfSpace own_space(const Material& material, const f64::SurfaceFields& s) {
  if (const auto* phong = std::get_if<BlinnPhong>(&material.specular_brdf)) {
    const double slope = std::sqrt(2 / (phong->shine + 2));
    return {slope, slope, false};
  }
  if (material.specular_model() == SpecularModel::mirror) {
    const double slope = f64::microfacet_slope((s.coat_index - 1) * std::sqrt(0.5) * s.coat_alpha);
    return {slope, slope, true};
  }
  return space_of(microfacets_of(material));
}

// ∫ f(l) cos_l dω over lights about the viewer, in steps of equal shares of the lobe.
template <class F>
Vec3 over_retro_lobe(double concentration, const Vec3& v, int order, F f) {
  const std::span<const Node> nodes = gauss(order);
  const double all = f64::one_minus_exp(2 * concentration);
  Vec3 side = std::fabs(v.z) < 0.9 ? kUp : kTangent;
  side -= v * glm::dot(v, side);
  side /= std::sqrt(glm::dot(side, side));
  const Vec3 across = glm::cross(v, side);
  Vec3 sum(0);
  for (const Node& a : nodes) {
    const double apart = std::min(-det::log(1 - a.x * all) / concentration, 2.0);  // 1 − cosine
    const double sine = std::sqrt(std::max(apart * (2 - apart), 0.0));
    const double density = f64::retro_spread(concentration, 2 * apart);
    if (!(density > 0)) continue;
    for (int k = 0; k < order; ++k) {
      const det::SinCos turn = det::sincos(2 * kPi * (k + 0.5) / order);
      const Vec3 l = (1 - apart) * v + sine * (turn.cos * side + turn.sin * across);
      if (l.z > 0) sum += a.weight / order / density * l.z * f(l);
    }
  }
  return sum;
}

Vec3 microfacet_part(const Material& material, const f64::SurfaceFields& s,
                     f64::Composition composition, const Vec3& v, int order) {
  if (composition.brdf_model.specular == SpecularModel::retroreflector) {
    const double wider = s.coat_index * s.coat_index;
    return over_retro_lobe(
        f64::retro_concentration(s, {}, 0) / wider, v, order, [&](const Vec3& l) {
          return composition.brdf_model.coated
                     ? composition.coated_microfacets(s, f64::from_point(l), v, kUp)
                     : s.weights.y * composition.mirrored(s, f64::from_point(l), v, kUp, 1.0);
        });
  }
  const HalfSpace space = own_space(material, s);
  if (!composition.brdf_model.coated)
    return over_lights<Vec3>(space, v, order, [&](const Vec3& l) {
      return s.weights.y * composition.mirrored(s, f64::from_point(l), v, kUp, 1.0);
    });
  const bool mirror = material.specular_model() == SpecularModel::mirror;
  const double n = mirror ? 1 : s.coat_index;
  const Vec3 tilted = f64::tilted_normal(s, kUp, 1 / n);
  // a frame about the tilted normal
  Vec3 x = kTangent - tilted * tilted.x;
  x /= std::sqrt(glm::dot(x, x));
  const Mat3 world(x, glm::cross(tilted, x), tilted);
  const Vec3 inside = mirror ? v : f64::under_coat(v, kUp, n);
  const Vec3 seen = glm::transpose(world) * inside;
  if (!(seen.z > 0)) return Vec3(0);
  // what is refracted out of the coat; tilted microfacets see that edge askew
  const bool level = tilted == kUp;
  const double edge = level && n > 1 ? std::sqrt((1 - 1 / n) * (1 + 1 / n)) : 0;
  const auto seen_as = [&](const Vec3& local) {
    const Vec3 l = world * local;
    if (!(l.z > 0)) return Vec3(0);
    // over_lights counts cosines to the tilted normal
    const double cosines = l.z / local.z;
    if (mirror) {
      const double lobe = f64::tilted_share(tilted, l, v, kUp) *
                          f64::mirror_lobe(s, l, f64::from_point(l), v, kUp, tilted, 0);
      return cosines * lobe * composition.coated_reflection(s, f64::half_cosine(l, v), l.z, v.z);
    }
    const Vec3 aside(n * l.x, n * l.y, 0);
    const double sin2 = glm::dot(aside, aside);
    if (!(sin2 < 1)) return Vec3(0);
    // cosθ dω outside is n² times that inside
    return cosines * n * n *
           composition.coated_microfacets(
               s, f64::from_point(aside + Vec3(0, 0, std::sqrt(1 - sin2))), v, kUp);
  };
  return over_lights<Vec3>(space, seen, order, seen_as, edge);
}

// reflectance: what a map says, where there is one
Vec3 albedo(const Material& material, const Vec3& v, int order,
            const std::optional<Vec3>& reflectance = {}) {
  f64::SurfaceFields s = f64::surface_of(material, kTangent);
  if (reflectance) s.reflectance = *reflectance;
  const f64::Composition all = f64::composition_of(material);
  f64::Composition smooth = all;
  smooth.brdf_model.specular = SpecularModel::none;
  f64::Composition once = all;
  once.brdf_model.compensated = false;
  Vec3 sum = over_hemisphere(v, std::min(order, 64), [&](const Vec3& l) {
    if (!all.brdf_model.coated) return smooth.bare(s, f64::from_point(l), v, kUp);
    Vec3 f = smooth.coated_diffuse(s, l, v, kUp);
    if (all.brdf_model.compensated) f += smooth.coated_compensation(s, l, v, kUp);
    return f;
  });
  if (all.brdf_model.coated || all.brdf_model.specular == SpecularModel::mirror) {
    const Mirrors mirrors =
        Scattering(material).reflecting(s.reflectance).mirrors(v, kUp, kTangent);
    for (int i = 0; i < mirrors.count; ++i)
      sum += mirrors.all[static_cast<std::size_t>(i)].reflectance;
  }
  const bool peak = all.brdf_model.coated && s.coat_alpha > 0;
  if (peak) sum += coat_peak_albedo(*material.coat, v, order);
  const bool blurred = peak && s.coat_index > 1;
  if (all.brdf_model.specular == SpecularModel::none ||
      (all.brdf_model.specular == SpecularModel::mirror && !blurred))
    return sum;
  return sum + microfacet_part(material, s, once, v, order);
}

Vec3 direction(double mu, double azimuth) {
  const double sine = std::sqrt(std::max((1 - mu) * (1 + mu), 0.0));
  const det::SinCos turn = det::sincos(azimuth);
  return {sine * turn.cos, sine * turn.sin, mu};
}

constexpr std::array kAzimuths{0.0, 0.25 * kPi, 0.5 * kPi, 0.75 * kPi};

// The largest directional albedo at some cosines, of any azimuth.
Gain largest_albedo(const Material& material, std::span<const double> mus, int order) {
  const std::size_t azimuths = !is_anisotropic(material) ? 1 : kAzimuths.size();
  Gain gain;
  for (const double mu : mus)
    for (std::size_t i = 0; i < azimuths; ++i) {
      const double found =
          max_component(albedo(material, direction(mu, kAzimuths[i]), order, Vec3(1)));
      if (found > gain.albedo) gain = {found, mu};
    }
  return gain;
}

}  // namespace

Vec3 mean_over_cosines(const std::function<Vec3(double)>& f) {
  Vec3 sum(0);
  for (const Node& a : gauss(32)) sum += a.weight * 2 * a.x * f(a.x * a.x);
  return sum;
}

Vec3 mean_diffuse_albedo(const Material& material) {
  if (material.diffuse_model() == DiffuseModel::lambert) return material.diffuse;
  const f64::SurfaceFields s = f64::surface_of(material);
  const f64::Composition composition = f64::composition_of(material);
  Vec3 sum(0);
  for (const Node& a : gauss(16)) {
    const double mu = a.x * a.x;
    const Vec3 v = direction(mu, 0);
    sum += a.weight * 4 * a.x * mu *
           over_hemisphere(v, 16, [&](const Vec3& l) { return composition.diffuse(s, l, v, kUp); });
  }
  return sum;
}

double coat_peak_albedo(const Coat& coat, const Vec3& to_viewer, int nodes) {
  Material material;
  material.coat = coat;
  const f64::SurfaceFields s = f64::surface_of(material);
  const double slope = f64::microfacet_slope(coat.alpha);
  return over_lights<double>({slope, slope, true}, to_viewer, nodes, [&](const Vec3& l) {
    return f64::coat_peak(s, f64::from_point(l), to_viewer, kUp);
  });
}

double coated_microfacets_albedo(const Material& material, const Vec3& to_viewer, int nodes) {
  return microfacet_part(material, f64::surface_of(material, kTangent),
                         f64::composition_of(material), to_viewer, nodes)
      .x;
}

double microfacet_albedo(const Microfacets& microfacets, const Vec3& to_viewer, int nodes) {
  assert(to_viewer.z > 0);
  return over_lights<double>(space_of(microfacets), to_viewer, nodes,
                             [&](const Vec3& l) { return lobe(microfacets, l, to_viewer); });
}

double microfacet_mean_albedo(const Microfacets& microfacets, int nodes) {
  const bool round = space_of(microfacets).slope_x == space_of(microfacets).slope_y;
  double sum = 0;
  for (const Node& a : gauss(32)) {
    // μ = x²: losses are smooth in √μ
    const double mu = a.x * a.x;
    double mean = 0;
    const int azimuths = round ? 1 : 8;
    for (int i = 0; i < azimuths; ++i)
      mean += microfacet_albedo(microfacets, direction(mu, kPi / 2 * (i + 0.5) / azimuths), nodes) /
              azimuths;
    sum += a.weight * 4 * a.x * mu * mean;
  }
  return sum;
}

double weak_furnace(const Microfacets& microfacets, const Vec3& v, int nodes) {
  const double x = microfacets.slope_x;
  const double y = space_of(microfacets).slope_y;
  const auto sine = [&](const Vec3& d) { return f64::sloped_sine(x, y, kTangent, d, kUp); };
  double sum = 0;
  over_half_vectors(space_of(microfacets), v, false, 0, nodes, [&](const Vec3& h, double weight) {
    const double cos_vh = std::max(glm::dot(v, h), 0.0);
    double g1 = 0;
    double d = 0;
    // D from a lobe whose half vector is its light and viewer
    switch (microfacets.brdf) {
      case SpecularModel::beckmann:
        g1 = v.z / (v.z + f64::beckmann_masking(v.z, sine(v)));
        d = lobe(microfacets, h, h) * 4 * h.z * (h.z + 2 * f64::beckmann_masking(h.z, sine(h)));
        break;
      case SpecularModel::ggx:
        g1 = 2 * v.z / (v.z + std::sqrt(v.z * v.z + sine(v) * sine(v)));
        d = lobe(microfacets, h, h) * 4 * h.z * std::sqrt(h.z * h.z + sine(h) * sine(h));
        break;
      default:
        g1 = cos_vh > 0 ? std::min(1.0, 2 * h.z * v.z / cos_vh) : 1;
        d = f64::beckmann((h.x * h.x + h.y * h.y) / (h.z * h.z), x);
    }
    sum += weight * d * g1 * cos_vh / v.z;
  });
  return sum;
}

Vec3 directional_albedo(const Material& material, double mu, double azimuth,
                        const std::optional<Vec3>& reflectance, int nodes) {
  assert(mu > 0 && mu <= 1);
  return albedo(material, direction(mu, azimuth), nodes, reflectance);
}

Vec3 hemispherical_albedo(const Material& material) {
  const std::size_t azimuths = !is_anisotropic(material) ? 1 : kAzimuths.size();
  Vec3 sum(0);
  for (const Node& a : gauss(16)) {
    const double mu = a.x * a.x;
    for (std::size_t i = 0; i < azimuths; ++i)
      sum += a.weight * 4 * a.x * mu / static_cast<double>(azimuths) *
             albedo(material, direction(mu, kAzimuths[i]), 32);
  }
  return sum;
}

Gain energy_gain(const Material& material) {
  constexpr double kMus[] = {0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.85, 0.95, 1.0};
  return largest_albedo(material, kMus, 64);
}

std::optional<Gain> gain_above(const Material& material, double tolerance) {
  constexpr double kFewMus[] = {0.01, 0.1, 0.5, 1.0};
  if (largest_albedo(material, kFewMus, 8).albedo < 0.8) return std::nullopt;
  const Gain gain = energy_gain(material);
  if (!(gain.albedo > 1 + tolerance)) return std::nullopt;
  return gain;
}

double reciprocity_residual(const Material& material) {
  const Scattering scattering(material);
  double worst = 0;
  const std::array cosines{1e-4, 0.01, 0.1, 0.5, 0.9, 1 - 1e-7, 1.0};
  for (const double a : cosines)
    for (const double b : cosines)
      for (const double turn : {0.0, 1e-6, 0.25 * kPi, 0.5 * kPi, kPi - 1e-6}) {
        const Vec3 l = direction(a, 0.3 + turn);
        const Vec3 v = direction(b, 0.3);
        const Vec3 there = scattering.brdf(l, v, kUp, kTangent, Vec3(1));
        const Vec3 back = scattering.brdf(v, l, kUp, kTangent, Vec3(1));
        for (int k = 0; k < 3; ++k)
          worst = std::max(worst, std::fabs(there[k] - back[k]) / std::max(there[k], 1e-30));
      }
  return worst;
}

}  // namespace panwright::materials
