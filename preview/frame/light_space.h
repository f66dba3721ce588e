// Light-space transforms. Private to preview; nothing here needs OpenGL.
#pragma once

#include <span>

#include "preview/model/draw_list.h"

namespace panwright::preview {

// Box in light space: x and y run across it from -1 to 1, z from 0 on the far side to 1 towards the
// Sun.
struct LightSpace {
  Mat4 sun_from_model{1};
  Mat3 sun_normal_from_model{1};  // maps normals to normals of any length
  Vec3 extent{1};                 // of the box, metres
  Mat3 axes_from_model{1};        // x, y and towards the Sun, unscaled
};

// Fits the box to the corners of the visible items' boxes, two texels wider all round: it depends
// on the model and the Sun alone, so the shadow is the same from every camera. x lies along the
// longest axis of the model in projection along the Sun's direction.
//
//   to_sun  model frame, unit
//   side    texels, > 4
LightSpace fitted_light_space(std::span<const DrawItem> list, const Vec3& to_sun, unsigned side);

// Widens the box by a factor of its depth on each side, for rays to the edge of the Sun's disc.
LightSpace widened(LightSpace frame, double tangent);

// Returns the shear that moves places along the ray to a point of the Sun's disc, to the middle of
// the box: x' = x − shear.x·(z − ½).
//
//   point  on the disc, tangents along x and y
Vec2 sun_shear(const Vec3& extent, const Vec2& point);
Mat4 sheared(const Vec2& shear);

}  // namespace panwright::preview
