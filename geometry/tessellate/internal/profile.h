// Profile curves of surfaces of revolution, and their chords.
#pragma once

#include <array>
#include <vector>

#include "base/math.h"

namespace panwright::geometry::internal {

// Polynomial c[0] + c[1] t + c[2] t² + c[3] t³.
using Cubic = std::array<Vec2, 4>;

// Position and derivatives by the parameter.
struct Jet {
  Vec2 p, d, dd;
  double speed() const;      // |d|
  Vec2 normal() const;       // unit, on the right
  double curvature() const;  // positive for a left bend: chords lie inside then
};

// Plane curve (r, z) with the outside on its right: an arc of a circle, or cubics end to end with
// common tangents.
class Curve {
 public:
  static Curve arc(const Vec2& centre, double radius, double begin, double end);
  static Curve cubics(std::vector<Cubic> pieces, bool loop);

  double begin() const { return begin_; }
  double end() const { return end_; }
  bool loop() const { return loop_; }

  // Evaluates the curve. Beyond the ends it continues; a loop starts again.
  Jet at(double t) const;

  // Returns the largest |cross(p(t) − from, along)| over [first, last].
  double largest_cross(double first, double last, const Vec2& from, const Vec2& along) const;

  // Parameters from begin to end between which the curve counts as an arc.
  const std::vector<double>& knots() const { return knots_; }

 private:
  double begin_ = 0, end_ = 1;
  bool loop_ = false;
  Vec2 centre_{0};
  double radius_ = 0;
  std::vector<Cubic> pieces_;  // piece i over [i, i + 1]; none: an arc
  std::vector<double> knots_;
};

// A positive function between nodes, linear, and its integral.
class Density {
 public:
  Density(std::vector<double> t, std::vector<double> value);
  double total() const { return sum_.back(); }
  // Returns the point at which the integral from the first node reaches a share of the whole.
  double place(double share) const;

 private:
  std::vector<double> t_, value_, sum_;
};

// Samples of a curve that decide the positions of its vertices.
class CurveSamples {
 public:
  explicit CurveSamples(const Curve& curve);

  // The largest |r·n_r|: times 1 − cos(half a segment), the dip of segments along the normal.
  double largest_lever() const { return largest_lever_; }
  double length() const { return length_; }
  const Vec2& low() const { return low_; }  // bounds of the nodes
  const Vec2& high() const { return high_; }

  // Returns the chords per parameter for which the dip of segments and chords together is
  // 2·half_range (balanced vertices) or half_range (vertices on the curve). dip: segment_dip().
  Density density(double half_range, double dip, bool balanced) const;
  double chords(double half_range, double dip, bool balanced) const;

  // length from the curve's begin
  double length_to(double t) const;

 private:
  double allowed(std::size_t i, double half_range, double dip, bool balanced) const;

  std::vector<double> t_;       // K nodes
  std::vector<double> bend_;    // sqrt(|curvature|/8) by parameter
  std::vector<double> lever_;   // |r·n_r|
  std::vector<double> inward_;  // largest move of a vertex along the normal: r/(2|n_r|) or ∞
  std::vector<double> length_at_;
  Vec2 low_, high_;
  double largest_lever_ = 0;
  double length_ = 0;
};

// Continuation of a curve at its end.
enum class End { edge, pole, loop };

// Vertex of a profile: moved off the curve, with the normal of the curve.
struct ProfilePoint {
  double radius;
  double z;
  Vec2 normal;
  double v;  // texture
};

// Options of laying chords along a curve.
struct ChordSettings {
  double half_range;    // the allowed error
  double half;          // angle of half a segment
  double edge_factor;   // on the radius of circular edges
  bool balanced;        // vertices move off the curve so that errors outside equal those inside
  std::uint32_t count;  // of chords; 0: by the error
  End first, last;
};

struct Chords {
  std::vector<double> t;             // of each vertex
  std::vector<ProfilePoint> points;  // v: length from the begin, over the whole
  double error;  // largest distance of the revolved chords from the revolved curve
};

// Returns the radial dip of segments relative to the radius: from vertices on the circle to their
// middle, or balanced, so that they dip inside by as much as their ends stand out.
double segment_dip(double half, bool balanced);

// Lays chords that meet the error if the segments allow it; counts take precedence.
Chords laid_chords(const Curve& curve, const CurveSamples& samples, const ChordSettings& settings);

}  // namespace panwright::geometry::internal
