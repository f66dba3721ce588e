// Space curves followed by pipes.
#pragma once

#include <span>
#include <vector>

#include "base/math.h"

namespace panwright::geometry::internal {

// Returns a unit vector across a tangent: along the axis (x, y or z) furthest from it, the first of
// equals. The same for both directions of a tangent; for z it is x.
Vec3 first_right(const Vec3& tangent);

// Carries `right` from `from` to `to` without rotation about the tangent. Wang, Jüttler, Zheng,
// Liu, "Computation of rotation minimizing frames", 2008 (double reflection).
struct Frame {
  Vec3 centre, tangent, right;  // the latter two unit, perpendicular
  Vec3 up() const { return glm::cross(tangent, right); }
};
Vec3 carried(const Frame& from, const Vec3& centre, const Vec3& tangent);

// Rotates a frame about its tangent, counter-clockwise.
Frame turned(const Frame& frame, double angle);

// Centripetal Catmull-Rom spline through 2 or more points, cut into pieces that bend by less than
// 0.15 radians each; parameters count pieces. An open one continues straight beyond its ends: the
// point there is the mirror image of the last but one.
class SplinePath {
 public:
  SplinePath(std::span<const Vec3> points, bool closed);

  struct Point {
    Vec3 position, first, second;  // and derivatives by some parameter
    Vec3 tangent() const { return first / glm::length(first); }
    Vec3 bend() const;  // towards the centre of curvature, 1/metres
  };

  double end() const { return static_cast<double>(pieces_.size()); }
  Point at(double t) const;
  Frame frame_at(double t) const;
  double length_to(double t) const;
  double length() const { return length_; }
  double at_length(double length) const;  // the parameter
  std::size_t spans() const { return cubics_.size(); }

  // Returns the angle between the frames at the end and at the begin of a closed path.
  double twist() const;

  // Place of largest curvature.
  struct Bend {
    double curvature;   // 1/metres, infinite at a cusp
    std::size_t point;  // the nearest of the points
  };
  Bend sharpest() const;

  // ∫ weight(curvature) over the length
  template <class Weight>
  double integral(const Weight& weight) const {
    double sum = 0;
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      sum += pieces_[i].length * weight(glm::length(at(static_cast<double>(i) + 0.5).bend()));
    return sum;
  }

 private:
  struct Cubic {
    Vec3 c[4];  // powers of the parameter over [0, 1]
  };
  struct Piece {
    std::size_t cubic;
    double begin, end;  // parameters of the cubic
    double before;      // length of the path up to here
    double length;
    Frame frame;  // at begin
    bool cusp;    // has a cusp inside
  };

  void cut(std::size_t cubic);
  void add_piece(std::size_t cubic, double begin, double end, bool cusp);
  Point at(const Piece& piece, double share) const;
  const Piece& piece_at(double t, double& share) const;

  bool closed_;
  std::vector<Cubic> cubics_;
  std::vector<Piece> pieces_;
  Frame last_;  // at the end
  double length_ = 0;
};

}  // namespace panwright::geometry::internal
