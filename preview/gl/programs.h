// Shader programs, built on first use and kept. Private to preview.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "materials/material.h"
#include "preview/gl/gl_objects.h"
#include "preview/gl/variant.h"

namespace panwright::preview {

// Binding points named by the shaders.
inline constexpr GLuint kViewBinding = 0;  // uniform blocks
inline constexpr GLuint kDrawBinding = 1;
inline constexpr GLuint kMaterialBinding = 2;
inline constexpr GLuint kDecalBinding = 3;
inline constexpr GLuint kShadowBinding = 4;
inline constexpr GLuint kDiffuseMapUnit = 0;  // textures
inline constexpr GLuint kTriangleNormalsUnit = 1;
inline constexpr GLuint kNormalUnit = 2;
inline constexpr GLuint kAlbedoUnit = 3;
inline constexpr GLuint kMaterialsUnit = 4;
inline constexpr GLuint kItemsUnit = 5;
inline constexpr GLuint kRoughnessUnit = 6;
inline constexpr GLuint kAlbedoMapUnit = 7;
inline constexpr GLuint kNormalMapUnit = 8;
inline constexpr GLuint kRoughnessMapUnit = 9;
inline constexpr GLuint kCutoutMapUnit = 10;
inline constexpr GLuint kDecalUnit = 11;
inline constexpr GLuint kSunUnit = 12;
inline constexpr GLuint kShadowDepthsUnit = 13;
inline constexpr GLuint kShadowSlopesUnit = 14;
inline constexpr GLuint kTangentUnit = 15;
inline constexpr GLuint kReflectanceMapUnit = 16;
inline constexpr GLuint kReflectanceUnit = 17;
inline constexpr GLuint kSamplesUnit = 18;  // of resolve.frag
inline constexpr GLuint kBlocksUnit = 19;
inline constexpr GLuint kSlopeMapUnit = 20;
inline constexpr GLint kRangeLocation = 0;  // uniforms
inline constexpr GLint kDepthLocation = 1;
inline constexpr GLint kBlocksLocation = 2;
inline constexpr GLint kLobeLocation = 0;  // of geometry.frag

// Per-sample data kept between the two steps of a drawing.
enum Layer : unsigned {
  kNormalLayer,
  kAlbedoLayer,
  kRoughnessLayer,
  kTangentLayer,
  kReflectanceLayer,
  kSunLayer,  // position in light space, with shadows
  kLayers
};
// Set of layers, the Sun's apart, a bit for each: the first always, paint below roughness and
// roughness below tangents.
using LayerSet = unsigned;
constexpr bool has(LayerSet set, Layer layer) { return (set >> layer & 1) != 0; }

// Uniform blocks, in std140.
struct alignas(16) ViewBlock {
  float view_ray[4];  // world direction through the tile's upper left corner, any length; limb
                      // darkening of the Sun's disc
  float view_ray_right[4];  // its change from sample to sample
  float view_ray_down[4];
  float to_sun[4];      // world, unit; w: an eighth of the square of the disc's radius
  float irradiance[4];  // RGB; w: 1 to predict errors
  float white[4];       // RGB of emission 1, times pi; w: told_irradiance()
};
struct alignas(16) DrawBlock {
  float clip_from_mesh[16];          // columns
  float world_normal_from_mesh[12];  // columns of 3, each padded to 4
  std::uint32_t id[4];    // x: item + 1; y, z: samples left of and above the tile; w: 1 for shadows
                          // of the flat triangles
  float diffuse[4];       // RGB; parts a side for averaging cells
  float repeat[4];        // of maps: x, y, and their signs
  float cells[4];         // their count along u and v, their gaps
  float gap_color[4];     // RGB, fingers
  float finger_color[4];  // RGB, their width
  float sun_from_mesh[12];         // rows of 4, as in LightSpace
  float sun_normal_from_mesh[12];  // columns of 3, each padded to 4
  float normal_offset[4];  // x: normal offset of a point before lighting, mesh frame; others:
                           // diffuse light returned by the glass over cells
  float tiles[48];         // of the shadow map: transforms from tile to tile
};
static_assert(sizeof(DrawBlock) == 512 && kInstancesAtOnce == 32);  // draw.glsl
struct alignas(16) DecalBlock {
  float place[12];  // rows of 4: from positions to image coordinates and height over depth
  float outwards[4];
};

// All programs of a device, shared by its models and identified by their function.
class Programs {
 public:
  explicit Programs(const GladGLContext& gl) : gl_(gl) {}

  // Each requests a program on first use without waiting; settle() waits.
  //
  // instanced: draws up to kInstancesAtOnce instances of one mesh and material at once
  GLuint geometry(const Variant& variant, bool flat, LayerSet layers, bool shadows, bool instanced);
  GLuint shading(const materials::BrdfModel& brdf_model, LayerSet layers, bool one_material,
                 bool shadows);
  GLuint classes();
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
  GlProgram requested(const std::string& vertex, const std::string& fragment);
  void forget(GLuint program);

  const GladGLContext& gl_;
  std::vector<GLuint> waiting_;
  std::map<unsigned, GlProgram> geometry_;
  std::map<std::pair<materials::BrdfModel, unsigned>, GlProgram> shading_;
  GlProgram classes_;
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
