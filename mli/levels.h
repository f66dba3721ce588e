// Levels of detail of a sheet: coarser sheets, and what they lost.
#pragma once

#include <vector>

#include "base/job.h"
#include "geometry/mesh.h"
#include "mli/form.h"
#include "mli/sheet.h"

namespace panwright::mli {

struct Level {
  geometry::Mesh mesh;  // with normals
  double detail = 0;    // metres, the width of a cell: for pixels that see this or more
  // Metres, of the form's surface: the largest difference of heights at the finest sheet's
  // vertices, and the depth of a chord on the form.
  double error = 0;
  Covariance removed;  // of the facets' slopes along the texture coordinates
};

// Each level has half the cells across of the one before, filtered() from the finest sheet; levels
// end where cells are as few as the form allows: 2 for a flat sheet, 48 for others, so that outlines
// stay round (a polygon of 48 sides covers 0.9971 of its circle). A level that the form refuses
// ends them, too.
//
//   crease_angle  radians, of compute_normals()
//   max_vertices  of all levels together; those beyond are left out, the finest first
// Cost: O(vertices of the sheet) for each level.
std::vector<Level> levels_of(const Sheet& sheet, const Form& form, double crease_angle,
                             double max_vertices, const Job& job = {});

// The largest distance between the heights of two sheets over the same rectangle, at the vertices
// of the finer one, metres. The coarser one is linear in its triangles.
double height_error(const Sheet& fine, const Sheet& coarse);

}  // namespace panwright::mli
