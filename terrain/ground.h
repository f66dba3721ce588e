// Questions to terrain: heights, normals, slopes, rays. Answers come from the triangles of level 0.
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

// Point of the ground. Positions and normals are body-fixed (of a plane: x east, y north, z up).
struct GroundPoint {
  double height = std::numeric_limits<double>::quiet_NaN();  // metres over the sphere; NaN: none
  Vec3 position{0};                                          // metres
  Vec3 normal{0};                                // of the triangle, unit, away from the body
  double slope = 0;                              // radians between normal and vertical
  std::uint32_t chart = 0, column = 0, row = 0;  // the cell of level 0
  std::uint32_t triangle = 0;                    // 0: right of the cell's diagonal; 1: left

  explicit operator bool() const { return height == height; }
};

// First point of a ray on the ground.
struct GroundHit {
  double distance = 0;  // metres
  GroundPoint point;
};

// Terrain, ready for questions. Thread-safe. Damaged tiles have no ground.
class Ground {
 public:
  // Cost: O(tiles, columns and rows of posts).
  explicit Ground(std::shared_ptr<const Tiles> tiles);
  ~Ground();
  Ground(Ground&&) noexcept;

  const Tiles& tiles() const;

  // Point of the ground at a place: the vertical there meets the triangle. None outside of all
  // charts, and where all that have the place are void. Of planes: longitude and latitude are x and
  // y in metres.
  // note: the triangle and plane that rays meet
  GroundPoint at(const LatLon& place) const;
  void at(std::span<const LatLon> places, std::span<GroundPoint> points, const Job& job = {}) const;

  // First point of a ray between two distances from its origin; from either side. Where charts
  // overlap, the first with a height counts, and its border is open by the difference of heights.
  // Expects: a direction of length 1.
  std::optional<GroundHit> nearest(const Vec3& origin, const Vec3& direction, double least = 0,
                                   double most = std::numeric_limits<double>::infinity()) const;
  // Returns whether anything stands between two distances; quicker than nearest().
  bool is_blocked(const Vec3& origin, const Vec3& direction, double least, double most) const;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace panwright::terrain
