// Meshes that a model gives by its own numbers.
#pragma once

#include <memory>

#include "geometry/mesh.h"
#include "importers/mjcf/internal/attributes.h"

namespace panwright::importers::mjcf {

// Reads a <mesh> of vertex and face, with normal and texcoord of each vertex if given; without face
// it is the convex hull of the vertices. Null: there is none, reported as E6220 or E6002.
std::shared_ptr<const geometry::Mesh> mesh_of_vertices(const pugi::xml_node& element,
                                                       std::size_t its_class,
                                                       Attributes& attributes,
                                                       meshes::ReaderContext& context);

}  // namespace panwright::importers::mjcf
