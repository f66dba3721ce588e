// Scene of a single sheet of foil.
#pragma once

#include <cstdint>

#include "base/result.h"
#include "materials/material.h"
#include "mli/sheet.h"
#include "scene/scene.h"
#include "workspace/material_scene.h"
#include "world/world.h"

namespace panwright::tools {

// Makes a scene of the flat sheet about the origin, seen from +z; in the studio, with walls and
// lamps around it, scaled to its size.
//
//   material  its maps are left out
// Fails: as mli::formed().
Result<scene::Scene> foil_scene(const mli::Sheet& sheet, const materials::Material& material,
                                workspace::SampleLight light, DiagnosticLog& log);

// Returns its camera: +y up, the sheet fills an image `width` pixels across, of the sheet's aspect
// ratio.
world::Camera foil_camera(const mli::Sheet& sheet, std::uint32_t width);
// Returns the height of that camera's image, pixels, at least 1.
std::uint32_t foil_image_height(const mli::Sheet& sheet, std::uint32_t width);
// Returns a Sun from the upper left, 48° from the normal.
world::Sun foil_sun();

}  // namespace panwright::tools
