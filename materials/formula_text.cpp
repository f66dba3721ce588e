#include "materials/formula_text.h"

#include <fmt/format.h>

#include <cassert>
#include <iterator>

#include "materials/internal/formula_texts.h"

namespace panwright::materials {
namespace {

constexpr const char* kGlue =
    "#define Real float\n#define Vec3 vec3\n#define FORMULA\n#define PANWRIGHT_H "
    "hapke_h_function\n";
constexpr const char* kUnglue = "#undef Real\n#undef Vec3\n#undef FORMULA\n#undef PANWRIGHT_H\n";

#include "materials/internal/generated/formula_table.inl"
//
#include "materials/internal/generated/material_loader.inl"

constexpr const char* kFresnel[] = {"no_fresnel", "dielectric_fresnel", "conductor_fresnel"};

const char* many(const Laws& laws) {
  if (!laws.compensated) return "no_many";
  return laws.mapped ? "mapped_many" : "facet_many";
}

// Texts that families need, each once, in an order in which they may stand: what is called stands
// before who calls it.
std::string law_texts(std::span<const Laws> families) {
  std::string text;
  for (const FormulaFile& file : kFormulaFiles) {
    bool used = file.shared;
    for (const Laws& laws : families)
      used = used || static_cast<int>(laws.diffuse) == file.diffuse ||
             static_cast<int>(laws.specular) == file.specular;
    if (used) text += *file.text;
  }
  return text;
}

const char* layers(const Laws& laws) {
  if (!laws.coated) return "bare";
  return laws.specular == SpecularModel::mirror ? "coated_mirror" : "coated";
}

std::string surface_functions(const Laws& laws) {
  const std::string fresnel =
      std::string(laws.mapped ? "mapped_" : "") + kFresnel[static_cast<std::size_t>(laws.fresnel)];
  const std::pair<const char*, const char*> names[] = {
      {"DIFFUSE", kDiffuseFunctions[static_cast<std::size_t>(laws.diffuse)]},
      {"LOBE", kSpecularFunctions[static_cast<std::size_t>(laws.specular)]},
      {"FRESNEL", fresnel.c_str()},
      {"MANY", many(laws)},
      {"LAYERS", layers(laws)}};
  std::string text;
  for (const auto& [name, law] : names) text += fmt::format("#define PANWRIGHT_{} {}\n", name, law);
  text += surface_text;
  for (const auto& [name, law] : names) text += fmt::format("#undef PANWRIGHT_{}\n", name);
  return text;
}

// One function that calls that of a family.
std::string choice(const char* function, const char* parameters, const char* arguments,
                   std::size_t families) {
  std::string text = fmt::format("vec3 {}(uint family, {}) {{\n", function, parameters);
  for (std::size_t i = 0; i + 1 < families; ++i)
    text += fmt::format("  if (family == {}u) return {}_{}({});\n", i, function, i, arguments);
  return text + fmt::format("  return {}_{}({});\n}}\n", function, families - 1, arguments);
}

}  // namespace

std::string glsl_formulas(const Laws& laws) {
  return kGlue + law_texts({&laws, 1}) + surface_functions(laws) + kUnglue;
}

std::string glsl_formulas(std::span<const Laws> families) {
  assert(!families.empty());
  std::string text = kGlue + law_texts(families);
  constexpr const char* kNames[] = {"mirrored",          "bare",          "coated_diffuse",
                                    "coated_facets",     "coated_many",   "coated",
                                    "coated_reflection", "coated_mirror", "surface_brdf",
                                    "surface_radiance"};
  for (std::size_t i = 0; i < families.size(); ++i) {
    for (const char* name : kNames) text += fmt::format("#define {0} {0}_{1}\n", name, i);
    text += surface_functions(families[i]);
    for (const char* name : kNames) text += fmt::format("#undef {}\n", name);
  }
  const char* const place = "Surface s, vec3 to_light, vec3 to_viewer, vec3 normal";
  text += choice("surface_brdf", place, "s, to_light, to_viewer, normal", families.size());
  text += choice("surface_radiance", fmt::format("{}, vec3 irradiance", place).c_str(),
                 "s, to_light, to_viewer, normal, irradiance", families.size());
  return text + kUnglue;
}

std::string glsl_all_laws() {
  std::string text = kGlue;
  for (const FormulaFile& file : kFormulaFiles) text += *file.text;
  text += cells_text;
  return text + kUnglue;
}

std::string glsl_material_loader() { return kMaterialLoader; }

}  // namespace panwright::materials
