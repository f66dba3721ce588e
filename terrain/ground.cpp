#include "terrain/ground.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/parallel.h"
#include "terrain/internal/chart_surface.h"

namespace panwright::terrain {

using internal::ChartSurface;
using internal::TriangleHit;

struct Ground::State {
  std::shared_ptr<const Tiles> tiles;
  std::vector<ChartSurface> charts;

  // Whether a chart before `chart` has ground at a place of that one.
  bool is_covered(std::uint32_t chart, const Vec3& position) const {
    for (std::uint32_t c = 0; c < chart; ++c)
      if (charts[c].at(charts[c].place_of(position))) return true;
    return false;
  }

  std::optional<GroundHit> cast(const Vec3& origin, const Vec3& direction, double least,
                                double most, bool any) const {
    std::optional<GroundHit> best;
    for (std::uint32_t c = 0; c < charts.size(); ++c) {
      const auto accept = [&](const TriangleHit& hit) {
        return c == 0 || !is_covered(c, origin + hit.distance * direction);
      };
      const auto hit =
          charts[c].cast({origin, direction, least, best ? best->distance : most}, any, accept);
      if (!hit) continue;
      best = GroundHit{hit->distance, charts[c].point_of(*hit, origin + hit->distance * direction)};
      if (any) break;
    }
    return best;
  }
};

Ground::Ground(std::shared_ptr<const Tiles> tiles) {
  auto state = std::make_unique<State>();
  state->tiles = std::move(tiles);
  for (std::uint32_t c = 0; c < state->tiles->charts().size(); ++c)
    state->charts.emplace_back(*state->tiles, c);
  state_ = std::move(state);
}

Ground::~Ground() = default;
Ground::Ground(Ground&&) noexcept = default;

const Tiles& Ground::tiles() const { return *state_->tiles; }

GroundPoint Ground::at(const LatLon& place) const {
  for (const ChartSurface& chart : state_->charts)
    if (const GroundPoint point = chart.at(place)) return point;
  return {};
}

void Ground::at(std::span<const LatLon> places, std::span<GroundPoint> points,
                const Job& job) const {
  assert(places.size() == points.size());
  constexpr std::size_t kBatch = 4096;
  parallel_for((places.size() + kBatch - 1) / kBatch,
               [&](std::size_t batch) {
                 const std::size_t end = std::min(places.size(), (batch + 1) * kBatch);
                 for (std::size_t i = batch * kBatch; i < end; ++i) points[i] = at(places[i]);
               },
               job);
}

std::optional<GroundHit> Ground::nearest(const Vec3& origin, const Vec3& direction, double least,
                                         double most) const {
  return state_->cast(origin, direction, least, most, false);
}

bool Ground::is_blocked(const Vec3& origin, const Vec3& direction, double least,
                        double most) const {
  return state_->cast(origin, direction, least, most, true).has_value();
}

}  // namespace panwright::terrain
