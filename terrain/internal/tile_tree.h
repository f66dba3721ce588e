// Tree of boxes over the triangles of one tile, for rays. Private to terrain.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "terrain/internal/chart_surface.h"

namespace panwright::terrain::internal {

// Boxes of 2 x 2 cells and of squares of them, in the axes of the tile's middle. They only leave
// out triangles: those that remain are met in double.
//
// Memory: 0.5 MB; of a polar map of an ellipsoid 2.1 MB.
class TileTree {
 public:
  // A tree without triangles.
  TileTree() = default;
  TileTree(const ChartSurface& surface, const TileView& view);

  std::size_t bytes() const {
    return sizeof *this + nodes_.size() * sizeof(Boxes) + points_.size() * sizeof(Vec3);
  }
  // Nearest hit of a ray before walk.most, or any.
  void cast(GroundWalk& walk) const;
  // Nearest triangle to a point, nearer than walk.squared.
  void approach(GroundApproach& walk) const;

 private:
  // Of four children: a lane each.
  struct alignas(16) Boxes {
    std::array<std::array<float, 4>, 3> low, high;
  };
  struct Local;

  void meet_leaf(GroundWalk& walk, const Local& local, std::uint32_t x, std::uint32_t y) const;
  void approach_leaf(GroundApproach& walk, std::uint32_t x, std::uint32_t y) const;
  // Calls visit(corners, column, row, triangle) for the triangles of a leaf, until it returns true.
  template <class Visit>
  void visit_leaf(std::uint32_t x, std::uint32_t y, Visit&& visit) const;
  void build();

  const ChartSurface* surface_ = nullptr;
  TileView view_;
  std::uint32_t level_ = 0;
  std::uint32_t x0_ = 0, y0_ = 0;  // first cell, in those of the level
  std::uint32_t nx_ = 0, ny_ = 0;  // cells
  Vec3 centre_{0};                 // metres
  Mat3 axes_{1};                   // to them from body-fixed ones
  double radius_ = 0;              // metres, of a sphere about the posts
  double edge_ = 0;                // share of a triangle that its edges are widened by
  std::vector<Boxes> nodes_;       // by depth, then in Morton order
  std::vector<Vec3> points_;       // of posts, where they cost much
};

}  // namespace panwright::terrain::internal
