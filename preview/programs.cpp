#include "preview/internal/programs.h"

#include "materials/formula_text.h"
#include "preview/internal/shader_text.h"

namespace panwright::preview {
namespace {

constexpr const char* kVersion = "#version 450 core\n";

GLuint built(const GladGLContext& gl, GlProgram& program, const std::string& vertex,
             const std::string& fragment, std::string* problem) {
  if (!program) program = make_program(gl, vertex, fragment, problem);
  return program.id();
}

}  // namespace

GLuint Programs::surface(const Variant& variant, bool flat, std::string* problem) {
  const std::size_t index = (((static_cast<std::size_t>(variant.diffuse) * 3 +
                               static_cast<std::size_t>(variant.specular)) *
                                  2 +
                              variant.textured) *
                                 2 +
                             variant.coloured) *
                                2 +
                            flat;
  if (surface_[index]) return surface_[index].id();
  std::string head = kVersion;
  head += "#define SURFACE\n";
  if (variant.textured) head += "#define TEXTURED\n";
  if (variant.coloured) head += "#define COLOURED\n";
  if (flat) head += "#define FLAT\n";
  return built(gl_, surface_[index], head + model_vert,
               head + materials::glsl_formulas(variant.diffuse, variant.specular) + surface_frag,
               problem);
}

GLuint Programs::ids(std::string* problem) {
  return built(gl_, ids_, std::string(kVersion) + model_vert, std::string(kVersion) + ids_frag,
               problem);
}

GLuint Programs::bare(std::string* problem) {
  return built(gl_, bare_, std::string(kVersion) + model_vert, std::string(kVersion) + bare_frag,
               problem);
}

}  // namespace panwright::preview
