#include "terrain/ground.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/parallel.h"
#include "terrain/internal/chart_surface.h"
#include "terrain/internal/tree_cache.h"

namespace panwright::terrain {

using internal::AcceptHit;
using internal::ChartSurface;
using internal::GroundApproach;
using internal::GroundWalk;
using internal::TerrainBeam;
using internal::TerrainRay;
using internal::TreeCache;
using internal::TriangleHit;

struct Ground::State {
  State(std::shared_ptr<const Tiles> given, std::size_t bytes)
      : tiles(std::move(given)), trees(*tiles, bytes) {}

  std::shared_ptr<const Tiles> tiles;
  std::vector<ChartSurface> charts;
  mutable TreeCache trees;
  double lowest = std::numeric_limits<double>::infinity();  // metres, from the centre; of planes z

  // Whether a chart before `chart` has ground at a place of that one.
  bool is_covered(std::uint32_t chart, const Vec3& position) const {
    for (std::uint32_t c = 0; c < chart; ++c)
      if (charts[c].at(charts[c].place_of(position))) return true;
    return false;
  }

  std::optional<GroundHit> cast(const TerrainRay& ray, bool any, const GroundLevels* levels,
                                const GroundBeam* beam = nullptr) const {
    const TreeCache::Use use(trees);
    std::optional<TriangleHit> best;
    std::uint32_t best_chart = 0;
    const auto refined =
        levels ? std::span<const std::uint8_t>(levels->refined_) : std::span<const std::uint8_t>();
    for (std::uint32_t c = 0; c < charts.size(); ++c) {
      const auto is_open = [&](const TriangleHit& hit) {
        return !is_covered(c, ray.origin + hit.distance * ray.direction);
      };
      // note: of a reference it takes no memory, which threads would write beside what others read
      const AcceptHit accept = std::cref(is_open);
      GroundWalk walk{ray, any, c > 0 ? &accept : nullptr, best ? best->distance : ray.most, {}};
      // where charts overlap the ground has steps
      walk.leaves_ground = any && beam && beam->leaves_ground_ && charts.size() == 1;
      if (beam == nullptr)
        charts[c].cast(walk, refined, trees);
      else
        charts[c].cast(walk, tiles_of(*beam, c), beam->squares_, trees);
      if (!walk.best) continue;
      best = walk.best;
      best_chart = c;
      if (any) break;
    }
    if (!best) return {};
    const Vec3 position = ray.origin + best->distance * ray.direction;
    if (any) return GroundHit{best->distance, {}};
    return GroundHit{best->distance, charts[best_chart].point_of(*best, position, false)};
  }

  static std::span<const GroundBeam::Tile> tiles_of(const GroundBeam& beam, std::uint32_t chart) {
    const std::size_t begin = chart > 0 ? beam.ends_[chart - 1] : 0;
    return std::span(beam.tiles_).subspan(begin, beam.ends_[chart] - begin);
  }

  // Leaves out tiles without squares that rays of a beam may meet.
  void find_squares(const TerrainBeam& rays, GroundBeam& beam) const {
    constexpr std::size_t kMany = 16;  // of a tile: then its tree is quicker
    std::erase_if(beam.tiles_, [&](GroundBeam::Tile& each) {
      const std::size_t first = beam.squares_.size();
      trees.of(each.tile, charts.front()).find(rays, beam.squares_);
      const std::size_t found = beam.squares_.size() - first;
      if (found > kMany) beam.squares_.resize(first);
      each.first = static_cast<std::uint32_t>(first);
      each.end = static_cast<std::uint32_t>(beam.squares_.size());
      return found == 0;
    });
    beam.ends_.front() = beam.tiles_.size();
  }

  // Whether a ray without a hit comes below all ground.
  bool goes_below(const TerrainRay& ray) const {
    if (charts.front().is_plane())
      return ray.direction.z < 0 &&
             ray.origin.z + std::min(ray.most, 1e18) * ray.direction.z < lowest;
    const double t = std::clamp(-glm::dot(ray.origin, ray.direction), ray.least, ray.most);
    const Vec3 p = ray.origin + t * ray.direction;
    return glm::dot(p, p) < lowest * lowest;
  }
};

Ground::Ground(std::shared_ptr<const Tiles> tiles, std::size_t tree_bytes, std::size_t fine_tiles) {
  auto state = std::make_unique<State>(std::move(tiles), tree_bytes);
  for (std::uint32_t c = 0; c < state->tiles->charts().size(); ++c) {
    state->charts.emplace_back(*state->tiles, c, fine_tiles);
    const ChartRecord& chart = state->tiles->charts()[c];
    state->lowest = std::min(state->lowest, std::min(chart.radius, chart.polar_radius) + chart.low);
  }
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

SmoothGround Ground::smooth(const GroundPoint& point) const {
  return state_->charts[point.chart].smooth(point);
}

Vec3 Ground::albedo(const Vec3& position, double size) const {
  return tiles().albedo().at(state_->charts.front().place_of(position), size);
}

GroundRelief Ground::relief(const GroundPoint& point) const {
  return state_->charts[point.chart].relief(point);
}

GroundLevels Ground::levels(const Vec3& observer, double angle) const {
  GroundLevels out;
  const auto records = tiles().records();
  out.refined_.resize(records.size());
  for (const ChartSurface& chart : state_->charts) {
    const ChartRecord& record = chart.record();
    for (std::uint32_t t = record.first_tile; t < record.first_tile + record.tile_count; ++t) {
      const double reach = angle * chart.distance_to(t, observer);
      out.refined_[t] = !(double(records[t].error) <= reach && chart.spacing(t) <= 2 * reach);
    }
  }
  return out;
}

std::optional<GroundBeam> Ground::beam(const RayBeam& rays, const GroundLevels* levels) const {
  GroundBeam out;
  // more than the places of origins are rounded by
  const double radius = rays.radius * (1 + 1e-9) + 1e-12 * glm::length(rays.origin);
  const double angle = rays.angle + 1e-7;
  constexpr double kWide = 0.5;  // radians
  if (!(angle < kWide)) return {};
  out.origin_ = rays.origin;
  out.axis_ = rays.axis;
  out.square_ = radius * radius;
  out.cosine_ = det::cos(angle);
  out.levels_ = levels;
  out.leaves_ground_ = rays.leaves_ground;
  const auto refined =
      levels ? std::span<const std::uint8_t>(levels->refined_) : std::span<const std::uint8_t>();
  constexpr std::size_t kMany = 48;
  const TerrainBeam all{rays.origin, rays.axis, radius, det::sin(angle), rays.leaves_ground};
  for (const ChartSurface& chart : state_->charts) {
    chart.find(all, refined, out.tiles_);
    if (out.tiles_.size() > kMany) return {};
    out.ends_.push_back(out.tiles_.size());
  }
  out.use_ = std::make_shared<const TreeCache::Use>(state_->trees);
  // where charts overlap the ground has steps
  if (rays.leaves_ground && state_->charts.size() == 1) state_->find_squares(all, out);
  return out;
}

std::optional<GroundHit> Ground::nearest(const Vec3& origin, const Vec3& direction, double least,
                                         double most, const GroundLevels* levels,
                                         const GroundBeam* beam) const {
  const TerrainRay ray{origin, direction, least, most};
  const bool beamed = beam != nullptr && !beam->leaves_ground_ && beam->levels_ == levels &&
                      beam->holds(origin, direction);
  auto hit = state_->cast(ray, false, levels, beamed ? beam : nullptr);
  if (levels == nullptr) return hit;
  const bool gap = hit ? glm::dot(hit->point.normal, direction) > 0 : state_->goes_below(ray);
  return gap ? state_->cast(ray, false, nullptr) : hit;
}

std::optional<GroundHit> Ground::closest(const Vec3& point, double most) const {
  const TreeCache::Use use(state_->trees);
  std::optional<GroundHit> out;
  double squared = most * most;
  for (std::uint32_t c = 0; c < state_->charts.size(); ++c) {
    GroundApproach walk{point, nullptr, squared, {}, {}};
    const AcceptHit accept = [&](const TriangleHit&) {
      return !state_->is_covered(c, walk.nearest);
    };
    if (c > 0) walk.accept = &accept;
    state_->charts[c].approach(walk, state_->trees);
    if (!walk.best) continue;
    squared = walk.squared;
    out =
        GroundHit{walk.best->distance, state_->charts[c].point_of(*walk.best, walk.nearest, true)};
  }
  return out;
}

bool Ground::is_blocked(const Vec3& origin, const Vec3& direction, double least, double most,
                        const GroundLevels* levels, const GroundBeam* beam) const {
  const TerrainRay ray{origin, direction, least, most};
  const bool beamed = beam != nullptr && beam->levels_ == levels && beam->holds(origin, direction);
  if (beamed && beam->tiles_.empty()) return false;
  return state_->cast(ray, true, levels, beamed ? beam : nullptr).has_value();
}

std::size_t Ground::tree_bytes() const { return state_->trees.bytes(); }

}  // namespace panwright::terrain
