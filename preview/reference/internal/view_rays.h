// A camera's pixels as rays and as solid angles. Private to preview/reference.
#pragma once

#include <cstdint>

#include "base/math.h"
#include "geometry/ray/ray.h"
#include "world/camera.h"

namespace panwright::preview::reference {

// The ray through a place on the image, in the camera's frame, unit direction. Orthographic rays
// start on the plane through the camera.
geometry::Ray view_ray(const world::Camera& camera, const Vec2& place);

// What a pixel's radiance is multiplied by in the total flux: its solid angle, steradians, or its
// area, m², for an orthographic camera. Exact to some roundings.
double pixel_weight(const world::Camera& camera, std::uint32_t column, std::uint32_t row);

}  // namespace panwright::preview::reference
