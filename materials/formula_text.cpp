#include "materials/formula_text.h"

#include <fmt/core.h>

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

const char* compensation(const BrdfModel& brdf_model) {
  if (!brdf_model.compensated) return "no_compensation";
  return brdf_model.mapped ? "mapped_compensation" : "microfacet_compensation";
}

// Texts that BRDF models need, each once, in order of declaration: callees before callers.
std::string brdf_texts(std::span<const BrdfModel> brdf_models) {
  std::string text;
  for (const FormulaFile& file : kFormulaFiles) {
    bool used = file.shared;
    for (const BrdfModel& brdf_model : brdf_models)
      used = used || static_cast<int>(brdf_model.diffuse) == file.diffuse ||
             static_cast<int>(brdf_model.specular) == file.specular;
    if (used) text += *file.text;
  }
  return text;
}

const char* layers(const BrdfModel& brdf_model) {
  if (!brdf_model.coated) return "bare";
  return brdf_model.specular == SpecularModel::mirror ? "coated_mirror" : "coated";
}

std::string surface_functions(const BrdfModel& brdf_model) {
  const std::string fresnel = std::string(brdf_model.mapped ? "mapped_" : "") +
                              kFresnel[static_cast<std::size_t>(brdf_model.fresnel)];
  const char* const lobe = kSpecularFunctions[static_cast<std::size_t>(brdf_model.specular)];
  const std::string from = std::string(lobe) + "_from";
  const std::pair<const char*, const char*> names[] = {
      {"DIFFUSE", kDiffuseFunctions[static_cast<std::size_t>(brdf_model.diffuse)]},
      {"FROM", from.c_str()},
      {"LOBE", lobe},
      {"FRESNEL", fresnel.c_str()},
      {"COMPENSATION", compensation(brdf_model)},
      {"LAYERS", layers(brdf_model)}};
  std::string text;
  for (const auto& [name, brdf] : names)
    text += fmt::format("#define PANWRIGHT_{} {}\n", name, brdf);
  text += surface_text;
  for (const auto& [name, brdf] : names) text += fmt::format("#undef PANWRIGHT_{}\n", name);
  return text;
}

// One function that calls that of a BRDF model.
std::string choice(const char* function, std::size_t brdf_models) {
  constexpr const char* kArguments = "s, light, to_viewer, normal";
  std::string text = fmt::format(
      "vec3 {}(uint brdf_model, Surface s, Incidence light, vec3 to_viewer, vec3 normal) {{\n",
      function);
  for (std::size_t i = 0; i + 1 < brdf_models; ++i)
    text += fmt::format("  if (brdf_model == {}u) return {}_{}({});\n", i, function, i, kArguments);
  return text + fmt::format("  return {}_{}({});\n}}\n", function, brdf_models - 1, kArguments);
}

}  // namespace

std::string glsl_formulas(const BrdfModel& brdf_model) {
  return kGlue + brdf_texts({&brdf_model, 1}) + surface_functions(brdf_model) + kUnglue;
}

std::string glsl_formulas(std::span<const BrdfModel> brdf_models) {
  assert(!brdf_models.empty());
  std::string text = kGlue + brdf_texts(brdf_models);
  constexpr const char* kNames[] = {"mirrored",
                                    "bare",
                                    "coated_diffuse",
                                    "coated_microfacets",
                                    "coated_compensation",
                                    "coated",
                                    "coated_reflection",
                                    "coated_mirror",
                                    "surface_brdf",
                                    "surface_radiance",
                                    "bare_diffuse",
                                    "bare_reflection"};
  for (std::size_t i = 0; i < brdf_models.size(); ++i) {
    for (const char* name : kNames) text += fmt::format("#define {0} {0}_{1}\n", name, i);
    text += surface_functions(brdf_models[i]);
    for (const char* name : kNames) text += fmt::format("#undef {}\n", name);
  }
  for (const char* function : {"surface_brdf", "surface_radiance"})
    text += choice(function, brdf_models.size());
  return text + kUnglue;
}

std::string glsl_all_brdfs() {
  std::string text = kGlue;
  for (const FormulaFile& file : kFormulaFiles) text += *file.text;
  text += cells_text;
  return text + kUnglue;
}

std::string glsl_material_loader() { return kMaterialLoader; }

}  // namespace panwright::materials
