// Ray.
#pragma once

#include "base/math.h"

namespace panwright::geometry {

struct Ray {
  Vec3 origin{0};
  Vec3 direction{0};           // any non-zero length
  double min_distance = 0;     // metres along the unit direction
  double max_distance = 1e30;  // metres
};

}  // namespace panwright::geometry
