#include "preview/gl/programs.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <initializer_list>
#include <utility>

#include "base/clock.h"
#include "materials/cells.h"
#include "materials/formula_text.h"
#include "preview/gl/shader_text.h"

namespace panwright::preview {
namespace {

constexpr const char* kVersion = "#version 450 core\n";

std::string defined(const char* name, bool yes) {
  return yes ? fmt::format("#define {}\n", name) : std::string();
}

std::string layer_names(LayerSet layers) {
  return defined("PAINTED", has(layers, kAlbedoLayer)) +
         defined("ROUGH", has(layers, kRoughnessLayer)) +
         defined("BRUSHED", has(layers, kTangentLayer));
}

// of a fragment shader that may leave holes
std::string cutout_text(bool cutout) {
  return cutout ? std::string("#define CUTOUT\n") + cutout_glsl : std::string();
}

// of shading.frag
std::string wide_light_text(const materials::BrdfModel& brdf_model, bool planets, bool indirect) {
  using enum materials::SpecularModel;
  const auto lobe = [&](const char* name, materials::SpecularModel model) {
    return defined(name, brdf_model.specular == model);
  };
  return defined("COATED", brdf_model.coated) + defined("COMPENSATED", brdf_model.compensated) +
         defined("LOBE_ANY", brdf_model.specular != none) + lobe("LOBE_BLINN_PHONG", blinn_phong) +
         lobe("LOBE_COOK_TORRANCE", cook_torrance) + lobe("LOBE_SLOPES", beckmann) +
         lobe("LOBE_HEAVY", ggx) + lobe("LOBE_MIRROR", mirror) +
         lobe("LOBE_RETURNS", retroreflector) + defined("INDIRECT", indirect) + wide_lobes_glsl +
         defined("PLANETS", planets) + (planets ? planets_glsl : "") +
         (indirect ? indirect_glsl : "");
}

}  // namespace

GlProgram Programs::requested(const std::string& vertex, const std::string& fragment) {
  const auto start = std::chrono::steady_clock::now();
  ++built_;
  const std::string head = std::string(kVersion) + uniforms_glsl;
  GlProgram program = request_program(gl_, head + vertex, head + fragment);
  waiting_.push_back(program.id());
  seconds_ += seconds_since(start);
  return program;
}

void Programs::forget(GLuint program) {
  const auto reset = [&](GlProgram& one) {
    if (one && one.id() == program) one = {};
  };
  for (auto& [key, one] : geometry_) reset(one);
  for (auto& [key, one] : shading_) reset(one);
  for (auto* few : {&shadow_, &ids_})
    for (GlProgram& one : *few) reset(one);
  for (GlProgram& one : resolve_) reset(one);
  for (GlProgram* one : {&classes_, &all_samplers_, &decal_, &bare_, &runs_}) reset(*one);
}

bool Programs::settle(std::string* problem) {
  if (waiting_.empty()) return true;
  const auto start = std::chrono::steady_clock::now();
  bool good = true;
  for (const GLuint program : waiting_) {
    std::string words = problem_of_program(gl_, program);
    if (words.empty()) continue;
    forget(program);
    if (good) *problem = std::move(words);
    good = false;
  }
  waiting_.clear();
  seconds_ += seconds_since(start);
  return good;
}

GLuint Programs::geometry(const Variant& v, bool flat, LayerSet layers, bool shadows,
                          bool instanced) {
  unsigned key = layers;
  for (const bool bit :
       {v.textured, v.colored, v.albedo_map, v.normal_map, v.roughness_map, v.reflectance_map,
        v.cutout, v.cells, v.tangents, v.curved && !flat, flat, shadows, instanced})
    key = 2 * key + bit;
  GlProgram& program = geometry_[key];
  if (!program) {
    const bool mapped =
        v.albedo_map || v.normal_map || v.roughness_map || v.reflectance_map || v.cutout;
    const std::string version = defined("INSTANCED", instanced);
    const std::string head =
        defined("GEOMETRY", true) + layer_names(layers) + defined("TEXTURED", v.textured) +
        defined("COLOURED", v.colored) + defined("ALBEDO_MAP", v.albedo_map) +
        defined("BUMPED", v.normal_map) + defined("ROUGHNESS_MAP", v.roughness_map) +
        defined("REFLECTANCE_MAP", v.reflectance_map) + defined("MAPPED", mapped) +
        defined("CELLS", v.cells) + defined("TANGENTS", v.tangents) + defined("FLAT", flat) +
        defined("CURVED", v.curved && !flat) + defined("PLACED", shadows) + draw_glsl;
    const std::string pattern = v.cells ? materials::glsl_cells() : std::string();
    const std::string place = shadows ? sample_position_glsl : "";
    program = requested(version + defined("VERTEX", true) + head + model_vert,
                        version + head + pattern + cutout_text(v.cutout) + place +
                            (v.curved && !flat ? turning_glsl : "") + geometry_frag);
  }
  return program.id();
}

GLuint Programs::shading(const materials::BrdfModel& brdf_model, LayerSet layers, bool one_material,
                         bool shadows, Lit lit) {
  const auto number = static_cast<unsigned>(lit);
  GlProgram& program =
      shading_[{brdf_model, ((layers * 2 + one_material) * 2 + shadows) * 16 + number}];
  if (!program) {
    std::string head =
        sample_place_glsl + layer_names(layers) + defined("REFLECTING", brdf_model.mapped) +
        defined("TWO_SLOPES", brdf_model.specular == materials::SpecularModel::beckmann ||
                                  brdf_model.specular == materials::SpecularModel::ggx) +
        defined("ONE_MATERIAL", one_material) +
        defined("ADDED", lit == Lit::lamps || lit == Lit::point_lamps) +
        defined("POINTS", lit == Lit::point_lamps);
    head += materials::glsl_formulas(brdf_model) + materials::glsl_material_loader();
    if (has(layers, kTangentLayer)) head += turning_glsl;
    const auto any_of = [&](std::initializer_list<Lit> some) {
      return std::ranges::find(some, lit) != some.end();
    };
    const bool planets = any_of(
        {Lit::sun_and_planets, Lit::all_but_lamps, Lit::eclipsed_and_planets, Lit::all_eclipsed});
    const bool indirect = any_of(
        {Lit::sun_and_surfaces, Lit::all_but_lamps, Lit::eclipsed_and_surfaces, Lit::all_eclipsed});
    head += defined("BODIES", any_of({Lit::eclipsed, Lit::eclipsed_and_planets,
                                      Lit::eclipsed_and_surfaces, Lit::all_eclipsed}));
    if (shadows || indirect) head += sample_normal_glsl;
    if (shadows) head += std::string("#define SHADOWED\n") + shadow_glsl;
    if (planets || indirect) head += wide_light_text(brdf_model, planets, indirect);
    program = requested(screen_vert, head + shading_frag);
  }
  return program.id();
}

GLuint Programs::classes() {
  if (!classes_) classes_ = requested(screen_vert, std::string(sample_place_glsl) + classes_frag);
  return classes_.id();
}

GLuint Programs::all_samplers() {
  if (!all_samplers_) all_samplers_ = requested(screen_vert, all_samplers_frag);
  return all_samplers_.id();
}

GLuint Programs::shadow(bool cutout, bool instanced) {
  GlProgram& program = shadow_[2 * cutout + instanced];
  if (!program) {
    const std::string version = defined("INSTANCED", instanced);
    const std::string head = defined("MAPPED", cutout) + draw_glsl;
    program = requested(version + defined("VERTEX", true) + head + model_vert,
                        version + head + cutout_text(cutout) + shadow_frag);
  }
  return program.id();
}

GLuint Programs::ids(bool cutout, bool instanced) {
  GlProgram& program = ids_[2 * cutout + instanced];
  if (!program) {
    const std::string version = defined("INSTANCED", instanced);
    const std::string head = defined("MAPPED", cutout) + draw_glsl;
    program = requested(version + defined("VERTEX", true) + head + model_vert,
                        version + head + cutout_text(cutout) + ids_frag);
  }
  return program.id();
}

GLuint Programs::decal() {
  if (!decal_)
    decal_ = requested(defined("DECAL", true) + draw_glsl + model_vert,
                       std::string(draw_glsl) + decal_frag);
  return decal_.id();
}

GLuint Programs::resolve(bool spread) {
  GlProgram& program = resolve_[spread];
  if (!program) program = requested(screen_vert, defined("SPREAD", spread) + resolve_frag);
  return program.id();
}

GLuint Programs::runs() {
  if (!runs_) runs_ = requested(runs_vert, nothing_frag);
  return runs_.id();
}

GLuint Programs::bare() {
  if (!bare_) bare_ = requested(std::string(draw_glsl) + model_vert, bare_frag);
  return bare_.id();
}

}  // namespace panwright::preview
