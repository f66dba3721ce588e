// Imported trees below nodes of a scene.
#pragma once

#include <span>

#include "pxn/internal/imported_model.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Appends what a CAD file holds below a node, without what is removed: nodes that hold nothing any
// more stay out. materials: of each instance, in the scene.
void graft(const ImportedModel& model, const PartImport& place,
           std::span<const std::int32_t> materials, std::int32_t below, scene::Scene& scene);

}  // namespace panwright::pxn
