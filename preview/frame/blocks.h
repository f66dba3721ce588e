// Conversion from double to the shaders' uniform blocks. Private to preview.
#pragma once

#include <cstddef>
#include <cstdint>

#include "preview/gl/programs.h"
#include "preview/model/draw_list.h"
#include "world/world.h"

namespace panwright::preview {

// Copies columns one after the other: 16 numbers.
inline void copy_floats(const Mat4& from, float* to) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) *to++ = static_cast<float>(from[column][row]);
}

// Copies columns, each padded to 4: 12 numbers.
inline void copy_floats(const Mat3& from, float* to) {
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) *to++ = static_cast<float>(from[column][row]);
    *to++ = 0;
  }
}

inline void copy_floats(const Vec3& from, float* to) {
  for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(from[k]);
}

// Returns the irradiance in parts of which shading.frag tells errors: that of the Sun's strongest
// band, or of white's where the Sun is off.
inline double told_irradiance(const world::World& world) {
  const double sun = max_component(world.sun().irradiance.value_or(Vec3(1)));
  if (sun > 1e-30) return sun;
  const double white = max_component(world.white());
  return white > 1e-30 ? white : 1;
}

// Restricts drawing to some sides of triangles.
inline void cull(const GladGLContext& gl, Sides drawn) {
  drawn == Sides::both ? gl.Disable(GL_CULL_FACE) : gl.Enable(GL_CULL_FACE);
  gl.CullFace(drawn == Sides::back ? GL_FRONT : GL_BACK);
}

// Copies the repeat of an item's maps, and the directions of their bumps: a back's point out of it.
inline void copy_repeat(const DrawItem& item, DrawBlock& block) {
  constexpr std::uint32_t kTurned[] = {kBumpsTurnedU, kBumpsTurnedV};
  for (int axis = 0; axis < 2; ++axis) {
    block.repeat[axis] = static_cast<float>(item.repeat[axis]);
    if ((item.repeat[axis] < 0) != (item.sides == Sides::back)) block.flags |= kTurned[axis];
  }
}

}  // namespace panwright::preview
