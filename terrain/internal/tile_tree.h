// Tree over the triangles of one tile, for rays. Private to terrain.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "terrain/internal/chart_surface.h"

namespace panwright::terrain::internal {

inline constexpr float kFar = std::numeric_limits<float>::max();

// First of the nodes of a depth.
constexpr std::uint32_t first_of(std::uint32_t depth) { return ((1u << 2 * depth) - 1) / 3; }

// Morton order: each bit becomes every second one.
constexpr std::uint32_t spread(std::uint32_t v) {
  v = (v | v << 4) & 0x0f0f;
  v = (v | v << 2) & 0x3333;
  return (v | v << 1) & 0x5555;
}

// Every second bit.
constexpr std::uint32_t gather(std::uint32_t v) {
  v &= 0x5555;
  v = (v | v >> 1) & 0x3333;
  v = (v | v >> 2) & 0x0f0f;
  return (v | v >> 4) & 0x00ff;
}

// Boxes of squares of 16 x 16 cells, in the axes of the tile's middle. Within each square least and
// largest heights of 2 x 2 cells and more, in axes along columns, rows and upwards. They only leave
// out triangles: those that remain are met in double.
//
// Memory: 0.2 MB; of a polar map of an ellipsoid 1.8 MB. Cost: 0.1 ms; of such a map a microsecond
// a post.
class TileTree {
 public:
  // A tree without triangles.
  TileTree() = default;
  TileTree(const ChartSurface& surface, const TileView& view);

  std::size_t bytes() const {
    return sizeof *this + nodes_.size() * sizeof(Boxes) + squares_.size() * sizeof(Square) +
           (heights_ ? kHeightNodes * sizeof(Heights) : 0) + points_.size() * sizeof(Vec3);
  }
  // Nearest hit of a ray before walk.most, or any.
  void cast(GroundWalk& walk) const;
  // The same among squares.
  void cast(GroundWalk& walk, std::span<const std::uint8_t> squares) const;
  // Adds the squares that rays of a beam may meet, in Morton order, from the nearest.
  void find(const TerrainBeam& beam, std::vector<std::uint8_t>& out) const;
  // Square that a pyramid of rays may meet.
  struct SeenSquare {
    double ahead;       // metres along its axis, at least
    std::uint8_t code;  // in Morton order
  };
  void find(const RayPyramid& rays, std::vector<SeenSquare>& out) const;
  // Rays, on average, that a leaf of a square has before it.
  double rays_of_leaf(const RayGrid& rays, const SeenSquare& square) const;
  // Takes the nearest triangles of rays in a square. Returns how many leaves were looked at.
  std::size_t cast(RayGrid& rays, std::uint32_t tile, std::uint8_t square,
                   const AcceptPoint* accepts) const;
  // The nearest hit of a ray in a cell of the tile.
  void cast(GroundWalk& walk, std::uint32_t x, std::uint32_t y) const;
  // Nearest triangle to a point, nearer than walk.squared.
  void approach(GroundApproach& walk) const;

 private:
  static constexpr std::uint32_t kLeafCells = 2, kSquareCells = 16, kSquareDepth = 4;
  static constexpr float kUneven = 1.1f;  // of cells to one another, at most
  static constexpr std::uint32_t kSquares = kTileCells / kSquareCells;  // on a side
  static constexpr std::uint32_t kHeightNodes = kSquares * kSquares * (1 + 4 + 16);

  // Of four children: a lane each.
  struct alignas(16) Boxes {
    std::array<std::array<float, 4>, 3> low, high;
  };
  struct alignas(16) Heights {
    std::array<float, 4> low, high;  // metres over middle_; none: low > high
  };
  // Axes of a square: from those of the tile to cells across, cells down and metres up.
  struct Square {
    std::array<std::array<float, 3>, 3> to, from;  // rows; columns
    std::array<float, 3> origin;
    std::array<float, 3> pad;    // distance of posts from these axes, and rounding
    bool loose = false;          // they are of no use
    std::array<float, 2> steps;  // metres, at most, along a cell across and down; huge: voids
    float lean;                  // slope, at most, of the ground without relief
  };
  struct Local;
  struct Sides;
  struct SquareRay;
  struct Lattice;

  std::uint32_t heights_at(std::uint32_t depth, std::uint32_t code) const {
    constexpr std::uint32_t kFirst[] = {0, kSquares * kSquares, 5 * kSquares * kSquares};
    return kFirst[depth - kSquareDepth] + code;
  }
  void build();
  void build_heights();
  void fold_heights();
  struct Steps;
  AxisBox build_square(const Lattice& lattice, std::uint32_t x, std::uint32_t y);
  // Sets a ray in the axes of the tile; false: it does not come near.
  bool place(const GroundWalk& walk, Local& local) const;
  // Returns whether all rays of a beam rise faster than the ground of a square.
  bool falls_behind(const Square& square, const std::array<float, 3>& axis, double sine) const;
  void cast_square(GroundWalk& walk, const Local& local, std::uint32_t code, std::uint32_t x,
                   std::uint32_t y, float most) const;
  void meet_leaf(GroundWalk& walk, const Local& local, const SquareRay& ray, std::uint32_t x,
                 std::uint32_t y) const;
  void meet_cell(GroundWalk& walk, const Local& local, std::uint32_t x, std::uint32_t y) const;
  void approach_square(GroundApproach& walk, const Vec3& from, std::uint32_t code, std::uint32_t x,
                       std::uint32_t y) const;
  void approach_cell(GroundApproach& walk, std::uint32_t x, std::uint32_t y) const;
  void cast_leaf(RayGrid& rays, std::uint32_t tile, std::uint32_t left, std::uint32_t top,
                 const AcceptPoint* accepts) const;
  // Calls visit(corners, triangle) for those of a cell, until it returns true.
  template <class Visit>
  bool visit_cell(std::uint32_t x, std::uint32_t y, Visit&& visit) const;

  const ChartSurface* surface_ = nullptr;
  TileView view_;
  std::uint32_t level_ = 0;
  std::uint32_t x0_ = 0, y0_ = 0;       // first cell, in those of the level
  std::uint32_t nx_ = 0, ny_ = 0;       // cells
  Vec3 centre_{0};                      // metres
  Mat3 axes_{1};                        // to them from body-fixed ones
  double middle_ = 0;                   // metres: height of the centre
  double radius_ = 0;                   // metres, of a sphere about the posts
  double steepest_ = 0;                 // rays that rise faster leave all of its ground below
  double edge_ = 0;                     // share of a triangle that its edges are widened by
  std::vector<Boxes> nodes_;            // by depth, then in Morton order
  std::vector<Square> squares_;         // in Morton order
  std::unique_ptr<Heights[]> heights_;  // by depth, from that of squares on
  std::vector<Vec3> points_;            // of posts, where they cost much
};

}  // namespace panwright::terrain::internal
