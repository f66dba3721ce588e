// Questions to terrain: heights, normals, slopes, rays, nearest points. Answers come from the
// triangles of level 0, those of rays also from coarser ones within a stated angle.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/job.h"
#include "base/math.h"
#include "terrain/tiles.h"

namespace panwright::terrain {

namespace internal {
struct BeamState;
}

// Point of the ground. Positions and normals are body-fixed (of a plane: x east, y north, z up).
struct GroundPoint {
  double height = std::numeric_limits<double>::quiet_NaN();  // metres over the sphere; NaN: none
  Vec3 position{0};                                          // metres
  Vec3 normal{0};  // of the triangle, unit, away from the body
  // radians between normal and vertical; of rays NaN
  double slope = std::numeric_limits<double>::quiet_NaN();
  std::uint32_t chart = 0, level = 0;
  std::uint32_t column = 0, row = 0;  // the cell, of its level
  std::uint32_t triangle = 0;         // 0: right of the cell's diagonal; 1: left

  explicit operator bool() const { return height == height; }
};

// Smooth ground at a point of its triangles: normals of posts, by the posts beside them,
// interpolated over the cell.
struct SmoothGround {
  Vec3 normal{0};   // unit, away from the body; where posts are missing that of the triangle
  double rise = 0;  // metres, at most, of the smooth ground over the triangle; 0: it lies below
};

// Slopes of level 0 about a point of coarser triangles, which these leave out: over two by two of
// their cells. Of level 2 of large charts four such squares have the moments of their sixteen cells
// together, divided by their own posts.
struct GroundRelief {
  Vec3 right{0}, down{0}, up{0};  // unit, body-fixed: along the map, and vertical; 0: none
  double p = 0, q = 0;            // means, to the right and down
  double pp = 0, qq = 0, pq = 0;  // covariance

  explicit operator bool() const { return up != Vec3(0); }
};

// Point of the ground that a ray or a point is nearest to.
struct GroundHit {
  double distance = 0;  // metres, from the origin of the ray, or the point
  GroundPoint point;
};

// Levels of detail of the tiles of a Ground for an observer.
class GroundLevels {
 private:
  friend class Ground;
  std::vector<std::uint8_t> refined_;  // by tile
};

// Rays that start near a place, in similar directions.
struct RayBeam {
  Vec3 origin{0};     // the place
  double radius = 0;  // metres: of origins about it
  Vec3 axis{0};       // unit
  double angle = 0;   // radians, between directions and the axis
  // They start on the ground or above it: those that rise faster than it can are not blocked, nor
  // are those that come up through a gap, between levels or of voids.
  bool leaves_ground = false;
};

// Tiles of a Ground that the rays of a beam may meet. It stays on its thread, and keeps trees in
// memory: for some thousand rays.
class GroundBeam {
 private:
  friend class Ground;
  std::shared_ptr<const internal::BeamState> state_;
};

// Terrain, ready for questions. Thread-safe. Damaged tiles have no ground.
//
// Rays go through a tree of boxes of each tile, which is made when the first ray comes to it.
class Ground {
 public:
  static constexpr std::size_t kTreeBytes = std::size_t{1} << 29;
  static constexpr std::size_t kFineTiles = 1024;  // 270 MB
  // tree_bytes: memory of trees, above which those that were not used for longest are dropped; the
  // rays under way need some more. fine_tiles: of charts with more tiles of level 0, relief of
  // level 2 does not look at these.
  // Cost: O(tiles, columns and rows of posts).
  explicit Ground(std::shared_ptr<const Tiles> tiles, std::size_t tree_bytes = kTreeBytes,
                  std::size_t fine_tiles = kFineTiles);
  ~Ground();
  Ground(Ground&&) noexcept;

  const Tiles& tiles() const;

  // Point of the ground at a place: the vertical there meets the triangle. None outside of all
  // charts, and where all that have the place are void. Of planes: longitude and latitude are x and
  // y in metres.
  // note: the triangle and plane that rays meet
  GroundPoint at(const LatLon& place) const;
  void at(std::span<const LatLon> places, std::span<GroundPoint> points, const Job& job = {}) const;

  // Smooth ground at a point that rays, closest() or at() gave; its normals are continuous within a
  // chart and a level.
  SmoothGround smooth(const GroundPoint& point) const;

  // Factors of the colour of the ground's material at a point, body-fixed: the mean of albedo maps
  // over about `size` metres, 0: of the finest pixels. 1 where there is none.
  Vec3 albedo(const Vec3& position, double size) const;

  // Relief that the triangle of a point leaves out; none at level 0, and of files that were written
  // before there were blocks of slopes from level 3 on.
  //
  // note: the slopes of the smooth ground of level 0
  GroundRelief relief(const GroundPoint& point) const;

  // Levels for rays from an observer: of each tile the coarsest whose triangles lie within an angle
  // of those of level 0 (radians). Posts are at most twice that apart.
  //
  // Cost: O(tiles).
  GroundLevels levels(const Vec3& observer, double angle) const;

  // Tiles that rays of a beam may meet: nearest() and is_blocked() of such rays, with the same
  // levels, begin there instead of at the top. None where these are many.
  //
  // Expects: levels that stay where they are. Cost: that of a few rays.
  std::optional<GroundBeam> beam(const RayBeam& rays, const GroundLevels* levels) const;

  // First point of a ray between two distances from its origin; from either side. Where charts
  // overlap, the first with a height counts, and its border is open by the difference of heights.
  //
  //   levels  null: level 0. A ray that comes below the ground has met a gap between levels, and is
  //           answered by level 0
  //   beam    null: none. Of a ray that is not of the beam it does not count
  // Expects: a direction of length 1. Cost: about a microsecond, once the trees are there.
  std::optional<GroundHit> nearest(const Vec3& origin, const Vec3& direction, double least = 0,
                                   double most = std::numeric_limits<double>::infinity(),
                                   const GroundLevels* levels = nullptr,
                                   const GroundBeam* beam = nullptr) const;
  // The same of rays from one origin, as one by one; but of two triangles on whose common edge a
  // ray lies, either. Faster where rays of one beam meet the same cells.
  //
  //   most, hits  as many as directions
  void nearest(const Vec3& origin, std::span<const Vec3> directions, std::span<const double> most,
               std::span<std::optional<GroundHit>> hits, const GroundLevels* levels,
               const GroundBeam* beam) const;
  // Point of the ground nearest to a point, from any side, and its distance; none: none is nearer
  // than `most`. Of charts that overlap, points that an earlier one covers do not count.
  //
  // Cost: some microseconds.
  std::optional<GroundHit> closest(const Vec3& point,
                                   double most = std::numeric_limits<double>::infinity()) const;
  // Returns whether anything stands between two distances; quicker than nearest().
  bool is_blocked(const Vec3& origin, const Vec3& direction, double least, double most,
                  const GroundLevels* levels = nullptr, const GroundBeam* beam = nullptr) const;
  // Bytes of the trees that are there.
  std::size_t tree_bytes() const;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace panwright::terrain
