// Forms of foil: a sheet bent over a body, as a triangle mesh.
#pragma once

#include <variant>

#include "geometry/mesh.h"
#include "mli/sheet.h"

namespace panwright::mli {

// The sheet as it is, z = height, its middle at the origin.
struct Flat {};

// Around z from z = 0 to `length`; flanges of the given width stand out at both ends.
struct Tube {
  double radius = 0;  // 0: as the sheet is wide, width/2π
  double length = 0;  // 0: as the sheet is high, less both flanges
  double flange = 0;
};

// A frustum around z, flanged like a tube; top_radius 0: an apex, without a flange there.
struct Cone {
  double radius = 0;  // at z = 0
  double top_radius = 0;
  double length = 0;
  double flange = 0;
};

// In the plane z = 0 about the origin; its border is turned down by 90° over the flange's width.
struct Disc {
  double radius = 0;
  double flange = 0;
};

// About the origin. Each face lies flat within `flange` of its edges and rises to the sheet's
// heights over as much again.
struct Box {
  Vec3 size{0, 0, 0};  // above twice the flange each
  double flange = 0;   // above 0
};

using Form = std::variant<Flat, Tube, Cone, Disc, Box>;

// A sheet in a form, metres. Triangles are counter-clockwise from outside, where heights are
// positive; texture coordinates are the place on the flat sheet, metres.
//
// Cells are as large as the sheet's. Tubes are rolled up, cones and discs are cut out of the flat
// sheet, boxes are cut out as four sides in a row with both ends at the first of them, so that
// wrinkles are not stretched (a flange is by its width over the radius). Where the two sides of a
// tube or cone meet, half of the step between them is taken from each, fading out over a twentieth
// of the circumference. Beside a flange's corner heights lean towards the bisector.
//
// A box is closed; tubes and cones are but for their ends. The normals are left empty.
// Fails: E7001: a size that is none, a sheet too small for the form, above kMaxVertices.
// Reports: W7002 where heights are larger than the form leaves room for. Cost: O(vertices).
Result<geometry::Mesh> formed(const Sheet& sheet, const Form& form, DiagnosticLog& log,
                              const SourceSpan& where = {});

}  // namespace panwright::mli
