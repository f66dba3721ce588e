// Variants of shader programs. Private to preview; nothing here needs OpenGL.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>

namespace panwright::preview {

// Shader variant of an instance, except for RenderOptions::flat.
struct Variant {
  std::uint32_t shading = 0;  // variant of the material
  bool textured = false;
  bool colored = false;
  bool albedo_map = false;
  bool normal_map = false;
  bool roughness_map = false;
  bool reflectance_map = false;  // of a material with microfacets
  bool cutout = false;
  bool cells = false;
  bool brushed = false;   // its light depends on the direction along u
  bool tangents = false;  // of each vertex: a normal map, or brushed with texture coordinates
  // a narrow lobe on a mesh whose normals turn within triangles: its mean is taken if they turn by
  // more than its width from sample to sample
  bool curved = false;
  auto operator<=>(const Variant&) const = default;
};

}  // namespace panwright::preview
