// Bodies and the Sun's disc behind the targets. Private to preview/reference.
#pragma once

#include <cstdint>
#include <span>

#include "base/job.h"
#include "preview/reference/internal/cells.h"
#include "preview/reference/internal/trace_scene.h"
#include "preview/reference/reference.h"
#include "world/world.h"

namespace panwright::preview::reference {

// Adds what rays find that meet no target before it, and its error: jittered points of each pixel,
// moved by the PSF. Rays of their own, so that targets do not see what the samples of theirs saw.
//
//   cells   parts of the image with targets
void add_backdrop(const world::World& world, const TraceScene& scene, const world::Camera& camera,
                  std::span<const Cell> cells, const ReferenceOptions& options,
                  ReferenceImage& result, const Job& job);

}  // namespace panwright::preview::reference
