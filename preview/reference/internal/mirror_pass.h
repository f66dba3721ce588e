// Mirrors by rays, for images that another engine has drawn. Private to
// preview/reference.
#pragma once

#include "base/job.h"
#include "preview/reference/internal/trace_scene.h"
#include "preview/reference/reference.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::preview::reference {

// Adds it to an image: see Reference::add_mirrored(). Throws Cancelled.
void add_mirrored(const TraceScene& scene, const world::World& world, const world::Camera& camera,
                  const MirrorOptions& options, image::Image& image, const Job& job);

}  // namespace panwright::preview::reference
