// A scene that shows a sheet of foil by itself.
#pragma once

#include <cstdint>

#include "base/result.h"
#include "materials/material.h"
#include "mli/sheet.h"
#include "scene/scene.h"
#include "workspace/material_scene.h"
#include "world/world.h"

namespace panwright::tools {

// The flat sheet about the origin, seen from +z; in the studio walls and lamps stand around it, by
// its size.
//
//   material  its maps are left out
// Fails: as mli::formed().
Result<scene::Scene> foil_scene(const mli::Sheet& sheet, const materials::Material& material,
                                workspace::SampleLight light, DiagnosticLog& log);

// What sees it: +y up, so that the sheet fills an image `width` pixels across and as high as its
// own sides ask for.
world::Camera foil_camera(const mli::Sheet& sheet, std::uint32_t width);
// Pixels up of that camera, 1 at least.
std::uint32_t foil_image_height(const mli::Sheet& sheet, std::uint32_t width);
// From the upper left, 48° from the normal.
world::Sun foil_sun();

}  // namespace panwright::tools
