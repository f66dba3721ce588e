#include "preview/internal/programs.h"

#include <fmt/format.h>

#include "materials/formula_text.h"
#include "preview/internal/shader_text.h"

namespace panwright::preview {
namespace {

constexpr const char* kVersion = "#version 450 core\n";

}  // namespace

GLuint Programs::geometry(const Variant& variant, bool flat, bool tinted, std::string* problem) {
  GlProgram& program =
      geometry_[((variant.textured * 2u + variant.coloured) * 2u + flat) * 2u + tinted];
  if (!program) {
    std::string head = std::string(kVersion) + "#define GEOMETRY\n";
    if (tinted) head += "#define TINTED\n";
    if (variant.textured) head += "#define TEXTURED\n";
    if (variant.coloured) head += "#define COLOURED\n";
    if (flat) head += "#define FLAT\n";
    program = make_program(gl_, head + model_vert, head + geometry_frag, problem);
  }
  return program.id();
}

GLuint Programs::shading(std::uint32_t pair, bool tinted, bool one_material, std::string* problem) {
  GlProgram& program = shading_[(pair * 2 + tinted) * 2 + one_material];
  if (!program) {
    std::string head = fmt::format("{}#define PAIR {}u\n", kVersion, pair);
    if (tinted) head += "#define TINTED\n";
    if (one_material) head += "#define ONE_MATERIAL\n";
    head += materials::glsl_formulas(static_cast<materials::DiffuseLaw>(pair / 3),
                                     static_cast<materials::SpecularLaw>(pair % 3));
    program = make_program(gl_, std::string(kVersion) + screen_vert, head + shading_frag, problem);
  }
  return program.id();
}

GLuint Programs::ids(std::string* problem) {
  if (!ids_)
    ids_ = make_program(gl_, std::string(kVersion) + model_vert, std::string(kVersion) + ids_frag,
                        problem);
  return ids_.id();
}

GLuint Programs::bare(std::string* problem) {
  if (!bare_)
    bare_ = make_program(gl_, std::string(kVersion) + model_vert, std::string(kVersion) + bare_frag,
                         problem);
  return bare_.id();
}

}  // namespace panwright::preview
