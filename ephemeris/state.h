// Positions, attitudes and spans of time, as kernels have them.
//
// Times are seconds of TDB past J2000 (2000-01-01T12:00:00 TDB), called ET.
#pragma once

#include <optional>

#include "base/math.h"

namespace panwright::ephemeris {

struct State {
  Vec3 position{0};  // km
  Vec3 velocity{0};  // km/s
};

// Axes of a frame.
struct Attitude {
  Mat3 from_j2000{1};        // takes vectors in axes of J2000 to those of the frame
  std::optional<Vec3> rate;  // of the frame, rad/s in axes of J2000; none: the kernel has no rates
};

// Closed interval of ET.
struct Interval {
  double begin = 0, end = 0;
  bool operator==(const Interval&) const = default;
};

}  // namespace panwright::ephemeris
