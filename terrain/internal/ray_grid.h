// Rays of one origin in similar directions, sorted into a grid, against triangles. Private to
// terrain.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/math.h"

namespace panwright::terrain::internal {

// Pyramid about rays of one origin.
struct RayPyramid {
  Vec3 origin{0}, axis{0};
  std::array<Vec3, 4> inwards{};  // unit normals of its sides
};

// False for a point that does not count.
using AcceptPoint = std::function<bool(const Vec3&)>;

// Post of terrain, from the origin of the rays, and where they see it.
struct SeenPost {
  Vec3 at;
  double ahead, u, v;
};

class RayGrid {
 public:
  // Sets the rays. False: they are too far from the axis.
  //
  //   most  metres, for each ray
  bool set(const Vec3& origin, const Vec3& axis, std::span<const Vec3> directions,
           std::span<const double> most);
  const RayPyramid& pyramid() const { return pyramid_; }
  std::size_t size() const { return order_.size(); }
  // Rays of a unit square of a plane, a unit along the axis.
  double density() const { return double(size()) * u_scale_ * v_scale_ / (kSide * kSide); }
  // Metres: no ray asks for more.
  double farthest() const;

  SeenPost seen(const Vec3& post) const;
  struct Cell {
    static constexpr std::uint32_t kNone = ~0u;
    std::uint32_t tile = kNone;
    std::uint16_t x = 0, y = 0;
  };
  // Takes a triangle of a cell as the nearest of the rays that meet it.
  //
  //   edge     share of the triangle that it is widened by
  //   accepts  null: all do
  void meet(const SeenPost& a, const SeenPost& b, const SeenPost& c, double edge, const Cell& cell,
            const AcceptPoint* accepts);

  // Cells of the rays, in their order.
  void cells(std::span<Cell> out) const;

 private:
  static constexpr int kSide = 16;
  struct Range {
    int left, top, right, bottom;  // buckets, the last ones included
  };
  bool range_of(const SeenPost& a, const SeenPost& b, const SeenPost& c, Range& out) const;

  RayPyramid pyramid_;
  Vec3 x_{0}, y_{0};
  double u0_ = 0, v0_ = 0, u_scale_ = 0, v_scale_ = 0;  // of buckets
  std::vector<std::uint32_t> first_;                    // of each bucket, and the end
  std::vector<std::uint32_t> order_;                    // of the rays
  std::array<std::vector<double>, 3> direction_;
  std::vector<double> most_;
  std::vector<Cell> cell_;
};

}  // namespace panwright::terrain::internal
