#include "preview/gl/programs.h"

#include <fmt/format.h>

#include <algorithm>

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

}  // namespace

GlProgram Programs::made(const std::string& vertex, const std::string& fragment,
                         std::string* problem) {
  ++built_;
  return make_program(gl_, vertex, fragment, problem);
}

GLuint Programs::geometry(const Variant& v, bool flat, LayerSet layers, bool shadows,
                          bool instanced, std::string* problem) {
  unsigned key = layers;
  for (const bool bit :
       {v.textured, v.colored, v.albedo_map, v.normal_map, v.roughness_map, v.reflectance_map,
        v.cutout, v.cells, v.tangents, flat, shadows, instanced})
    key = 2 * key + bit;
  GlProgram& program = geometry_[key];
  if (!program) {
    const bool mapped =
        v.albedo_map || v.normal_map || v.roughness_map || v.reflectance_map || v.cutout;
    const std::string version = kVersion + defined("INSTANCED", instanced);
    const std::string head =
        defined("GEOMETRY", true) + layer_names(layers) + defined("TEXTURED", v.textured) +
        defined("COLOURED", v.colored) + defined("ALBEDO_MAP", v.albedo_map) +
        defined("BUMPED", v.normal_map) + defined("ROUGHNESS_MAP", v.roughness_map) +
        defined("REFLECTANCE_MAP", v.reflectance_map) + defined("MAPPED", mapped) +
        defined("CELLS", v.cells) + defined("TANGENTS", v.tangents) + defined("FLAT", flat) +
        defined("SHADOWED", shadows) + draw_glsl;
    const std::string pattern = v.cells ? materials::glsl_cells() : std::string();
    const std::string place = shadows ? light_space_glsl : "";
    program =
        made(version + defined("VERTEX", true) + head + model_vert,
             version + head + pattern + cutout_text(v.cutout) + place + geometry_frag, problem);
  }
  return program.id();
}

GLuint Programs::shading(const materials::BrdfModel& brdf_model, LayerSet layers, bool one_material,
                         bool shadows, bool point_sun, std::string* problem) {
  GlProgram& program =
      shading_[{brdf_model, ((layers * 2 + one_material) * 2 + shadows) * 2 + point_sun}];
  if (!program) {
    std::string head = kVersion;
    head += sample_place_glsl + layer_names(layers) + defined("REFLECTING", brdf_model.mapped) +
            defined("TWO_SLOPES", brdf_model.specular == materials::SpecularModel::beckmann ||
                                      brdf_model.specular == materials::SpecularModel::ggx) +
            defined("ONE_MATERIAL", one_material) + defined("POINT_SUN", point_sun);
    head += materials::glsl_formulas(brdf_model) + materials::glsl_material_loader();
    if (shadows) head += std::string("#define SHADOWED\n") + shadow_glsl;
    program = made(std::string(kVersion) + screen_vert, head + shading_frag, problem);
  }
  return program.id();
}

GLuint Programs::classes(std::string* problem) {
  if (!classes_)
    classes_ = made(std::string(kVersion) + screen_vert,
                    std::string(kVersion) + sample_place_glsl + classes_frag, problem);
  return classes_.id();
}

GLuint Programs::shadow(bool cutout, bool instanced, std::string* problem) {
  GlProgram& program = shadow_[2 * cutout + instanced];
  if (!program) {
    const std::string version = kVersion + defined("INSTANCED", instanced);
    const std::string head = defined("MAPPED", cutout) + draw_glsl;
    program = made(version + defined("VERTEX", true) + head + model_vert,
                   version + head + cutout_text(cutout) + shadow_frag, problem);
  }
  return program.id();
}

GLuint Programs::ids(bool cutout, bool instanced, std::string* problem) {
  GlProgram& program = ids_[2 * cutout + instanced];
  if (!program) {
    const std::string version = kVersion + defined("INSTANCED", instanced);
    const std::string head = defined("MAPPED", cutout) + draw_glsl;
    program = made(version + defined("VERTEX", true) + head + model_vert,
                   version + head + cutout_text(cutout) + ids_frag, problem);
  }
  return program.id();
}

GLuint Programs::decal(std::string* problem) {
  if (!decal_)
    decal_ = made(kVersion + defined("DECAL", true) + draw_glsl + model_vert,
                  std::string(kVersion) + draw_glsl + decal_frag, problem);
  return decal_.id();
}

GLuint Programs::resolve(bool spread, std::string* problem) {
  GlProgram& program = resolve_[spread];
  if (!program)
    program = made(std::string(kVersion) + screen_vert,
                   kVersion + defined("SPREAD", spread) + resolve_frag, problem);
  return program.id();
}

GLuint Programs::runs(std::string* problem) {
  if (!runs_)
    runs_ = made(std::string(kVersion) + runs_vert, std::string(kVersion) + nothing_frag, problem);
  return runs_.id();
}

GLuint Programs::bare(std::string* problem) {
  if (!bare_)
    bare_ = made(std::string(kVersion) + draw_glsl + model_vert, std::string(kVersion) + bare_frag,
                 problem);
  return bare_.id();
}

}  // namespace panwright::preview
