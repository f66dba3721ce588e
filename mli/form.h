// Forms of foil: sheets bent over a body, as triangle meshes.
#pragma once

#include <variant>

#include "geometry/mesh.h"
#include "mli/sheet.h"

namespace panwright::mli {

// The sheet itself, z = height, its middle at the origin.
struct Flat {};

// Tube around z from z = 0 to `length`; flanges of the given width at both ends.
struct Tube {
  double radius = 0;  // 0: from the sheet's width, width/2π
  double length = 0;  // 0: the sheet's height, less both flanges
  double flange = 0;
};

// A frustum around z, flanged like a tube; top_radius 0: an apex, without a flange there.
struct Cone {
  double radius = 0;  // at z = 0
  double top_radius = 0;
  double length = 0;
  double flange = 0;
};

// Disc in the plane z = 0 about the origin; its border is bent down by 90° over the flange's width.
struct Disc {
  double radius = 0;
  double flange = 0;
};

// Box about the origin. Each face is flat within `flange` of its edges and rises to the sheet's
// heights over another flange.
struct Box {
  Vec3 size{0, 0, 0};  // above twice the flange each
  double flange = 0;   // above 0
};

using Form = std::variant<Flat, Tube, Cone, Disc, Box>;

// Bends a sheet into a form, metres. Triangles are counter-clockwise from outside, where heights
// are positive; texture coordinates are positions on the flat sheet, metres.
//
// Cells are as large as the sheet's. Tubes are rolled up, cones and discs are cut out of the flat
// sheet. Boxes are cut out as four sides in a row with both ends at the first. So wrinkles are not
// stretched (a flange is, by its width over the radius). At the joint of a tube or cone, half of
// the step is removed from each side, fading out over a twentieth of the circumference. Beside a
// flange's corner heights lean towards the bisector.
//
// A box is closed; tubes and cones are but for their ends. The normals are left empty.
// Fails: E7001: an invalid size, a sheet too small for the form, above kMaxVertices.
// Reports: W7002 for heights beyond the room of the form. Cost: O(vertices).
Result<geometry::Mesh> formed(const Sheet& sheet, const Form& form, DiagnosticLog& log,
                              const SourceSpan& where = {});

}  // namespace panwright::mli
