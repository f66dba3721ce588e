#include "materials/sample.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "materials/internal/fits.h"
#include "materials/internal/formulas.h"
#include "materials/internal/hapke_lanes.h"

namespace panwright::materials {
namespace {

// share of the microfacets in choosing a direction where a reflectance map leaves less
constexpr double kLeastMapped = 0.04;

// A frame about a normal; x along the tangent where there is one.
struct Frame {
  Vec3 x, y, z;

  Frame(const Vec3& normal, const Vec3& tangent) : z(normal) {
    Vec3 along = tangent - normal * glm::dot(normal, tangent);
    if (!(glm::dot(along, along) > 0.25)) {
      const Vec3 axis = std::fabs(normal.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
      along = axis - normal * glm::dot(normal, axis);
    }
    x = along / std::sqrt(glm::dot(along, along));
    y = glm::cross(z, x);
  }
  Vec3 local(const Vec3& v) const { return {glm::dot(v, x), glm::dot(v, y), glm::dot(v, z)}; }
  Vec3 world(const Vec3& v) const { return v.x * x + v.y * y + v.z * z; }
};

Vec3 unit(const Vec3& v) { return v / std::max(std::sqrt(glm::dot(v, v)), 1e-300); }

// Half vectors of a lobe, about +z.
struct HalfVectors {
  SpecularModel brdf = SpecularModel::none;
  double slope_x = 1;
  double slope_y = 1;
  double shine = 0;

  Vec3 sample(const Vec3& v, const Vec2& u) const {
    const auto [sin_phi, cos_phi] = det::sincos(2 * kPi * u.x);
    if (brdf == SpecularModel::ggx) {
      // directions of a cap of the unit sphere, whose half vectors are the visible normals
      const Vec3 stretched = unit({slope_x * v.x, slope_y * v.y, v.z});
      const double z = (1 - u.y) * (1 + stretched.z) - stretched.z;
      const double r = std::sqrt(std::clamp(1 - z * z, 0.0, 1.0));
      const Vec3 h = Vec3(r * cos_phi, r * sin_phi, z) + stretched;
      return unit({slope_x * h.x, slope_y * h.y, std::max(h.z, 0.0)});
    }
    if (brdf == SpecularModel::blinn_phong) {
      const double cosine = det::exp(det::log(1 - u.y) / (shine + 2));
      const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
      return {sine * cos_phi, sine * sin_phi, cosine};
    }
    const double tangent = std::sqrt(-det::log(1 - u.y));
    return unit({slope_x * tangent * cos_phi, slope_y * tangent * sin_phi, 1});
  }

  // Density of light directions l, 1/sr, whose half vector with v was sampled.
  double pdf(const Vec3& l, const Vec3& v) const {
    const Vec3 h = l + v;
    const double length = std::sqrt(glm::dot(h, h));
    if (!(h.z > 0 && length > 1e-6 && v.z > 0)) return 0;
    const double cosine = h.z / length;
    const double cos_vh = 0.5 * length;
    if (brdf == SpecularModel::blinn_phong)
      return (shine + 2) / (8 * kPi * cos_vh) * det::exp((shine + 1) * det::log(cosine));
    const double x = h.x / (slope_x * h.z);
    const double y = h.y / (slope_y * h.z);
    const double spread = x * x + y * y;
    const double area = kPi * slope_x * slope_y;
    if (brdf == SpecularModel::ggx) {
      const double ratio = 1 / (cosine * cosine * (1 + spread));
      const double sx = slope_x * v.x;
      const double sy = slope_y * v.y;
      return ratio * ratio / area / (2 * (v.z + std::sqrt(v.z * v.z + sx * sx + sy * sy)));
    }
    return f64::exp_negative(spread) / (area * cosine * cosine * cosine * 4 * cos_vh);
  }
};

// Directions about the viewer, as retroreflectors return light: von Mises and Fisher's.
struct RetroLobe {
  double concentration = 1;

  Vec3 sample(const Vec3& v, const Vec2& u) const {
    const double all = f64::one_minus_exp(2 * concentration);
    const double apart = std::min(-det::log(1 - u.y * all) / concentration, 2.0);  // 1 − cosine
    const double sine = std::sqrt(std::max(apart * (2 - apart), 0.0));
    const auto [sin_phi, cos_phi] = det::sincos(2 * kPi * u.x);
    return Frame(v, Vec3(0)).world({sine * cos_phi, sine * sin_phi, 1 - apart});
  }
  double pdf(const Vec3& l, const Vec3& v) const {
    return f64::retro_spread(concentration, glm::dot(l - v, l - v));
  }
};

// Probabilities of the strategies of sample(); they add up to 1 (to 0 on a black surface).
struct Chances {
  double diffuse = 0;
  double microfacets = 0;
  double peak = 0;  // a rough coat
  double mirror_peak = 0;
  double mirror_below = 0;
};

Vec3 above_horizon(const Vec3& to_viewer, const Vec3& normal) {
  const double cosine = glm::dot(normal, to_viewer);
  return cosine < 1e-6 ? unit(to_viewer + normal * (1e-6 - cosine)) : to_viewer;
}

}  // namespace

struct Scattering::Parts {
  f64::SurfaceFields surface;
  f64::Composition composition;
  double lost = 0;  // see mean_albedo_deficit()
  std::shared_ptr<const HapkeHCorrection> exact_h;

  explicit Parts(const Material& material)
      : surface(f64::surface_of(material)), composition(f64::composition_of(material)) {
    if (composition.brdf_model.compensated) lost = mean_albedo_deficit(material);
    if (composition.brdf_model.diffuse != DiffuseModel::hapke) return;
    exact_h = std::make_shared<const HapkeHCorrection>(std::get<Hapke>(material.diffuse_brdf).w,
                                                       material.fits.hapke_h);
    surface.exact_h = exact_h.get();
  }

  f64::SurfaceFields at(const Vec3& tangent, const Vec3& tint) const {
    f64::SurfaceFields s = surface;
    s.tangent = tangent;
    s.diffuse = s.diffuse * tint;
    return s;
  }

  bool coated() const { return composition.brdf_model.coated; }
  bool mirror() const { return composition.brdf_model.specular == SpecularModel::mirror; }
  bool smooth_coat() const { return coated() && !(surface.coat_alpha > 0); }
  // a rough coat blurs a mirror below
  bool mirror_shows() const {
    return mirror() && (!coated() || smooth_coat() || surface.coat_index == 1);
  }

  double first(double cosine) const {
    return coated() ? surface.coat_share * f64::fresnel_dielectric(cosine, surface.coat_index) : 0;
  }
  // tilted: the cosine of both directions to the mirror's normal
  Vec3 mirror_below(double tilted, double cos_nl, double cos_nv) const {
    if (!mirror_shows()) return Vec3(0);
    if (coated())
      return f64::Composition(composition).coated_reflection(surface, tilted, cos_nl, cos_nv);
    return surface.weights.y * surface.specular * composition.fresnel(surface, tilted, 1.0);
  }
  Vec3 mirror_below(double cosine) const { return mirror_below(cosine, cosine, cosine); }

  bool retro() const { return composition.brdf_model.specular == SpecularModel::retroreflector; }
  // through a coat the lobe is wider by its index
  RetroLobe retro_lobe(const f64::SurfaceFields& s) const {
    return {f64::retro_concentration(s, {}, 0) / (s.coat_index * s.coat_index)};
  }

  HalfVectors peak() const {
    const double slope = f64::microfacet_slope(surface.coat_alpha);
    return {SpecularModel::beckmann, slope, slope, 0};
  }

  HalfVectors microfacets(const f64::SurfaceFields& s) const {
    if (mirror()) {
      const double bent = (s.coat_index - 1) * std::sqrt(0.5) * s.coat_alpha;
      const double slope = f64::microfacet_slope(bent);
      return {SpecularModel::beckmann, slope, slope, 0};
    }
    double x = f64::microfacet_slope(s.alpha_x);
    double y = f64::microfacet_slope(s.alpha_y);
    const SpecularModel brdf = composition.brdf_model.specular;
    if (brdf == SpecularModel::cook_torrance) y = x;
    if (f64::isotropic(x, y, s.tangent) > 0) x = y = std::sqrt(x * y);
    return {brdf, x, y, s.shine};
  }

  Chances chances(const f64::SurfaceFields& s, double cosine) const {
    Chances c;
    const double passing = 1 - first(cosine);
    const SpecularModel brdf = composition.brdf_model.specular;
    const double inner = coated() ? f64::refracted_cosine(cosine, s.coat_index) : cosine;
    c.diffuse = passing * s.weights.x * max_component(s.diffuse);
    if (composition.brdf_model.compensated)
      c.diffuse += (smooth_coat() ? passing : 1) * s.weights.y *
                   max_component(s.specular * s.compensation_scale) * kPi * lost *
                   f64::microfacet_albedo_deficit(s, cosine);
    if (mirror_shows()) {
      c.mirror_below = max_component(mirror_below(cosine));
    } else if (brdf != SpecularModel::none) {
      Vec3 fresnel = composition.fresnel(s, inner, coated() ? s.coat_index : 1.0);
      // where a map says 0, microfacets still reflect towards grazing
      if (composition.brdf_model.mapped) fresnel = glm::max(fresnel, Vec3(kLeastMapped));
      c.microfacets = passing * s.weights.y * max_component(s.specular * fresnel);
    }
    (smooth_coat() ? c.mirror_peak : c.peak) = first(cosine);
    // every part gets at least 1/20
    double* const all[] = {&c.diffuse, &c.microfacets, &c.peak, &c.mirror_peak, &c.mirror_below};
    double sum = 0;
    for (const double* one : all) sum += *one;
    if (!(sum > 1e-30)) return {};
    double total = 0;
    for (double* one : all) {
      if (*one > 0) *one = std::max(*one / sum, 0.05);
      total += *one;
    }
    for (double* one : all) *one /= total;
    return c;
  }

  // Directions below the coat, and the normal that microfacets have there.
  struct Below {
    Vec3 normal;
    Vec3 to_viewer;
    bool refracted;
  };
  Below below(const f64::SurfaceFields& s, const Vec3& to_viewer, const Vec3& normal) const {
    if (!coated()) return {normal, to_viewer, false};
    if (mirror()) return {f64::tilted_normal(s, normal, 1.0), to_viewer, false};
    return {f64::tilted_normal(s, normal, 1 / s.coat_index),
            f64::under_coat(to_viewer, normal, s.coat_index), true};
  }

  double pdf(const f64::SurfaceFields& s, const Chances& c, const Vec3& to_light,
             const Vec3& to_viewer, const Vec3& normal) const {
    const double cosine = glm::dot(normal, to_light);
    if (!(cosine > 0)) return 0;
    double density = c.diffuse * cosine / kPi;
    if (c.microfacets > 0 && retro()) {
      density += c.microfacets * retro_lobe(s).pdf(to_light, to_viewer);
    } else if (c.microfacets > 0) {
      const Below in = below(s, to_viewer, normal);
      const Frame frame(in.normal, s.tangent);
      const Vec3 l = in.refracted ? f64::under_coat(to_light, normal, s.coat_index) : to_light;
      const double shrunk =
          in.refracted ? cosine / (s.coat_index * s.coat_index * glm::dot(normal, l)) : 1;
      density +=
          c.microfacets * shrunk * microfacets(s).pdf(frame.local(l), frame.local(in.to_viewer));
    }
    if (c.peak > 0) {
      const Frame frame(normal, s.tangent);
      density += c.peak * peak().pdf(frame.local(to_light), frame.local(to_viewer));
    }
    return density;
  }

  // The direction that half vectors about a normal lead to; 0: none.
  static Vec3 drawn(const HalfVectors& halves, const Frame& frame, const Vec3& to_viewer,
                    const Vec2& u) {
    const Vec3 v = frame.local(to_viewer);
    if (!(v.z > 0)) return Vec3(0);
    const Vec3 h = halves.sample(v, u);
    const double cos_vh = glm::dot(v, h);
    if (!(cos_vh > 0)) return Vec3(0);
    return frame.world(2 * cos_vh * h - v);
  }

  Vec3 drawn_by_microfacets(const f64::SurfaceFields& s, const Vec3& to_viewer, const Vec3& normal,
                            const Vec2& u) const {
    if (retro()) return retro_lobe(s).sample(to_viewer, u);
    const Below in = below(s, to_viewer, normal);
    const Vec3 l = drawn(microfacets(s), Frame(in.normal, s.tangent), in.to_viewer, u);
    if (!in.refracted || !(glm::dot(normal, l) > 0)) return l;
    // out of the coat
    const Vec3 aside = s.coat_index * (l - normal * glm::dot(normal, l));
    const double sin2 = glm::dot(aside, aside);
    if (!(sin2 < 1)) return Vec3(0);
    return aside + normal * std::sqrt(1 - sin2);
  }
};

Scattering::Scattering(const Material& material) : parts_(std::make_unique<Parts>(material)) {}
Scattering::Scattering(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Scattering::~Scattering() = default;
Scattering::Scattering(const Scattering& other) : parts_(std::make_unique<Parts>(*other.parts_)) {}
Scattering& Scattering::operator=(const Scattering& other) {
  *parts_ = *other.parts_;
  return *this;
}
Scattering::Scattering(Scattering&&) noexcept = default;
Scattering& Scattering::operator=(Scattering&&) noexcept = default;

Scattering Scattering::scaled(double roughness) const {
  auto parts = std::make_unique<Parts>(*parts_);
  parts->surface.alpha_x *= roughness;
  parts->surface.alpha_y *= roughness;
  parts->surface.oren *= roughness;
  return Scattering(std::move(parts));
}

Scattering Scattering::reflecting(const Vec3& reflectance) const {
  auto parts = std::make_unique<Parts>(*parts_);
  parts->surface.reflectance = reflectance;
  return Scattering(std::move(parts));
}

Vec3 Scattering::brdf(const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal,
                      const Vec3& tangent, const Vec3& tint) const {
  f64::Composition composition = parts_->composition;
  return composition.surface_brdf(parts_->at(tangent, tint), f64::from_point(to_light), to_viewer,
                                  normal);
}

void Scattering::brdf(std::span<const Directions> at, std::span<Vec3> out) const {
  assert(at.size() == out.size());
  const BrdfModel& model = parts_->composition.brdf_model;
  if (model.diffuse != DiffuseModel::hapke || model.specular != SpecularModel::none ||
      model.coated) {
    for (std::size_t i = 0; i < at.size(); ++i)
      out[i] = brdf(at[i].to_light, at[i].to_viewer, at[i].normal, Vec3(0), at[i].tint);
    return;
  }
  const f64::SurfaceFields& s = parts_->surface;
  static thread_local HapkeLanes lanes;
  constexpr std::size_t kCount = HapkeLanes::kCount;
  for (std::size_t first = 0; first < at.size(); first += kCount) {
    const std::size_t count = std::min(kCount, at.size() - first);
    for (std::size_t i = 0; i < kCount; ++i) {
      // those past the end are the last one's
      const Directions& from = at[first + std::min(i, count - 1)];
      // as surface_brdf()
      Vec3 to_viewer = from.to_viewer;
      const double cos_nv = f64::dot3(from.normal, to_viewer);
      if (cos_nv < 1e-6) {
        to_viewer += from.normal * (1e-6 - cos_nv);
        to_viewer = to_viewer / std::max(f64::length3(to_viewer), 1e-6);
      }
      for (int k = 0; k < 3; ++k) {
        lanes.to_light[k][i] = from.to_light[k];
        lanes.to_viewer[k][i] = to_viewer[k];
        lanes.normal[k][i] = from.normal[k];
      }
    }
    hapke(s, lanes);
    for (std::size_t i = 0; i < count; ++i)
      out[first + i] = s.weights.x * (s.diffuse * at[first + i].tint * lanes.value[i]);
  }
}

double Scattering::pdf(const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal,
                       const Vec3& tangent, const Vec3& tint) const {
  const f64::SurfaceFields s = parts_->at(tangent, tint);
  const Vec3 v = above_horizon(to_viewer, normal);
  return parts_->pdf(s, parts_->chances(s, glm::dot(normal, v)), to_light, v, normal);
}

std::optional<Sampled> Scattering::sample(const Vec3& to_viewer, const Vec3& normal,
                                          const Vec3& tangent, const Vec3& tint, const Vec2& u,
                                          double u_lobe) const {
  const f64::SurfaceFields s = parts_->at(tangent, tint);
  const Vec3 v = above_horizon(to_viewer, normal);
  const Chances c = parts_->chances(s, glm::dot(normal, v));
  Sampled sampled;
  const auto mirrored = [&](int index, double chance) -> std::optional<Sampled> {
    const Mirrors all = mirrors(v, normal, tangent);
    if (index >= all.count) return std::nullopt;
    const Mirrored& one = all.all[static_cast<std::size_t>(index)];
    return Sampled{one.to_light, one.reflectance / chance, 0, true};
  };
  double left = u_lobe;
  const auto is = [&](double chance) {
    const bool taken = chance > 0 && left < chance;
    left -= chance;
    return taken;
  };
  if (is(c.mirror_peak)) return mirrored(0, c.mirror_peak);
  if (is(c.mirror_below)) return mirrored(parts_->smooth_coat() ? 1 : 0, c.mirror_below);
  if (is(c.microfacets)) {
    sampled.to_light = parts_->drawn_by_microfacets(s, v, normal, u);
  } else if (is(c.peak)) {
    sampled.to_light = Parts::drawn(parts_->peak(), Frame(normal, s.tangent), v, u);
  } else {
    const auto [sin_phi, cos_phi] = det::sincos(2 * kPi * u.x);
    const double r = std::sqrt(u.y);
    sampled.to_light = Frame(normal, s.tangent)
                           .world({r * cos_phi, r * sin_phi, std::sqrt(std::max(1 - u.y, 0.0))});
  }
  const double cosine = glm::dot(normal, sampled.to_light);
  if (!(cosine > 0)) return std::nullopt;
  sampled.pdf = parts_->pdf(s, c, sampled.to_light, v, normal);
  if (!(sampled.pdf > 1e-300)) return std::nullopt;
  f64::Composition composition = parts_->composition;
  sampled.weight = composition.surface_brdf(s, f64::from_point(sampled.to_light), v, normal) *
                   (cosine / sampled.pdf);
  return sampled;
}

Mirrors Scattering::mirrors(const Vec3& to_viewer, const Vec3& normal, const Vec3& tangent) const {
  Mirrors found;
  const Vec3 v = above_horizon(to_viewer, normal);
  const double cosine = glm::dot(normal, v);
  const auto add = [&](const Vec3& to_light, const Vec3& reflectance) {
    found.all[static_cast<std::size_t>(found.count++)] = {to_light, reflectance};
  };
  const Vec3 straight = 2 * cosine * normal - v;
  if (parts_->smooth_coat()) add(straight, Vec3(parts_->first(cosine)));
  if (!parts_->mirror_shows()) return found;
  if (!parts_->coated()) {
    add(straight, parts_->mirror_below(cosine));
    return found;
  }
  f64::SurfaceFields s = parts_->surface;
  s.tangent = tangent;
  const Vec3 tilted = f64::tilted_normal(s, normal, 1.0);
  const double cos_tilted = glm::dot(tilted, v);
  const Vec3 l = 2 * cos_tilted * tilted - v;
  const double cos_nl = glm::dot(normal, l);
  if (!(cos_tilted > 0 && cos_nl > 0)) {
    add(straight, Vec3(0));
    return found;
  }
  add(l, parts_->mirror_below(cos_tilted, cos_nl, cosine) *
             (f64::tilted_share(tilted, l, v, normal) * cos_nl / cos_tilted));
  return found;
}

DiscLobes Scattering::disc_lobes(const Vec3& to_sun, double radius, const Vec3& to_viewer,
                                 const Vec3& normal, const Vec3& tangent) const {
  const f64::SurfaceFields s = parts_->at(tangent, Vec3(1));
  const Vec3 v = above_horizon(to_viewer, normal);
  const Chances c = parts_->chances(s, glm::dot(normal, v));
  DiscLobes found;
  const f64::IncidenceFields light{to_sun, Vec3(1), radius * radius / 8, 0};
  const auto add = [&](const HalfVectors& halves, const Vec3& tilted, double index) {
    const bool phong = halves.brdf == SpecularModel::blinn_phong;
    const double x = phong ? f64::blinn_phong_slope(halves.shine) : halves.slope_x;
    const double y = phong ? x : halves.slope_y;
    const Vec3 over_x = f64::over_slope_x(x, y, s.tangent, tilted);
    const Vec3 over_y = f64::over_slope_y(x, y, s.tangent, tilted);
    const Vec3 from =
        f64::lit_from(0, light, std::min(x, y), over_x, over_y, v, normal, tilted, index);
    const Vec3 inside = f64::below_index(from, normal, index);
    const Vec3 both = inside + f64::below_index(v, normal, index);
    const double cos_sum = glm::dot(tilted, both);
    if (!(cos_sum > 1e-6)) return;
    const Vec3 slopes(glm::dot(over_x, both) / cos_sum, glm::dot(over_y, both) / cos_sum, 0);
    const Vec3 axis_x = f64::disc_x(to_sun), axis_y = f64::disc_y(to_sun);
    const auto step = [&](const Vec3& axis) {
      return f64::slope_step(f64::light_step(axis, radius, to_sun, from, inside, normal, index),
                             slopes, over_x, over_y, tilted, cos_sum);
    };
    const Vec3 step_x = step(axis_x), step_y = step(axis_y);
    const double determinant = f64::slope_determinant(step_x, step_y);
    const Vec3 place(glm::dot(from, axis_x) / radius, glm::dot(from, axis_y) / radius, 0);
    const Vec3 peak = f64::place_of_peak(place, slopes, step_x, step_y, determinant);
    const Vec3 axis = f64::narrow_axis(f64::slope_form(step_x, step_y));
    const double narrow = 1 / std::sqrt(std::max(axis.z, 1e-30));
    found.all[static_cast<std::size_t>(found.count++)] = {Vec2(peak), Vec2(axis), narrow,
                                                          1 / (narrow * std::fabs(determinant))};
  };
  const Parts::Below in = parts_->below(s, v, normal);
  if (c.microfacets > 0 && !parts_->retro()) {
    const HalfVectors halves = parts_->microfacets(s);
    // the wide tails of GGX are even over the disc
    if (halves.brdf != SpecularModel::ggx) add(halves, in.normal, in.refracted ? s.coat_index : 0);
  }
  if (c.peak > 0) add(parts_->peak(), normal, 0);
  return found;
}

Vec3 Scattering::mirror_reflectance(double cosine) const {
  Vec3 sum = parts_->mirror_below(cosine);
  if (parts_->smooth_coat()) sum += parts_->first(cosine);
  return sum;
}

bool Scattering::has_delta() const { return parts_->smooth_coat() || parts_->mirror_shows(); }

}  // namespace panwright::materials
