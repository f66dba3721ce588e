#include "terrain/sights.h"

#include <cassert>
#include <limits>

#include "base/parallel.h"

namespace panwright::terrain {

namespace {

template <class Answer>
void for_each_question(std::size_t count, const Job& job, const Answer& answer) {
  constexpr std::size_t kBatch = 1024;
  parallel_for((count + kBatch - 1) / kBatch,
               [&](std::size_t batch) {
                 const std::size_t end = std::min(count, (batch + 1) * kBatch);
                 for (std::size_t i = batch * kBatch; i < end; ++i) answer(i);
               },
               job);
}

}  // namespace

LocalAxes local_axes(const LatLon& place) {
  const auto [sy, cy] = det::sincos(place.latitude * kDegree);
  const auto [sx, cx] = det::sincos(place.longitude * kDegree);
  return {Vec3(-sx, cx, 0), Vec3(-sy * cx, -sy * sx, cy), Vec3(cy * cx, cy * sx, sy)};
}

LocalAxes local_axes(const Ground& ground, const LatLon& place) {
  if (!ground.tiles().map(0).is_placed()) return {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  return local_axes(place);
}

std::optional<Vec3> point_above(const Ground& ground, const LatLon& place, double above) {
  const GroundPoint point = ground.at(place);
  if (!point) return {};
  return point.position + above * local_axes(ground, place).up;
}

Vec3 direction_at(const LocalAxes& axes, double azimuth, double elevation) {
  const auto [sa, ca] = det::sincos(azimuth);
  const auto [se, ce] = det::sincos(elevation);
  return ce * (ca * axes.north + sa * axes.east) + se * axes.up;
}

void sights(const Ground& ground, std::span<const GroundSight> sights, double slack,
            std::span<std::uint8_t> open, const Job& job) {
  assert(sights.size() == open.size() && slack >= 0);
  for_each_question(sights.size(), job, [&](std::size_t i) {
    const Vec3 line = sights[i].to - sights[i].from;
    const double length = glm::length(line);
    open[i] = 1;
    if (!(length > 2 * slack)) return;
    open[i] = ground.is_blocked(sights[i].from, line / length, slack, length - slack) ? 0 : 1;
  });
}

void ranges(const Ground& ground, std::span<const GroundRay> rays, double slack,
            std::span<double> metres, const Job& job) {
  assert(rays.size() == metres.size() && slack >= 0);
  for_each_question(rays.size(), job, [&](std::size_t i) {
    const auto hit = ground.nearest(rays[i].origin, rays[i].direction, slack);
    metres[i] = hit ? hit->distance : std::numeric_limits<double>::infinity();
  });
}

}  // namespace panwright::terrain
