// Shader programs, built on first use and kept. Private to preview.
#pragma once

#include <array>
#include <string>

#include "base/diagnostic.h"
#include "preview/internal/draw_list.h"
#include "preview/internal/gl_objects.h"

namespace panwright::preview {

// Binding points that the shaders name.
inline constexpr GLuint kViewBinding = 0;  // uniform blocks
inline constexpr GLuint kDrawBinding = 1;
inline constexpr GLuint kMaterialBinding = 2;
inline constexpr GLuint kDiffuseMapUnit = 0;  // textures
inline constexpr GLuint kTriangleNormalsUnit = 1;
inline constexpr GLuint kSeenUnit = 2;
inline constexpr GLuint kTintUnit = 3;
inline constexpr GLuint kMaterialsUnit = 4;
inline constexpr GLuint kItemsUnit = 5;

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

inline constexpr std::uint32_t kLawPairs = 9;
inline std::uint32_t law_pair(const Variant& variant) {
  return static_cast<std::uint32_t>(variant.diffuse) * 3 +
         static_cast<std::uint32_t>(variant.specular);
}

class Programs {
 public:
  explicit Programs(const GladGLContext& gl) : gl_(gl) {}

  // Each returns 0 when the driver refuses a shader: *problem says why.
  //
  // tinted: the tile has a second colour buffer, for textures and vertex colours.
  GLuint geometry(const Variant& variant, bool flat, bool tinted, std::string* problem);
  GLuint shading(std::uint32_t pair, bool tinted, bool one_material, std::string* problem);
  GLuint ids(std::string* problem);
  GLuint bare(std::string* problem);

 private:
  const GladGLContext& gl_;
  std::array<GlProgram, 2 * 2 * 2 * 2> geometry_;
  std::array<GlProgram, kLawPairs * 2 * 2> shading_;
  GlProgram ids_;
  GlProgram bare_;
};

}  // namespace panwright::preview
