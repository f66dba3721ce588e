// A scene that shows materials: for each a sphere, a tilted tile and a wrinkled tile.
#pragma once

#include <cstdint>
#include <vector>

#include "pxn/materials.h"
#include "scene/scene.h"
#include "world/world.h"

namespace panwright::tools {

// One material's samples side by side, within 3.6 × 1.2 m about the origin, seen from −y.
scene::Scene sample_scene(const pxn::DescribedMaterial& material);

// What sees them, `width` pixels across and a third of it high. The tiles are turned
// so that a mirror's glint just misses the viewer.
world::Camera sample_camera(std::uint32_t width);
world::Sun sample_sun();

}  // namespace panwright::tools
