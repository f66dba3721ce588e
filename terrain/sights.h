// Lines of sight and ranges over terrain, from places on it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "base/job.h"
#include "base/math.h"
#include "terrain/ground.h"

namespace panwright::terrain {

// Axes at a place, unit: away from the centre of the body, to the east and to the north; of planes
// z, x and y.
struct LocalAxes {
  Vec3 east, north, up;
};
LocalAxes local_axes(const LatLon& place);  // of a body
LocalAxes local_axes(const Ground& ground, const LatLon& place);

// Point `above` metres over the ground at a place; none: there is no ground.
std::optional<Vec3> point_above(const Ground& ground, const LatLon& place, double above);
// Unit direction. azimuth: radians from north, clockwise; elevation over the horizontal.
Vec3 direction_at(const LocalAxes& axes, double azimuth, double elevation);

struct GroundSight {
  Vec3 from{0}, to{0};  // metres, body-fixed
};
struct GroundRay {
  Vec3 origin{0}, direction{0};  // unit
};

// Lines of sight: 1 where no ground stands between, else 0; from both ends the same.
//
//   slack  metres at both ends where ground does not count, as that on which the points lie
// Expects: as many answers as questions. Throws Cancelled. The same for any number of threads.
// Cost: a microsecond each on two cores, once the trees are there.
void sights(const Ground& ground, std::span<const GroundSight> sights, double slack,
            std::span<std::uint8_t> open, const Job& job = {});

// Distances to the ground along rays, metres; infinite: there is none. Expects, throws, costs:
// as sights().
void ranges(const Ground& ground, std::span<const GroundRay> rays, double slack,
            std::span<double> metres, const Job& job = {});

}  // namespace panwright::terrain
