// Imported trees below nodes of a scene.
#pragma once

#include <map>
#include <span>

#include "pxn/build/imported_model.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Shapes of the scene without their vertex colours, by those that have them.
using PlainShapes = std::map<std::int32_t, std::int32_t>;

// Appends what a CAD file holds below a node, without what is removed: nodes that hold nothing any
// more stay out. What is assigned a material loses the colours of its vertices with its texture.
//
//   materials  of each instance, in the scene
//   plain      of all places of the scene; grows
void attach(const ImportedModel& model, const PartImport& place,
            std::span<const std::int32_t> materials, std::int32_t below, PlainShapes& plain,
            scene::Scene& scene);

}  // namespace panwright::pxn
