// Conversion of OpenCASCADE bodies to meshes and exact shapes.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "geometry/tessellate/shape.h"

namespace panwright::importers::step {

inline constexpr double kMetre = 1000;  // of the reader's unit, which is the millimetre

// Faces of a body with equal appearance.
struct Patch {
  std::int32_t color = 0;  // as given for each face
  std::shared_ptr<geometry::Mesh> mesh;
};

struct Meshed {
  std::vector<Patch> patches;     // by colour, ascending
  std::vector<TopoDS_Face> lost;  // not meshable
};

// Triangulates the faces of a body. Faces that share an edge share its points, bit for bit, across
// patches too; normals are those of the surfaces, so that edges are creased where surfaces are.
//
//   body        its location counts
//   colours     one per face, in the order of TopExp_Explorer; any numbers
//   deflection  metres, > 0
//   returns     metres; triangles are counter-clockwise seen from outside
//
// Throws exceptions of OpenCASCADE.
Meshed meshed(const TopoDS_Shape& body, std::span<const std::int32_t> colors, double deflection);

// Estimates the triangles of meshed() from curvatures at a few points of each face, to refuse
// bodies beyond any memory.
double expected_triangles(const TopoDS_Shape& body, double deflection);

// Exact shape of a body, and its place.
struct Exact {
  geometry::Shape shape;    // metres
  Mat4 body_from_shape{1};  // rigid
};

// Recognises a solid that is one sphere, torus, cylinder, cone, frustum, block or straight pipe:
// all faces lie on its surfaces, and area and volume agree. Nothing for others.
std::optional<Exact> exact_of(const TopoDS_Shape& body);

}  // namespace panwright::importers::step
