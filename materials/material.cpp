#include "materials/material.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <map>

#include "base/text.h"

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

// A law that is named holds, and the numbers of others are forgotten.
bool settle_named_diffuse(Material& material, const Fields& fields) {
  if (!fields.diffuse_law) return false;
  material.diffuse_law = *fields.diffuse_law;
  if (material.diffuse_law == DiffuseLaw::eon) material.oren = fields.oren.value_or(0);
  if (material.diffuse_law == DiffuseLaw::lommel_seeliger)
    material.hapke = {fields.lommel.value_or(0), 0, 0, 0};
  return true;
}

void settle_diffuse(Material& material, const Fields& fields, const Reporter& report) {
  if (settle_named_diffuse(material, fields)) return;
  if (fields.oren) material.oren = *fields.oren;
  if (fields.hapke) {
    material.diffuse_law = DiffuseLaw::hapke;
    material.grains = fields.hapke_grains.value_or(HapkeGrains{});
    const auto& [w, h, b0, rough_deg] = *fields.hapke;
    material.hapke = {w, h, b0, rough_deg * kDegree};
    // the numbers of level 0 have no names
    if (!fields.hapke_grains)
      report(Code::W1404,
             fmt::format("hapke is read as single-scattering albedo {}, opposition width {}, "
                         "opposition strength {} and mean roughness {} degrees",
                         text(w), text(h), text(b0), text(rough_deg)));
    if (fields.oren) {
      material.oren = 0;
      report(Code::N1401,
             fmt::format("oren {} is not used, because hapke is given", text(*fields.oren)));
    }
  } else if (fields.oren) {
    material.diffuse_law = DiffuseLaw::oren_nayar;
  }
}

bool settle_named_specular(Material& material, const Fields& fields) {
  if (!fields.specular_law) return false;
  material.specular_law = *fields.specular_law;
  material.specular = fields.specular.value_or(Vec3(1));
  if (fields.alpha && material.specular_law != SpecularLaw::mirror) {
    material.cook = {1, (*fields.alpha)[0], 1, 1};
    material.alpha_y = (*fields.alpha)[1];
  }
  return true;
}

void settle_specular(Material& material, const Fields& fields, const Reporter& report) {
  if (settle_named_specular(material, fields)) return;
  if (fields.cook) {
    material.specular_law = SpecularLaw::cook_torrance;
    material.cook = *fields.cook;
    const auto& [c, m, f, g] = *fields.cook;
    if (c != 1 || f != 1 || g != 1)
      report(Code::W1403,
             fmt::format("cook {} {} {} {} scales D, F and G by {}, {} and {}; public "
                         "models have 1 there",
                         text(c), text(m), text(f), text(g), text(c), text(f), text(g)));
    if (fields.shine)
      report(Code::N1401,
             fmt::format("shine {} is not used, because cook is given", text(*fields.shine)));
  } else if (fields.specular || fields.shine) {
    material.specular_law = SpecularLaw::blinn_phong;
    material.shine = fields.shine.value_or(0);
  }
}

bool has_facets(SpecularLaw law) {
  return law != SpecularLaw::none && law != SpecularLaw::blinn_phong;
}

// Fields whose partner is missing. What an explicit weight of 0 switches off is the author's will.
void report_idle_fields(const Material& material, const Fields& fields, const Reporter& report) {
  const auto idle = [&](std::string_view field, std::string_view reason) {
    report(Code::N1405, fmt::format("{} has no effect, because {}", field, reason));
  };
  const bool dark = material.specular == Vec3(0);
  if (dark && fields.cook)
    idle("cook", "the specular colour is 0");
  else if (dark && fields.shine)
    idle("shine", "the specular colour is 0");
  else if (dark && fields.reflect && material.weights.y > 0)
    idle(fmt::format("the specular weight {} of reflect", text(material.weights.y)),
         "the specular colour is 0");
  if (is_zero(fields.emissive) && fields.reflect && material.weights.z > 0)
    idle(fmt::format("the emissive weight {} of reflect", text(material.weights.z)),
         "the emissive colour is 0");
  if (fields.refract && !has_facets(material.specular_law))
    idle("refract", "only cook, beckmann, ggx and mirror have a Fresnel term");
  if (fields.maps && fields.maps->reflectance >= 0) {
    if (!has_facets(material.specular_law))
      idle("reflectance_map", "only cook, beckmann, ggx and mirror have a Fresnel term");
    else if (dark)
      idle("reflectance_map", "the specular colour is 0");
  }
  if (fields.reflect) return;
  if (material.weights.y == 0 && !dark)
    idle("specular", "diffuse is given as well and there is no reflect, which is then 1 0 0");
  if (!is_zero(fields.emissive))
    idle("emissive", "there is no reflect, which then gives it the weight 0");
  if (material.weights.x == 0 && (fields.oren || fields.hapke))
    idle(fields.hapke ? "hapke" : "oren",
         "only specular is given and there is no reflect, which is then 0 1 0");
}

void report_energy(const Material& material, const Reporter& report) {
  const Vec3& w = material.weights;
  const double sum = w.x + w.y + w.z;
  if (sum > 1 + kSumTolerance) {
    report(Code::W1402, fmt::format("the weights {} {} {} of reflect add up to {:.6g}; at most 1 "
                                    "keeps the balance of energy",
                                    text(w.x), text(w.y), text(w.z), sum));
    return;
  }
  constexpr const char* kChannels[] = {"red", "green", "blue"};
  for (int k = 0; k < 3; ++k) {
    const double reflected = w.x * material.diffuse[k] + w.y * material.specular[k];
    if (reflected <= 1 + kSumTolerance) continue;
    report(Code::W1402, fmt::format("diffuse and specular, weighted, add up to {:.6g} in {}; at "
                                    "most 1 keeps the balance of energy",
                                    reflected, kChannels[k]));
    return;
  }
}

}  // namespace

Fields Fields::overridden_by(const Fields& inner) const {
  Fields merged = *this;
  const auto replace = [](auto& outer, const auto& given) {
    if (given) outer = given;
  };
  replace(merged.diffuse, inner.diffuse);
  replace(merged.specular, inner.specular);
  replace(merged.shine, inner.shine);
  replace(merged.emissive, inner.emissive);
  replace(merged.reflect, inner.reflect);
  replace(merged.refract, inner.refract);
  replace(merged.cook, inner.cook);
  replace(merged.oren, inner.oren);
  replace(merged.hapke, inner.hapke);
  replace(merged.maps, inner.maps);
  // a law that is given inside replaces the choice made outside
  if (inner.oren || inner.hapke || inner.lommel || inner.diffuse_law)
    merged.diffuse_law = inner.diffuse_law;
  if (inner.shine || inner.cook || inner.alpha || inner.specular_law)
    merged.specular_law = inner.specular_law;
  if (inner.refract) merged.extinction = inner.extinction;
  replace(merged.alpha, inner.alpha);
  replace(merged.hapke_grains, inner.hapke_grains);
  replace(merged.lommel, inner.lommel);
  replace(merged.compensation, inner.compensation);
  replace(merged.coat, inner.coat);
  replace(merged.cells, inner.cells);
  replace(merged.preset, inner.preset);
  return merged;
}

Material resolved(const Fields& fields, SourceSpan where, DiagnosticLog& log) {
  assert(!fields.cook || (*fields.cook)[1] > 0);
  const Reporter report{where, log};
  Material material;
  // the albedo of these is w; the levels that name them do not scale it unasked
  if (fields.hapke_grains || fields.lommel) material.diffuse = Vec3(1);
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
  else if ((fields.specular || fields.specular_law || fields.extinction) && !fields.diffuse)
    material.weights = {0, 1, 0};

  settle_diffuse(material, fields, report);
  settle_specular(material, fields, report);
  report_idle_fields(material, fields, report);
  report_energy(material, report);

  // a part that adds nothing gets the law that costs nothing
  if (material.weights.x == 0 || material.diffuse == Vec3(0))
    material.diffuse_law = DiffuseLaw::lambert;
  if (material.weights.y == 0 || material.specular == Vec3(0))
    material.specular_law = SpecularLaw::none;
  if (fields.specular_law && material.specular_law == SpecularLaw::none) {
    material.cook = Material{}.cook;
    material.alpha_y = Material{}.alpha_y;
    material.compensation = Compensation::automatic;
  }
  fit(material);
  return material;
}

Laws laws_of(const Material& material) {
  Laws laws{.diffuse = material.diffuse_law, .specular = material.specular_law};
  if (has_facets(material.specular_law) && material.refract)
    laws.fresnel = material.extinction == Vec3(0) ? FresnelLaw::dielectric : FresnelLaw::conductor;
  laws.compensated = material.fits.many_scale != Vec3(0);
  laws.coated = material.coat.has_value();
  laws.mapped = has_facets(material.specular_law) && material.maps.reflectance >= 0;
  return laws;
}

double eon_roughness(double sigma) {
  const double s2 = sigma * sigma;
  return 0.45 * s2 / (s2 + 0.09) / (1 - 0.5 * s2 / (s2 + 0.33));
}

std::vector<std::uint32_t> variants_of(std::span<const Material> materials) {
  std::map<Laws, std::uint32_t> uses;
  for (const Material& material : materials) ++uses[laws_of(material)];
  std::vector<std::pair<Laws, std::uint32_t>> families(uses.begin(), uses.end());
  std::stable_sort(families.begin(), families.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  for (std::uint32_t i = 0; i < families.size(); ++i)
    uses[families[i].first] = std::min(i, kMostVariants - 1);
  std::vector<std::uint32_t> variants;
  variants.reserve(materials.size());
  for (const Material& material : materials) variants.push_back(uses[laws_of(material)]);
  return variants;
}

}  // namespace panwright::materials
