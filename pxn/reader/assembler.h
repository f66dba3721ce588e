// Assembly of parts into a scene: includes expanded, appearances inherited, nodes named.
#pragma once

#include "pxn/pxn.h"
#include "pxn/reader/loader.h"
#include "pxn/text/reporter.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Adds the scene's nodes, instances, frames and materials. Its shapes and textures are complete.
//
//   returns  false when the model has more nodes than the limit
//
// Reports: E1008, E1210, E1304, E2010, and those of materials::resolved.
bool assemble(const Loader& loader, std::uint32_t top, const Options& options, Reporter& reporter,
              scene::Scene& scene);

}  // namespace panwright::pxn
