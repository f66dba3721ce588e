// Scene of material samples: for each a sphere, a tilted tile and a wrinkled tile.
#pragma once

#include <cstdint>
#include <vector>

#include "pxn/materials.h"
#include "scene/scene.h"
#include "world/world.h"

namespace panwright::workspace {

// Lighting of the samples.
enum class SampleLight {
  sun,     // the Sun alone, as in space
  studio,  // with glowing walls and lamps around them, out of the camera's view: for display only
};

// Adds a shape to a scene, at a place and a rotation under its root.
void add_shape(scene::Scene& scene, const char* name, geometry::Shape shape, const Vec3& place,
               const Quat& rotation, std::int32_t material);

// Makes one material's samples side by side, within 3.6 × 1.2 m about the origin, seen from −y.
scene::Scene sample_scene(const pxn::DescribedMaterial& material, SampleLight light);

// Returns their camera, `width` pixels across and a third of it high. The tiles are oriented so
// that a mirror's glint just misses the viewer; in the studio they mirror a lamp behind the viewer.
world::Camera sample_camera(std::uint32_t width);
world::Sun sample_sun();

}  // namespace panwright::workspace
