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
using internal::AcceptPoint;
using internal::BeamState;
using internal::ChartSurface;
using internal::GroundApproach;
using internal::GroundWalk;
using internal::RayGrid;
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
                                const BeamState* beam = nullptr) const {
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
      walk.leaves_ground = any && beam && beam->leaves_ground && charts.size() == 1;
      if (beam == nullptr)
        charts[c].cast(walk, refined, trees);
      else
        charts[c].cast(walk, *beam, trees);
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

  // Leaves out tiles without squares that rays of a beam may meet.
  void find_squares(const TerrainBeam& rays, BeamState& beam) const {
    constexpr std::size_t kMany = 16;  // of a tile: then its tree is quicker
    std::erase_if(beam.tiles, [&](BeamState::Tile& each) {
      const std::size_t first = beam.squares.size();
      trees.of(each.tile, charts.front()).find(rays, beam.squares);
      const std::size_t found = beam.squares.size() - first;
      if (found > kMany) beam.squares.resize(first);
      each.first = static_cast<std::uint32_t>(first);
      each.end = static_cast<std::uint32_t>(beam.squares.size());
      return found == 0;
    });
    beam.ends.front() = beam.tiles.size();
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

  // Hit of a ray; what it met through a gap between levels, of level 0.
  std::optional<GroundHit> without_gap(const std::optional<GroundHit>& hit, const TerrainRay& ray,
                                       const GroundLevels* levels) const {
    if (levels == nullptr) return hit;
    const bool gap = hit ? glm::dot(hit->point.normal, ray.direction) > 0 : goes_below(ray);
    return gap ? cast(ray, false, nullptr) : hit;
  }

  // Rays of a beam by their grid; false: one by one they are quicker.
  bool cast_together(const Vec3& origin, std::span<const Vec3> directions,
                     std::span<const double> most, std::span<std::optional<GroundHit>> hits,
                     const GroundLevels* levels, const BeamState& beam) const {
    static thread_local RayGrid grid;
    static thread_local std::vector<RayGrid::Cell> cells;
    const TreeCache::Use use(trees);
    if (!grid.set(origin, beam.axis, directions, most)) return false;
    for (std::uint32_t c = 0; c < charts.size(); ++c) {
      const AcceptPoint accept = [&](const Vec3& point) { return !is_covered(c, point); };
      if (!charts[c].cast(grid, beam, c > 0 ? &accept : nullptr, trees)) return false;
    }
    cells.resize(directions.size());
    grid.cells(cells);
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const TerrainRay ray{origin, directions[i], 0, most[i]};
      hits[i] = without_gap(exact(ray, cells[i], levels, beam), ray, levels);
    }
    return true;
  }

  // The hit of a ray in the cell that its grid found.
  std::optional<GroundHit> exact(const TerrainRay& ray, const RayGrid::Cell& cell,
                                 const GroundLevels* levels, const BeamState& beam) const {
    if (cell.tile == RayGrid::Cell::kNone) return {};
    auto c = static_cast<std::uint32_t>(charts.size() - 1);
    while (cell.tile < charts[c].record().first_tile) --c;
    const auto is_open = [&](const TriangleHit& hit) {
      return !is_covered(c, ray.origin + hit.distance * ray.direction);
    };
    const AcceptHit accept = std::cref(is_open);
    GroundWalk walk{ray, false, c > 0 ? &accept : nullptr, ray.most, {}};
    trees.of(cell.tile, charts[c]).cast(walk, cell.x, cell.y);
    // an edge that only its wider neighbour's grid has
    if (!walk.best) return cast(ray, false, levels, &beam);
    const Vec3 position = ray.origin + walk.best->distance * ray.direction;
    return GroundHit{walk.best->distance, charts[c].point_of(*walk.best, position, false)};
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
  // more than the places of origins are rounded by
  const double radius = rays.radius * (1 + 1e-9) + 1e-12 * glm::length(rays.origin);
  const double angle = rays.angle + 1e-7;
  constexpr double kWide = 0.5;  // radians
  if (!(angle < kWide)) return {};
  const auto beam = std::make_shared<BeamState>();
  beam->origin = rays.origin;
  beam->axis = rays.axis;
  beam->square = radius * radius;
  beam->cosine = det::cos(angle);
  beam->levels = levels;
  beam->leaves_ground = rays.leaves_ground;
  const auto refined =
      levels ? std::span<const std::uint8_t>(levels->refined_) : std::span<const std::uint8_t>();
  constexpr std::size_t kMany = 48;
  const TerrainBeam all{rays.origin, rays.axis, radius, det::sin(angle), rays.leaves_ground};
  for (const ChartSurface& chart : state_->charts) {
    chart.find(all, refined, beam->tiles);
    if (beam->tiles.size() > kMany) return {};
    beam->ends.push_back(beam->tiles.size());
  }
  beam->use = std::make_shared<const TreeCache::Use>(state_->trees);
  // where charts overlap the ground has steps
  if (rays.leaves_ground && state_->charts.size() == 1) state_->find_squares(all, *beam);
  GroundBeam out;
  out.state_ = beam;
  return out;
}

std::optional<GroundHit> Ground::nearest(const Vec3& origin, const Vec3& direction, double least,
                                         double most, const GroundLevels* levels,
                                         const GroundBeam* beam) const {
  const TerrainRay ray{origin, direction, least, most};
  const BeamState* const tiles = beam != nullptr ? beam->state_.get() : nullptr;
  const bool beamed = tiles != nullptr && !tiles->leaves_ground && tiles->levels == levels &&
                      tiles->holds(origin, direction);
  return state_->without_gap(state_->cast(ray, false, levels, beamed ? tiles : nullptr), ray,
                             levels);
}

void Ground::nearest(const Vec3& origin, std::span<const Vec3> directions,
                     std::span<const double> most, std::span<std::optional<GroundHit>> hits,
                     const GroundLevels* levels, const GroundBeam* beam) const {
  assert(directions.size() == most.size() && directions.size() == hits.size());
  constexpr std::size_t kFew = 8;
  const BeamState* const tiles = beam != nullptr ? beam->state_.get() : nullptr;
  if (directions.size() >= kFew && tiles != nullptr && !tiles->leaves_ground &&
      tiles->levels == levels &&
      std::ranges::all_of(directions, [&](const Vec3& d) { return tiles->holds(origin, d); }) &&
      state_->cast_together(origin, directions, most, hits, levels, *tiles))
    return;
  for (std::size_t i = 0; i < directions.size(); ++i)
    hits[i] = nearest(origin, directions[i], 0, most[i], levels, beam);
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
  const BeamState* const tiles = beam != nullptr ? beam->state_.get() : nullptr;
  const bool beamed =
      tiles != nullptr && tiles->levels == levels && tiles->holds(origin, direction);
  if (beamed && tiles->tiles.empty()) return false;
  return state_->cast(ray, true, levels, beamed ? tiles : nullptr).has_value();
}

std::size_t Ground::tree_bytes() const { return state_->trees.bytes(); }

}  // namespace panwright::terrain
