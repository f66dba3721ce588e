// Shape model of a small body as a scene.
#pragma once

#include <string>

#include "scene/scene.h"
#include "terrain/shape.h"

namespace panwright::workspace {

// Scene of one node with the plates of a shape model, in body-fixed axes, of the regolith that
// terrain has: smooth normals are the means of the plates' around a vertex, by their area. Plates
// without an area are left out.
//
//   name  of the node and its mesh
scene::Scene shape_scene(const terrain::Shape& shape, const std::string& name);

}  // namespace panwright::workspace
