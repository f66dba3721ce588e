// Shader programs, built on first use and kept. Private to preview.
#pragma once

#include <array>
#include <string>

#include "base/diagnostic.h"
#include "preview/internal/draw_list.h"
#include "preview/internal/gl_objects.h"

namespace panwright::preview {

// Binding points that the shaders name.
inline constexpr GLuint kViewBinding = 0;      // uniform
inline constexpr GLuint kDrawBinding = 1;      // uniform
inline constexpr GLuint kMaterialBinding = 2;  // uniform
inline constexpr GLuint kNormalsBinding = 0;   // storage: normals of triangles
inline constexpr GLuint kTextureUnit = 0;

// Uniform blocks, in std140.
struct alignas(16) ViewBlock {
  float sight[4];        // world direction through the tile's upper left corner, any length
  float sight_right[4];  // its change from sample to sample
  float sight_down[4];
  float to_sun[4];      // world, unit
  float irradiance[4];  // RGB
};
struct alignas(16) DrawBlock {
  float clip_from_mesh[16];          // columns
  float world_normal_from_mesh[12];  // columns of 3, each padded to 4
  std::uint32_t id[4];               // x: item + 1
};

class Programs {
 public:
  explicit Programs(const GladGLContext& gl) : gl_(gl) {}

  // 0 when the driver refuses a shader: *problem says why.
  GLuint surface(const Variant& variant, bool flat, std::string* problem);
  GLuint ids(std::string* problem);
  GLuint bare(std::string* problem);

 private:
  const GladGLContext& gl_;
  std::array<GlProgram, 3 * 3 * 2 * 2 * 2> surface_;
  GlProgram ids_;
  GlProgram bare_;
};

}  // namespace panwright::preview
