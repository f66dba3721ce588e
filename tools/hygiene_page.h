// What cleaning found, as a page that a browser shows.
#pragma once

#include <string>

#include "importers/hygiene.h"
#include "scene/scene.h"
#include "workspace/open.h"

namespace panwright::tools {

// One HTML page: the figures of the whole and of each mesh, and pictures of the worst spots, each
// in a ring. Without OpenGL, or for a scene that does not compile, without pictures.
std::string hygiene_page(const importers::Hygiene& hygiene, const scene::Scene& scene,
                         const std::string& input, const workspace::OpenOptions& options);

}  // namespace panwright::tools
