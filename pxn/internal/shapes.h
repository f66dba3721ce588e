// Readers of single elements: materials, frames, meshes.
#pragma once

#include <memory>

#include "geometry/mesh.h"
#include "materials/material.h"
#include "pxn/internal/part.h"
#include "pxn/internal/reporter.h"
#include "pxn/internal/values.h"

namespace panwright::pxn {

// Reads a <material>. A field that cannot be read is left out.
//
// Reports: E1201 to E1203.
materials::Fields read_material(const xml::Document& document, std::uint32_t element,
                                Values& values);

// Reads a <frame_s>: its origin and axes.
//
// Fails (nullopt): E1201 to E1203, E1207. Reports: N1208.
std::optional<PartFrame> read_frame_axes(const xml::Document& document, std::uint32_t element,
                                         Values& values, Reporter& reporter);

// Reads a <mesh>: strips to triangles, normals made unit or computed.
//
//   returns  sound by scene::check, with at least one triangle; null where too little can be read
//
// Reports: E1201 to E1203, W1205, E2001, E2002, E2004, N2005, W2006 to W2009.
// Cost: O(bytes + T log(triangles at a vertex)).
std::shared_ptr<const geometry::Mesh> read_mesh_shape(const xml::Document& document,
                                                      std::uint32_t element, double crease_angle,
                                                      Values& values, Reporter& reporter);

}  // namespace panwright::pxn
