// Sampling of the Sun's disc for narrow lobes. Private to preview/reference.
#pragma once

#include "base/math.h"
#include "materials/sample.h"

namespace panwright::preview::reference {

// Places in the unit disc, with the density of a narrow lobe's light. Uniform samples would rarely
// hit the flank of a lobe beside the disc, which is then all that is visible.
class DiscPlaces {
 public:
  explicit DiscPlaces(const materials::DiscLobes& lobes);

  // Samples a place from u in the unit square: uniformly, or by one of the lobes beside the disc.
  Vec2 sample(const Vec2& u) const;
  // Returns the density of sample(), over the disc; 0 outside.
  double pdf(const Vec2& place) const;

 private:
  materials::DiscLobes lobes_;
};

}  // namespace panwright::preview::reference
