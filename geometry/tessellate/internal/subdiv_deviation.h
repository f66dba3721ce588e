// Deviation of a mesh from a subdivision surface.
#pragma once

#include "geometry/tessellate/internal/subdiv_cells.h"

namespace panwright::geometry::internal {

// Vertex of a mesh over a cell.
struct CellNode {
  std::uint32_t vertex;
  Vec2 at;  // parameters of the cell
};

// Largest distance of shown triangles and curves from one cell of a surface.
class CellDeviation {
 public:
  CellDeviation(const CellSurface& surface, const Cell& cell) : surface_(surface), cell_(cell) {}

  // Adds a triangle with corners on the surface, by parameters and positions.
  void show(const Vec2 (&at)[3], const Vec3 (&positions)[3]);
  // Adds a chord of a curve of the surface, from one point to another along a line of parameters.
  void show_curve(const Vec2& from, const Vec2& to, const Vec3& a, const Vec3& b);

  double worst() const { return worst_; }

 private:
  double distance(const Vec3& p, const Vec2& at, double& along_normal) const;
  double nearest(const Vec3& p, Vec2 at, LimitPoint s) const;
  double densely(const Vec2 (&at)[3], const Vec3 (&positions)[3]) const;

  const CellSurface& surface_;
  const Cell& cell_;
  double worst_ = 0;
};

}  // namespace panwright::geometry::internal
