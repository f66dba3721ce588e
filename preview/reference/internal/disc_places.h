// Places on the Sun's disc, drawn for narrow lobes. Private to preview/reference.
#pragma once

#include "base/math.h"
#include "materials/sample.h"

namespace panwright::preview::reference {

// Places in the unit disc with a density that a narrow lobe's light has there. Drawn evenly, hardly
// any would be where the flank of a lobe beside the disc is, which is all that is seen then.
class DiscPlaces {
 public:
  explicit DiscPlaces(const materials::DiscLobes& lobes);

  // From u in the unit square: evenly, or by one of the lobes that look beside the disc.
  Vec2 sample(const Vec2& u) const;
  // Of sample(), over the disc; 0 outside.
  double pdf(const Vec2& place) const;

 private:
  materials::DiscLobes lobes_;
};

}  // namespace panwright::preview::reference
