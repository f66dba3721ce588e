#include "materials/material.h"

#include <fmt/format.h>

#include <cassert>

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

void settle_laws(Material& material, const Fields& fields, const Reporter& report) {
  if (fields.hapke) {
    material.diffuse_law = DiffuseLaw::hapke;
    const auto& [w, h, b0, rough_deg] = *fields.hapke;
    material.hapke = {w, h, b0, rough_deg * kDegree};
    report(Code::W1404,
           fmt::format("hapke is read as single-scattering albedo {}, opposition width {}, "
                       "opposition strength {} and mean roughness {} degrees",
                       text(w), text(h), text(b0), text(rough_deg)));
    if (fields.oren)
      report(Code::N1401,
             fmt::format("oren {} is not used, because hapke is given", text(*fields.oren)));
  } else if (fields.oren) {
    material.diffuse_law = DiffuseLaw::oren_nayar;
    material.oren = *fields.oren;
  }

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

// Fields whose partner is missing. What an explicit weight of 0 switches off is the author's will.
void report_idle_fields(const Material& material, const Fields& fields, const Reporter& report) {
  const auto idle = [&](std::string_view field, std::string_view reason) {
    report(Code::N1405, fmt::format("{} has no effect, because {}", field, reason));
  };
  const bool dark = is_zero(fields.specular);
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
  if (fields.refract && !fields.cook) idle("refract", "only cook has a Fresnel term");
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
  return merged;
}

Material resolved(const Fields& fields, SourceSpan where, DiagnosticLog& log) {
  assert(!fields.cook || (*fields.cook)[1] > 0);
  const Reporter report{where, log};
  Material material;
  material.diffuse = fields.diffuse.value_or(material.diffuse);
  material.specular = fields.specular.value_or(material.specular);
  material.emissive = fields.emissive.value_or(material.emissive);
  material.refract = fields.refract;
  material.maps = fields.maps.value_or(Maps{});
  if (fields.reflect)
    material.weights = *fields.reflect;
  else if (fields.specular && !fields.diffuse)
    material.weights = {0, 1, 0};

  settle_laws(material, fields, report);
  report_idle_fields(material, fields, report);
  report_energy(material, report);

  // a part that adds nothing gets the law that costs nothing
  if (material.weights.x == 0 || material.diffuse == Vec3(0))
    material.diffuse_law = DiffuseLaw::lambert;
  if (material.weights.y == 0 || material.specular == Vec3(0))
    material.specular_law = SpecularLaw::none;
  return material;
}

}  // namespace panwright::materials
