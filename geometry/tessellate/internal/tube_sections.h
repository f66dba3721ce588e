// Positions of the sections of a tube along a spline.
#pragma once

#include <vector>

#include "geometry/tessellate/internal/path.h"

namespace panwright::geometry::internal {

// Deviation of a surface between two sections from the pipe, relative to its radius, negative
// inwards.
struct Range {
  double low = 0, high = 0;
  bool folded = false;
};

// Allowed deviation between sections, for vertices at a radius: low < 0 < high.
struct Allowance {
  double radius, low, high;
};

struct Section {
  double t = 0;
  Frame frame;  // its centre moved outward
};

// Placement of sections along a spline, each as far from the last as the allowances permit.
class SectionPlacer {
 public:
  struct Settings {
    bool closed = false;
    std::vector<Allowance> allowances;
    double sin_half = 0;  // of half a segment of the sections
    double shift =
        0;  // metres: largest move of sections out of bends, so that chords run half inside
    double twist = 0;  // radians by which frames rotate back over the whole path
  };
  SectionPlacer(const SplinePath& path, Settings settings);

  // Returns sections from begin to end, at least four when closed. Stops before the end at more
  // than `most`.
  std::vector<Section> placed(double most) const;

  // Returns the section at a parameter, moved for chords that reach `step` further on both sides.
  Section section(double t, double step) const;

  // Measures bounds for two sections with vertices at a radius. Every point of the triangles
  // between them lies in a plane across the path, in which the distance from the path is measured.
  // Eight rulings in seven planes or more, plus a bound of the gaps between them.
  Range measure(const Section& a, const Section& b, double radius) const;

 private:
  Range across(const Section& a, const Section& b, double t, double radius) const;
  double use(const Section& a, const Section& b) const;
  Section further(const std::vector<Section>& sections, double step) const;
  double furthest(const std::vector<Section>& sections, double guess) const;
  std::vector<Section> halved(const std::vector<Section>& sections) const;
  void even_out(std::vector<Section>& sections) const;

  const SplinePath& path_;
  Settings settings_;
};

}  // namespace panwright::geometry::internal
