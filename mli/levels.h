// Levels of detail of a sheet: coarser sheets with the same glint.
#pragma once

#include <vector>

#include "base/job.h"
#include "geometry/mesh.h"
#include "mli/form.h"
#include "mli/sheet.h"
#include "mli/trim.h"

namespace panwright::mli {

// Map of slopes: a slope s becomes factor · s · (1 + |s|²/scale)^(−power/2); a power below 1 keeps
// their order.
struct TiltMap {
  double factor = 1, power = 0, scale = 1;
  // Then a slope along and up the sheet becomes (along·s, up·s): cells are cut along one diagonal,
  // and slopes between vertices differ less along it than across it.
  Vec2 along{1, 0}, up{0, 1};
  bool leans() const { return along != Vec2(1, 0) || up != Vec2(0, 1); }
  // Above 0: each vertex has two normals, for the triangles below and above the diagonals of their
  // cells. They deviate from the vertex's own by this factor times the mean facets of either kind
  // around it. A pixel of a cell's width covers two facets here, a dozen on the finest sheet; these
  // two must differ as much.
  double apart = 0;
};

struct Level {
  geometry::Mesh mesh;  // with normals
  double detail = 0;    // metres, the width of a cell: smallest pixel footprint that uses it
  // Metres, of the form's surface: the largest difference of heights at the finest sheet's
  // vertices, and the depth of a chord on the form.
  double error = 0;
  Covariance slopes;          // as shaded, lying flat: shaded_slopes()
  std::vector<Cover> covers;  // per triangle
};

// A coarser sheet with the finest one's mean reflection. Reflection follows from slopes alone, so
// relief may be enlarged. Its heights are those of filtered(), plus a piece of the removed relief,
// enlarged with the cells. Pixels of a cell or more see no difference except wrinkles below their
// size. Pieces are taken at every vertex, or every other one if slopes correlate less. Of 4 or 16
// of either kind, the one with the slope distribution nearest to the finest sheet's, within cells
// too, is taken. Its heights are then scaled to the same variance of facet slopes. Relief fades out
// towards edges as in the original.
struct Similar {
  Sheet sheet;  // removed_slope_covariance is that of the filtering
  // Map of normals at vertices, which are farther apart than the slopes' correlation length. With
  // it, covariance and density about level of the normals between are the finest sheet's.
  TiltMap tilts;
  double off = 0;  // of the density of the slopes, for narrow lobes; 0.1: a tenth, in the mean
};
//   cells    across the width; below those of the sheet
// Cost: O(vertices of the sheet).
Similar similar(const Sheet& sheet, std::uint32_t cells, double crease_angle, const Job& job = {});

// Gives a mesh normals tilted by `tilts`. surface: the mesh of the same sheet without heights, the
// same triangles, those of formed(); both without normals.
void compute_normals(geometry::Mesh& mesh, geometry::Mesh surface, double crease_angle,
                     const TiltMap& tilts);

// Makes levels with half the cells across of the one before, all from the finest sheet. They end at
// the fewest cells for outlines (48: a polygon of 48 sides covers 0.9971 of its circle) or slopes
// (32), or at a refusal by the form. They also end at a mean error above 0.1 of the slopes'
// density, for lobes of 0.05 or a quarter of their deviation.
//
//   crease_angle  radians, of compute_normals()
//   max_vertices  of all levels together; those beyond are left out, the finest first
//   trim          of the finest sheet, and of each level
// Cost: O(vertices of the sheet) for each level.
std::vector<Level> levels_of(const Sheet& sheet, const Form& form, double crease_angle,
                             double max_vertices, const Trim& trim = {}, const Job& job = {});

// Returns the covariance of the slopes of a mesh's normals over the plane, about their mean; each
// triangle by its area in the plane, slopes linear between its vertices.
//
// Expects: normals whose z is above 0.
Covariance shaded_slopes(const geometry::Mesh& mesh);

// Returns the largest distance between the heights of two sheets over the same rectangle, at the
// vertices of the finer one, metres. The coarser one is linear in its triangles.
double height_error(const Sheet& fine, const Sheet& coarse);

}  // namespace panwright::mli
