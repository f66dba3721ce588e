// Parts → scene: includes multiplied out, appearances inherited, nodes named.
#pragma once

#include "pxn/reader/loader.h"
#include "pxn/pxn.h"
#include "pxn/text/reporter.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Fills in the scene's nodes, instances, frames and materials. Its shapes and textures are there.
//
//   returns  false when the model has more nodes than the limit
//
// Reports: E1008, E1210, E1304, E2010, and what materials::resolved reports.
bool assemble(const Loader& loader, std::uint32_t top, const Options& options, Reporter& reporter,
              scene::Scene& scene);

}  // namespace panwright::pxn
