// A scene that shows materials: for each a sphere, a tilted tile and a wrinkled tile.
#pragma once

#include <cstdint>
#include <vector>

#include "pxn/materials.h"
#include "scene/scene.h"
#include "world/world.h"

namespace panwright::workspace {

// What lights the samples.
enum class SampleLight {
  sun,     // the Sun alone, as in space
  studio,  // and glowing walls and lamps around them, out of the camera's view: for display only
};

// Puts a shape into a scene, at a place and a rotation under its root.
void add_shape(scene::Scene& scene, const char* name, geometry::Shape shape, const Vec3& place,
               const Quat& rotation, std::int32_t material);

// One material's samples side by side, within 3.6 × 1.2 m about the origin, seen from −y.
scene::Scene sample_scene(const pxn::DescribedMaterial& material, SampleLight light);

// What sees them, `width` pixels across and a third of it high. The tiles are turned
// so that a mirror's glint just misses the viewer; in the studio they mirror a lamp behind the
// viewer.
world::Camera sample_camera(std::uint32_t width);
world::Sun sample_sun();

}  // namespace panwright::workspace
