// Rays and solid angles of a camera's pixels. Private to preview/reference.
#pragma once

#include <cstdint>
#include <optional>

#include "base/math.h"
#include "geometry/ray/ray.h"
#include "world/camera.h"

namespace panwright::preview::reference {

// Returns the ray through a place on the image, in the camera's frame, unit direction. Orthographic
// rays start on the plane through the camera. Nothing: the camera's distortion has none there.
std::optional<geometry::Ray> view_ray(const world::Camera& camera, const Vec2& place);

// Returns the weight of a pixel's radiance in the total flux: its solid angle, steradians, or its
// area, m², for an orthographic camera. Exact to some roundings;
// with distortion that of its corners' rays, 0 where one has none.
double pixel_weight(const world::Camera& camera, std::uint32_t column, std::uint32_t row);

}  // namespace panwright::preview::reference
