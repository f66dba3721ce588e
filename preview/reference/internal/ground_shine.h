// Light that sunlit terrain sends to a target, by rays. Private to preview/reference.
#pragma once

#include <cstdint>
#include <span>

#include "base/job.h"
#include "light/ground_shine.h"
#include "preview/reference/internal/bodies.h"
#include "preview/reference/internal/sun.h"
#include "preview/reference/internal/trace_scene.h"
#include "world/world.h"

namespace panwright::preview::reference {

// Finds the light of terrain at the middle of a target: of directions in even steps the Sun's that
// the ground sends, shaded by terrain and targets. Moves the observer of the scene.
//
//   suns, bodies  one for each target of the world; bodies: none without
// Lets Cancelled pass. The same bits for any number of threads. Cost: 4,096 rays, and one to the
// Sun from each that meets ground.
light::GroundShine ground_shine(TraceScene& scene, std::span<const Sun> suns,
                                std::span<const Bodies> bodies, std::uint32_t target,
                                const Job& job);

}  // namespace panwright::preview::reference
