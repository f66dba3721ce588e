// Levels of detail of a sheet: coarser sheets that glint alike.
#pragma once

#include <vector>

#include "base/job.h"
#include "geometry/mesh.h"
#include "mli/form.h"
#include "mli/sheet.h"
#include "mli/trim.h"

namespace panwright::mli {

// A slope s becomes factor · s · (1 + |s|²/scale)^(−power/2); a power below 1 keeps their order.
struct TiltMap {
  double factor = 1, power = 0, scale = 1;
  // Above 0: each vertex has two normals, one for the triangles below the diagonals of their cells
  // and one for those above, so many times as far from the vertex's own as the mean facets of
  // either kind around it are. A pixel of a cell's width sees two facets, where it sees a dozen of
  // the finest sheet: they have to differ as much as those.
  double apart = 0;
};

struct Level {
  geometry::Mesh mesh;  // with normals
  double detail = 0;    // metres, the width of a cell: for pixels that see this or more
  // Metres, of the form's surface: the largest difference of heights at the finest sheet's
  // vertices, and the depth of a chord on the form.
  double error = 0;
  Covariance slopes;          // that it is shaded with, lying flat: shaded_slopes()
  std::vector<Cover> covers;  // of its triangles
};

// A coarser sheet that reflects light as the finest does, in the mean: what relief sends where
// follows from its slopes alone, so it may be enlarged. Its heights are those of filtered(), and
// added to them a piece of what filtering took away, enlarged with the cells: a pixel that sees a
// cell or more can't tell, but for the wrinkles that it could not see. Pieces are taken vertex by
// vertex, or every other one, where slopes hang together less; of 4 or 16 of either kind the
// one is taken whose slopes are distributed most like those of the finest sheet, within cells too,
// then its heights are scaled until the variance of its facets' slopes is the same. Where relief
// fades out towards an edge, it does so here.
struct Similar {
  Sheet sheet;  // removed_slope_covariance is what filtering took away
  // Of normals that are linear between vertices, which are farther from each other than the slopes
  // hang together: what is to be done with those at the vertices, so that variance and density
  // about level of those between are the finest sheet's.
  TiltMap tilts;
  double off =
      0;  // of the density of the slopes, as narrow lobes see it; 0.1: a tenth, in the mean
};
//   cells    across the width; below those of the sheet
// Cost: O(vertices of the sheet).
Similar similar(const Sheet& sheet, std::uint32_t cells, double crease_angle, const Job& job = {});

// Gives a mesh normals that lean as `tilts` says. surface: the mesh of the same sheet without
// heights, the same triangles, those of formed(); both without normals.
void compute_normals(geometry::Mesh& mesh, geometry::Mesh surface, double crease_angle,
                     const TiltMap& tilts);

// Each level has half the cells across of the one before; all are made from the finest sheet. They
// end where cells are as few as outlines (48: a polygon of 48 sides covers 0.9971 of its circle) or
// slopes (32) allow, where the form refuses one, and where slopes come out otherwise: the density
// of the slopes, as lobes of 0.05 or a quarter of their deviation see it, is off by more than 0.1
// in the mean.
//
//   crease_angle  radians, of compute_normals()
//   max_vertices  of all levels together; those beyond are left out, the finest first
//   trim          of the finest sheet, and of each level
// Cost: O(vertices of the sheet) for each level.
std::vector<Level> levels_of(const Sheet& sheet, const Form& form, double crease_angle,
                             double max_vertices, const Trim& trim = {}, const Job& job = {});

// Covariance of the slopes of a mesh's normals over the plane, about their mean; each triangle by
// its area in the plane, slopes linear between its vertices.
//
// Expects: normals whose z is above 0.
Covariance shaded_slopes(const geometry::Mesh& mesh);

// The largest distance between the heights of two sheets over the same rectangle, at the vertices
// of the finer one, metres. The coarser one is linear in its triangles.
double height_error(const Sheet& fine, const Sheet& coarse);

}  // namespace panwright::mli
