// Steps about an ellipse by its curvature.
#pragma once

#include "geometry/tessellate/internal/profile.h"

namespace panwright::geometry::internal {

// Parameter of a circle, stepped along the ellipse x = a cos t, y = b sin t.
class Steps {
 public:
  enum class Kind : std::uint8_t {
    chords,    // of equal sag: steps scale with the inverse square root of the distance between
               // centre and tangent
    staggered  // of facets of equal depth, in strips of equal height: long steps are shorter
  };

  Steps(double a, double b, Kind kind);

  bool even() const { return even_; }    // a circle: all steps are equal
  bool sharp() const { return sharp_; }  // one axis is over three times the other

  // of a whole turn: turn over count is the step
  double integral() const { return 4 * density_.total(); }

  // Returns the parameter's change by the share of the turn at k of n steps, over 2π; 1 for a
  // circle.
  double stretch(std::uint64_t k, std::uint64_t n) const;

  // cos and sin at k of n steps of a whole turn, symmetric to the last bit
  det::SinCos at(std::uint64_t k, std::uint64_t n) const;

 private:
  double value(double t) const;
  Density made() const;

  double a_, b_;
  Kind kind_;
  bool even_, sharp_;
  Density density_;
};

}  // namespace panwright::geometry::internal
