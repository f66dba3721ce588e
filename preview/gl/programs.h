// Shader programs, built on first use and kept. Private to preview.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "materials/material.h"
#include "preview/gl/gl_objects.h"
#include "preview/gl/uniforms.h"
#include "preview/gl/variant.h"

namespace panwright::preview {

// Set of layers, that of positions apart, a bit for each: the first always, paint below roughness
// and roughness below tangents.
using LayerSet = unsigned;
constexpr bool has(LayerSet set, Layer layer) { return (set >> layer & 1) != 0; }

// All programs of a device, shared by its models and identified by their function.
class Programs {
 public:
  explicit Programs(const GladGLContext& gl) : gl_(gl) {}

  // Each requests a program on first use without waiting; settle() waits.
  //
  // instanced: draws up to kInstancesAtOnce instances of one mesh and material at once
  GLuint geometry(const Variant& variant, bool flat, LayerSet layers, bool shadows, bool instanced);
  // Light that one pass adds; point_lamps: without a size; eclipsed: the Sun behind limbs that
  // bend.
  enum class Lit {
    sun,
    sun_and_planets,
    sun_and_surfaces,
    all_but_lamps,
    lamps,
    point_lamps,
    eclipsed,
    eclipsed_and_planets,
    eclipsed_and_surfaces,
    all_eclipsed
  };
  GLuint shading(const materials::BrdfModel& brdf_model, LayerSet layers, bool one_material,
                 bool shadows, Lit lit);
  GLuint classes();
  GLuint all_samplers();
  GLuint shadow(bool cutout, bool instanced);
  GLuint ids(bool cutout, bool instanced);
  GLuint decal();
  GLuint bare();
  // of sampling.h
  GLuint resolve(bool spread);
  GLuint runs();

  // Waits for the requested programs. False when the driver refuses a shader: *problem has the
  // reason, and the next use requests it again.
  bool settle(std::string* problem);

  std::uint64_t built() const { return built_; }
  double seconds() const { return seconds_; }  // of this thread, for all of them

 private:
  // the texts after the version and uniforms.glsl
  GlProgram requested(const std::string& vertex, const std::string& fragment);
  void forget(GLuint program);

  const GladGLContext& gl_;
  std::vector<GLuint> waiting_;
  std::map<unsigned, GlProgram> geometry_;
  std::map<std::pair<materials::BrdfModel, unsigned>, GlProgram> shading_;
  GlProgram classes_;
  GlProgram all_samplers_;
  std::array<GlProgram, 4> shadow_;
  std::array<GlProgram, 4> ids_;
  GlProgram decal_;
  GlProgram bare_;
  std::array<GlProgram, 2> resolve_;
  GlProgram runs_;
  std::uint64_t built_ = 0;
  double seconds_ = 0;
};

}  // namespace panwright::preview
