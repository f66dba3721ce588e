// Positions of the sections of a tube along a spline.
#pragma once

#include <vector>

#include "geometry/tessellate/internal/path.h"

namespace panwright::geometry::internal {

// By how much a surface between two sections leaves the pipe: of its radius, negative inwards.
struct Range {
  double low = 0, high = 0;
  bool folded = false;
};

// What vertices at a radius may miss their surface by, between sections: low < 0 < high.
struct Allowance {
  double radius, low, high;
};

struct Section {
  double t = 0;
  Frame frame;  // its centre moved outward
};

// Places sections along a spline, each as far from the last as the allowances let it.
class SectionPlacer {
 public:
  struct Settings {
    bool closed = false;
    std::vector<Allowance> allowances;
    double sin_half = 0;  // of half a segment of the sections
    double shift =
        0;  // metres that sections may be moved out of bends, so that chords run half inside
    double twist = 0;  // radians by which frames turn back over the whole path
  };
  SectionPlacer(const SplinePath& path, Settings settings);

  // Sections from begin to end, at least four when closed. Stops before the end where there would
  // be more than `most`.
  std::vector<Section> placed(double most) const;

  // The section at a parameter, moved for chords that reach `step` further on both sides.
  Section section(double t, double step) const;

  // Bounds for two sections with vertices at a radius: every point of the triangles between them
  // lies in a plane across the path, and there the distance from the path is measured. Eight
  // rulings in seven planes or more, and what could be missed between them.
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
