#include "materials/material.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "base/text.h"
#include "image/srgb.h"
#include "materials/kept_fits.h"

namespace panwright::materials {
namespace {

// sums of rounded decimals, as 0.7 0.2 0.1, may come out this much above 1
constexpr double kSumTolerance = 1e-9;

struct Reporter {
  SourceSpan where;
  DiagnosticLog& log;

  void operator()(Code code, std::string message) const {
    log.report(code, where, std::move(message));
  }
};

std::string text(double value) { return format_double(value); }

bool is_zero(const std::optional<Vec3>& color) { return !color || *color == Vec3(0); }

void settle_diffuse(Material& material, const Fields& fields, const Reporter& report) {
  // a named model takes precedence, and parameters of others are dropped
  if (fields.diffuse_model) {
    material.diffuse_brdf = brdf_of(fields, *fields.diffuse_model);
  } else if (fields.hapke) {
    material.diffuse_brdf = *fields.hapke;
    // the numbers of level 0 have no names
    if (!fields.hapke_named)
      report(Code("W1404"),
             fmt::format("hapke is read as single-scattering albedo {}, opposition width {}, "
                         "opposition strength {} and mean roughness {} degrees",
                         text(fields.hapke->w), text(fields.hapke->h), text(fields.hapke->b0),
                         text(exact_degrees(fields.hapke->roughness))));
    if (fields.oren_nayar)
      report(Code("N1401"), fmt::format("oren {} is not used, because hapke is given",
                                        text(fields.oren_nayar->sigma)));
  } else if (fields.oren_nayar) {
    material.diffuse_brdf = *fields.oren_nayar;
  }
}

void settle_specular(Material& material, const Fields& fields, const Reporter& report) {
  if (fields.specular_model) {
    material.specular_brdf = brdf_of(fields, *fields.specular_model);
    material.specular = fields.specular.value_or(Vec3(1));
  } else if (fields.cook_torrance) {
    material.specular_brdf = *fields.cook_torrance;
    const auto& [c, m, f, g] = *fields.cook_torrance;
    if (c != 1 || f != 1 || g != 1)
      report(Code("W1403"),
             fmt::format("cook {} {} {} {} scales D, F and G by {}, {} and {}; public models use 1",
                         text(c), text(m), text(f), text(g), text(c), text(f), text(g)));
    if (fields.blinn_phong)
      report(Code("N1401"), fmt::format("shine {} is not used, because cook is given",
                                        text(fields.blinn_phong->shine)));
  } else if (fields.specular || fields.blinn_phong) {
    material.specular_brdf = fields.blinn_phong.value_or(BlinnPhong{});
  }
}

bool has_microfacets(const Material& material) {
  return info_of(material.specular_model()).microfacet;
}

// Fields whose partner is missing. An explicit weight of 0 is intended and not reported.
void report_idle_fields(const Material& material, const Fields& fields, const Reporter& report) {
  const auto idle = [&](std::string_view field, std::string_view reason) {
    report(Code("N1405"), fmt::format("{} has no effect, because {}", field, reason));
  };
  const bool dark = material.specular == Vec3(0);
  if (dark && fields.cook_torrance)
    idle("cook", "the specular colour is 0");
  else if (dark && fields.blinn_phong)
    idle("shine", "the specular colour is 0");
  else if (dark && fields.reflect && material.weights.y > 0)
    idle(fmt::format("the specular weight {} of reflect", text(material.weights.y)),
         "the specular colour is 0");
  if (is_zero(fields.emissive) && fields.reflect && material.weights.z > 0)
    idle(fmt::format("the emissive weight {} of reflect", text(material.weights.z)),
         "the emissive colour is 0");
  if (fields.refract && !has_microfacets(material))
    idle("refract", "only cook, beckmann, ggx and mirror have a Fresnel term");
  if (fields.maps && fields.maps->reflectance >= 0) {
    if (!has_microfacets(material))
      idle("reflectance_map", "only cook, beckmann, ggx and mirror have a Fresnel term");
    else if (dark)
      idle("reflectance_map", "the specular colour is 0");
  }
  if (fields.reflect) return;
  if (material.weights.y == 0 && !dark)
    // by what the text has of it
    idle(fields.specular        ? "specular"
         : fields.cook_torrance ? "cook"
         : fields.blinn_phong   ? "shine"
                                : info_of(material.specular_model()).name,
         "diffuse is given as well and reflect defaults to 1 0 0");
  if (!is_zero(fields.emissive))
    idle("emissive", "reflect is not given and defaults to an emissive weight of 0");
  if (material.weights.x == 0 && (fields.oren_nayar || fields.hapke))
    idle(fields.hapke ? "hapke" : "oren", "only specular is given and reflect defaults to 0 1 0");
}

// Colours from 0 to 255, with the linear ones that they mean.
std::string as_codes(const Material& material) {
  for (const auto& [name, colour] :
       {std::pair{"diffuse", material.diffuse}, std::pair{"specular", material.specular}}) {
    bool whole = true;
    for (int k = 0; k < 3; ++k)
      whole = whole && colour[k] >= 0 && colour[k] <= 255 && colour[k] == std::floor(colour[k]);
    if (!whole || std::max({colour.x, colour.y, colour.z}) <= 1) continue;
    const auto linear = [&codes = colour](int k) {
      return image::srgb_decoded(static_cast<std::uint8_t>(codes[k]));
    };
    return fmt::format(
        "; colours are linear, from 0 to 1: the 8-bit codes {} {} {} of {} are {:.3g} "
        "{:.3g} {:.3g}",
        colour.x, colour.y, colour.z, name, linear(0), linear(1), linear(2));
  }
  return {};
}

void report_energy(const Material& material, const Reporter& report) {
  const Vec3& w = material.weights;
  const double sum = w.x + w.y + w.z;
  if (sum > 1 + kSumTolerance) {
    report(Code("W1402"),
           fmt::format("the weights {} {} {} of reflect add up to {:.6g}, expected at "
                       "most 1 to conserve energy",
                       text(w.x), text(w.y), text(w.z), sum));
    return;
  }
  constexpr const char* kChannels[] = {"red", "green", "blue"};
  for (int k = 0; k < 3; ++k) {
    const double reflected = w.x * material.diffuse[k] + w.y * material.specular[k];
    if (reflected <= 1 + kSumTolerance) continue;
    report(Code("W1402"), fmt::format("diffuse and specular, weighted, add up to {:.6g} in {}, "
                                      "expected at most 1 to conserve energy{}",
                                      reflected, kChannels[k], as_codes(material)));
    return;
  }
}

}  // namespace

namespace {

// All but the fits.
Material settled(const Fields& fields, SourceSpan where, DiagnosticLog& log) {
  assert(!fields.cook_torrance || fields.cook_torrance->alpha > 0);
  const Reporter report{where, log};
  Material material;
  // the albedo of these is w; the levels that name them do not scale it unasked
  if (fields.hapke_named || fields.lommel_seeliger) material.diffuse = Vec3(1);
  material.diffuse = fields.diffuse.value_or(material.diffuse);
  // metals reflect by their n and k, and are not coloured besides
  material.specular = fields.specular.value_or(Vec3(fields.extinction ? 1 : 0));
  material.emissive = fields.emissive.value_or(material.emissive);
  material.refract = fields.refract;
  material.extinction = fields.extinction.value_or(Vec3(0));
  material.compensation = fields.compensation.value_or(Compensation::automatic);
  material.coat = fields.coat;
  material.cells = fields.cells;
  material.maps = fields.maps.value_or(Maps{});
  if (fields.reflect)
    material.weights = *fields.reflect;
  else if ((fields.specular || fields.specular_model || fields.extinction) && !fields.diffuse)
    material.weights = {0, 1, 0};

  settle_diffuse(material, fields, report);
  settle_specular(material, fields, report);
  report_idle_fields(material, fields, report);
  report_energy(material, report);

  // a part without effect gets the cheapest BRDF
  if (material.weights.x == 0 || material.diffuse == Vec3(0)) material.diffuse_brdf = Lambert{};
  if (material.weights.y == 0 || material.specular == Vec3(0))
    material.specular_brdf = NoSpecular{};
  if (fields.specular_model && material.specular_model() == SpecularModel::none)
    material.compensation = Compensation::automatic;
  return material;
}

// Microfacets and coats take milliseconds, other BRDFs less than a file.
bool is_long(const Material& material) {
  return material.coat || info_of(material.specular_model()).smith;
}

bool is_finite(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

constexpr std::size_t kFitNumbers = sizeof(Fits) / sizeof(double);
static_assert(sizeof(Fits) == kFitNumbers * sizeof(double));

void write_fits(const Fits& fits, ByteWriter& to) {
  std::vector<double> numbers(kFitNumbers);
  std::memcpy(numbers.data(), &fits, sizeof fits);
  to.list(numbers);
}

Fits read_fits(ByteReader& from) {
  Fits fits;
  std::vector<double> numbers;
  from.list(numbers);
  if (numbers.size() == kFitNumbers && is_finite(numbers))
    std::memcpy(static_cast<void*>(&fits), numbers.data(), sizeof fits);
  else
    from.fail();
  return fits;
}

void fit_or_reuse(Material& material, const WorkCache* cache) {
  material.fits = *remember<Fits>(
      is_long(material) ? cache : nullptr, Work::fits,
      [&] {
        KeyHasher key;
        key.list(key_of(material));
        return key.key();
      },
      [&] {
        fit(material);
        return std::optional(material.fits);
      },
      write_fits, read_fits);
}

}  // namespace

Material resolved(const Fields& fields, SourceSpan where, DiagnosticLog& log) {
  return resolved(fields, where, log, nullptr);
}

Material resolved(const Fields& fields, SourceSpan where, DiagnosticLog& log,
                  const WorkCache* cache) {
  Material material = settled(fields, where, log);
  fit_or_reuse(material, cache);
  return material;
}

BrdfModel brdf_model_of(const Material& material) {
  BrdfModel brdf_model{.diffuse = material.diffuse_model(), .specular = material.specular_model()};
  if (has_microfacets(material) && material.refract)
    brdf_model.fresnel =
        material.extinction == Vec3(0) ? FresnelModel::dielectric : FresnelModel::conductor;
  brdf_model.compensated = material.fits.compensation_scale != Vec3(0);
  brdf_model.coated = material.coat.has_value();
  brdf_model.mapped = has_microfacets(material) && material.maps.reflectance >= 0;
  return brdf_model;
}

std::optional<Vec2> slopes_of(const Material& material) {
  const SpecularBrdf& brdf = material.specular_brdf;
  if (const auto* cook = std::get_if<CookTorrance>(&brdf)) return Vec2(cook->alpha);
  if (const auto* beckmann = std::get_if<Beckmann>(&brdf))
    return Vec2(beckmann->alpha_x, beckmann->alpha_y);
  if (const auto* ggx = std::get_if<Ggx>(&brdf)) return Vec2(ggx->alpha_x, ggx->alpha_y);
  return std::nullopt;
}

double slope_of_shine(double shine) { return std::sqrt(2 / std::max(shine, 1e-3)); }

std::optional<double> narrowest_slope(const Material& material, Lobes lobes) {
  std::optional<double> least;
  const auto take = [&](double slope) {
    if (slope > 0 || lobes != Lobes::finite) least = least ? std::min(*least, slope) : slope;
  };
  if (const auto slopes = slopes_of(material)) take(std::min(slopes->x, slopes->y));
  if (const auto* phong = std::get_if<BlinnPhong>(&material.specular_brdf))
    take(slope_of_shine(phong->shine));
  // slopes turn light by twice their angle, and their variance is half of its square
  const auto* retro = std::get_if<Retroreflector>(&material.specular_brdf);
  if (retro != nullptr && lobes != Lobes::about_normal) take(retro->width * std::sqrt(0.5));
  // a rough coat blurs a mirror below
  if (material.specular_model() == SpecularModel::mirror)
    take(material.coat ? (material.coat->index - 1) * std::sqrt(0.5) * material.coat->alpha : 0);
  if (material.coat) take(material.coat->alpha);
  return least;
}

SpecularBrdf with_slopes(SpecularModel model, const Vec2& alpha) {
  switch (model) {
    case SpecularModel::cook_torrance:
      return CookTorrance{.alpha = alpha.x};
    case SpecularModel::beckmann:
      return Beckmann{alpha.x, alpha.y};
    case SpecularModel::ggx:
      return Ggx{alpha.x, alpha.y};
    default:
      return default_brdf(model);
  }
}

bool is_anisotropic(const Material& material) {
  if (material.cells && material.cells->tilt != Vec2(0)) return true;
  const auto slopes = slopes_of(material);
  return slopes && slopes->x != slopes->y;
}

double exact_degrees(double radians) {
  if (radians == 0) return 0;
  const double near = radians / kDegree;
  // of several the roundest is what an author would write
  const double round = std::round(near * 1e9) / 1e9;
  if (round * kDegree == radians) return round;
  double candidate = near;
  for (int step = 0; step < 4; ++step)
    candidate = std::nextafter(candidate, -std::numeric_limits<double>::infinity());
  for (int step = 0; step < 9; ++step) {
    if (candidate * kDegree == radians) return candidate;
    candidate = std::nextafter(candidate, std::numeric_limits<double>::infinity());
  }
  return near;
}

double eon_roughness(double sigma) {
  const double s2 = sigma * sigma;
  return 0.45 * s2 / (s2 + 0.09) / (1 - 0.5 * s2 / (s2 + 0.33));
}

std::vector<std::uint32_t> variants_of(std::span<const Material> materials) {
  std::map<BrdfModel, std::uint32_t> uses;
  for (const Material& material : materials) ++uses[brdf_model_of(material)];
  std::vector<std::pair<BrdfModel, std::uint32_t>> brdf_models(uses.begin(), uses.end());
  std::stable_sort(brdf_models.begin(), brdf_models.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  for (std::uint32_t i = 0; i < brdf_models.size(); ++i)
    uses[brdf_models[i].first] = std::min(i, kMostVariants - 1);
  std::vector<std::uint32_t> variants;
  variants.reserve(materials.size());
  for (const Material& material : materials) variants.push_back(uses[brdf_model_of(material)]);
  return variants;
}

}  // namespace panwright::materials
