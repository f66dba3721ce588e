#include "transport/surfels.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "trace/mesh_point.h"
#include "transport/internal/plates.h"

namespace panwright::transport {
namespace {

constexpr std::uint8_t kMostLevels = 2;
constexpr std::uint8_t kHidden = 255;  // level of surfels that nothing reaches
constexpr std::uint32_t kMostSurfels = light::SurfelGrid::kMost;
constexpr double kReach = 1.25;  // of a surfel, spacings

// Plastic number's powers: points spread evenly over the plane. M. Roberts, "The unreasonable
// effectiveness of quasirandom sequences", 2018.
constexpr double kStepU = 0.7548776662466927, kStepV = 0.5698402909980532;

Vec3 position(const pan::MeshView& mesh, std::uint32_t vertex) {
  const auto& p = mesh.positions[vertex];
  return {p.x, p.y, p.z};
}

std::array<Vec3, 3> corners(const pan::MeshView& mesh, std::uint32_t triangle) {
  const trace::Place place = trace::place_of(mesh, triangle, Vec2(0));
  return {position(mesh, place.corner[0]), position(mesh, place.corner[1]),
          position(mesh, place.corner[2])};
}

std::uint8_t direction_of(const Vec3& n) {
  const Vec3 a = glm::abs(n);
  const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
  return static_cast<std::uint8_t>(2 * axis + (n[axis] < 0));
}

Vec3 scales(const trace::Placement& placement) {
  const Mat3& m = placement.model_from_mesh.linear;
  return {glm::length(m[0]), glm::length(m[1]), glm::length(m[2])};
}

using Keyed = std::vector<std::pair<SurfelKey, Point>>;

}  // namespace

Vec3 cosine_direction(const Vec3& normal, double u, double v) {
  // T. Duff et al., "Building an orthonormal basis, revisited", 2017
  const double sign = std::copysign(1.0, normal.z);
  const double a = -1 / (sign + normal.z);
  const double b = normal.x * normal.y * a;
  const Vec3 along(1 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
  const Vec3 across(b, sign + normal.y * normal.y * a, -normal.y);
  const auto turn = det::sincos(2 * kPi * v);
  const double radius = std::sqrt(u);
  return glm::normalize(radius * turn.cos * along + radius * turn.sin * across +
                        std::sqrt(std::max(1 - u, 0.0)) * normal);
}

SurfelSet::SurfelSet(const trace::Scene& scene, std::uint32_t target, const SurfelOptions& options,
                     const Job& job)
    : target_(*scene.targets()[target].target) {
  measure();
  first_.assign(1, 0);
  if (!(area_ > 0) || !std::isfinite(area_)) return;
  spacing_ = std::sqrt(area_ / options.surfels);
  const std::uint64_t count = std::uint64_t{options.surfels} * options.points;
  Keyed all;
  // parts smaller than the spacing have surfels of their own as far as there are enough
  for (int round = 0;; ++round) {
    by_part_ = round == 0;
    spread(count, 0, all, job);
    std::ranges::stable_sort(all, {}, &Keyed::value_type::first);
    std::size_t found = all.empty() ? 0 : 1;
    for (std::size_t i = 1; i < all.size(); ++i) found += all[i].first != all[i - 1].first;
    if (found <= 3 * std::size_t{options.surfels} && found <= kMostSurfels / 2) break;
    if (round > 0) spacing_ *= std::sqrt(2.0);
    assert(round < 64);
    all.clear();
  }
  choose_levels(scene, target, all, 2 * std::uint64_t{options.surfels}, job);
  std::erase_if(all, [&](const auto& one) { return level_of(one.first) > 0; });
  for (std::uint8_t level = 1; level <= kMostLevels; ++level)
    if (std::ranges::find(levels_, level) != levels_.end())
      spread(count << 2 * level, level, all, job);
  gather(std::move(all), job);
  find_limits(target_, points_, first_, kReach * spacing_, surfels_, job);
}

// Areas of both sides of all triangles.
void SurfelSet::measure() {
  const trace::Model& model = target_.model();
  for (std::size_t i = 0; i < target_.parts().size(); ++i) {
    const trace::Model::Part& part = model.parts()[target_.parts()[i]];
    const Mat3& linear = target_.placements()[i].model_from_mesh.linear;
    first_side_.push_back(static_cast<std::uint32_t>(ends_.size()));
    parts_.push_back(target_.parts()[i]);
    const std::size_t triangles = part.mesh.indices.size() / 3;
    for (std::uint32_t t = 0; t < triangles; ++t) {
      const auto corner = corners(part.mesh, t);
      const double area = 0.5 * glm::length(glm::cross(linear * (corner[1] - corner[0]),
                                                       linear * (corner[2] - corner[0])));
      area_ += std::isfinite(area) ? area : 0;
      ends_.push_back(area_);
      if (part.closed) continue;
      area_ += std::isfinite(area) ? area : 0;
      ends_.push_back(area_);
    }
  }
}

double SurfelSet::area(std::size_t surfel) const { return area_ * weights_[surfel]; }

SurfelKey SurfelSet::key_of(std::uint32_t index, std::uint32_t triangle, const Vec2& barycentric,
                            bool back, std::uint8_t level) const {
  const trace::Model::Part& part = target_.model().parts()[index];
  const trace::Placement& placement = target_.placement(index);
  const auto corner = corners(part.mesh, triangle);
  const Vec3 at =
      corner[0] + barycentric.x * (corner[1] - corner[0]) + barycentric.y * (corner[2] - corner[0]);
  const Vec3 scale = scales(placement);
  Vec3 normal = glm::cross(scale * (corner[1] - corner[0]), scale * (corner[2] - corner[0]));
  Vec3 place = scale * at;
  SurfelKey key;
  if (by_part_) {
    key.part = index;
  } else {
    place = placement.model_from_mesh(at);
    normal = placement.normals * glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
  }
  if (back) normal = -normal;
  key.level = level;
  key.side = back;
  key.direction = direction_of(normal);
  const double cube = std::ldexp(spacing_, -int{level});
  constexpr double kLimit = 2e9;
  for (int k = 0; k < 3; ++k)
    // faces of boxes lie within cubes, not between them
    key.cube[static_cast<std::size_t>(k)] = static_cast<std::int32_t>(
        std::clamp(std::floor(place[k] / cube + 0.3819660112501051), -kLimit, kLimit));
  return key;
}

// place: of the cumulated area, m². u, v: in [0, 1)
Point SurfelSet::point_at(double place, double u, double v) const {
  const auto side = static_cast<std::uint32_t>(std::min<std::size_t>(
      static_cast<std::size_t>(std::ranges::upper_bound(ends_, place) - ends_.begin()),
      ends_.size() - 1));
  const auto i = static_cast<std::size_t>(std::ranges::upper_bound(first_side_, side) -
                                          first_side_.begin() - 1);
  Point point;
  point.part = parts_[i];
  const trace::Model::Part& part = target_.model().parts()[point.part];
  const trace::Placement& placement = target_.placements()[i];
  const std::uint32_t number = side - first_side_[i];
  point.triangle = part.closed ? number : number / 2;
  point.back = !part.closed && number % 2 == 1;
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  point.barycentric = {u, v};
  const auto corner = corners(part.mesh, point.triangle);
  const Vec3 at = corner[0] + u * (corner[1] - corner[0]) + v * (corner[2] - corner[0]);
  const Vec3 facet = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
  point.normal =
      trace::unit_or(placement.normals * facet, Vec3(0, 0, 1)) * (point.back ? -1.0 : 1.0);
  // past the chord error and the rounding of coordinates to float
  const Vec3 far = glm::max(glm::abs(part.low), glm::abs(part.high));
  const double error = target_.model().model()->meshes()[part.mesh_index].error;
  const Vec3 scale = scales(placement);
  const double offset = max_component(scale) * (2 * error + 0x1p-22 * max_component(far));
  point.start = placement.model_from_mesh(at) + offset * point.normal;
  return point;
}

// The way that is free above a point; none: it lies within a closed part.
std::optional<double> SurfelSet::free_above(const Point& point) const {
  const geometry::Ray ray{point.start, point.normal};
  const auto hit = target_.closest(ray, trace::Insides::stop);
  if (!hit) return ray.max_distance;
  if (!hit->front && target_.model().parts()[target_.parts()[hit->instance]].closed) return {};
  return hit->distance;
}

// Adds the points of a level. count: of the whole area
void SurfelSet::spread(std::uint64_t count, std::uint8_t level, Keyed& to, const Job& job) const {
  constexpr std::uint64_t kAtOnce = 4096;
  const std::uint64_t chunks = (count + kAtOnce - 1) / kAtOnce;
  std::vector<Keyed> found(chunks);
  parallel_for(
      chunks,
      [&](std::size_t c) {
        const std::uint64_t end = std::min(count, (c + 1) * kAtOnce);
        for (std::uint64_t i = c * kAtOnce; i < end; ++i) {
          const auto number = static_cast<double>(i);
          Point point = point_at(area_ * (number + 0.5) / static_cast<double>(count),
                                 fraction(0.5 + kStepU * number), fraction(0.5 + kStepV * number));
          const auto key = [&](std::uint8_t at) {
            return key_of(point.part, point.triangle, point.barycentric, point.back, at);
          };
          if (level > 0 && level_of(key(0)) != level) continue;
          if (!target_.model().is_there(point.part, point.triangle, point.barycentric)) continue;
          const auto free = free_above(point);
          if (!free) continue;
          point.free = *free;
          found[c].emplace_back(key(level), point);
        }
      },
      job);
  for (Keyed& some : found) to.insert(to.end(), some.begin(), some.end());
}

// Halves cubes until they are small beside the distances of what their points see.
//
//   all   by coarse key
//   most  surfels, about
void SurfelSet::choose_levels(const trace::Scene& scene, std::uint32_t target, Keyed all,
                              std::uint64_t most, const Job& job) {
  constexpr std::uint32_t kRays = 16;
  constexpr std::size_t kLeastHits = 4;
  constexpr double kOfDistance = 0.7;
  constexpr double kGap = 0.1;  // of the spacing
  std::vector<std::size_t> begin;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (i == 0 || all[i].first != all[i - 1].first) {
      begin.push_back(i);
      coarse_.push_back(all[i].first);
    }
  begin.push_back(all.size());
  levels_.assign(coarse_.size(), 0);
  parallel_for(
      coarse_.size(),
      [&](std::size_t s) {
        const std::size_t count = begin[s + 1] - begin[s];
        std::vector<double> distances;
        for (std::uint32_t k = 0; k < kRays; ++k) {
          const Point& point = all[begin[s] + k * count / kRays].second;
          const Vec3 direction =
              cosine_direction(point.normal, (k + 0.5) / kRays, fraction(k * kStepU));
          const trace::Hit hit =
              scene.nearest(trace::Ray{{point.start, direction}, target}, trace::Insides::stop);
          if (hit) distances.push_back(hit.distance);
        }
        if (distances.size() < kLeastHits) return;
        std::ranges::sort(distances);
        // between surfaces on one another there is no light, if nothing opens
        if (distances.size() == kRays && distances[kRays / 2] < kGap * spacing_) {
          levels_[s] = kHidden;
          return;
        }
        const double wanted = kOfDistance * distances[distances.size() / 2];
        while (levels_[s] < kMostLevels && std::ldexp(spacing_, -int{levels_[s]}) > 1.5 * wanted)
          ++levels_[s];
      },
      job);
  for (std::uint8_t largest = kMostLevels;; --largest) {
    std::uint64_t sum = 0;
    for (std::uint8_t& level : levels_) {
      if (level == kHidden) continue;
      level = std::min(level, largest);
      sum += std::uint64_t{1} << 2 * level;
    }
    if (largest == 0 || sum <= std::max<std::uint64_t>(most, coarse_.size())) break;
  }
}

std::uint8_t SurfelSet::level_of(const SurfelKey& coarse) const {
  const auto found = std::ranges::lower_bound(coarse_, coarse);
  if (found == coarse_.end() || *found != coarse) return 0;
  return levels_[static_cast<std::size_t>(found - coarse_.begin())];
}

// Makes the surfels of their points.
void SurfelSet::gather(Keyed all, const Job& job) {
  constexpr std::size_t kAtOnce = 64;
  std::ranges::stable_sort(all, {}, &Keyed::value_type::first);
  std::vector<std::size_t> begin;
  std::vector<Point> points;
  points.reserve(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == 0 || all[i].first != all[i - 1].first) begin.push_back(i);
    points.push_back(all[i].second);
  }
  const std::size_t cubes = begin.size();
  begin.push_back(all.size());
  const auto points_of = [&](std::size_t cube) {
    return std::span<const Point>(points).subspan(begin[cube], begin[cube + 1] - begin[cube]);
  };
  std::vector<std::vector<std::uint8_t>> groups(cubes);
  parallel_for((cubes + kAtOnce - 1) / kAtOnce,
               [&](std::size_t chunk) {
                 for (std::size_t c = chunk * kAtOnce; c < std::min(cubes, (chunk + 1) * kAtOnce);
                      ++c)
                   groups[c] = groups_of(target_, points_of(c),
                                         std::ldexp(spacing_, -int{all[begin[c]].first.level}));
               },
               job);
  points_.reserve(all.size());
  std::vector<Point> group;
  for (std::size_t c = 0; c < cubes; ++c)
    for (std::uint8_t number = 0; number < kMostGroups; ++number) {
      group.clear();
      for (std::size_t k = 0; k < groups[c].size(); ++k)
        if (groups[c][k] == number) group.push_back(points[begin[c] + k]);
      if (!group.empty() && surfels_.size() < kMostSurfels) add(all[begin[c]].first, group);
    }
  double sum = 0;
  for (const double weight : weights_) sum += weight;
  for (double& weight : weights_) weight /= sum;
}

// Adds a surfel.
void SurfelSet::add(const SurfelKey& key, std::span<const Point> points) {
  Vec3 middle(0), normal(0);
  for (const Point& point : points) {
    middle += point.start;
    normal += point.normal;
  }
  const auto count = static_cast<double>(points.size());
  keys_.push_back(key);
  surfels_.push_back({middle / count, trace::unit_or(normal, points[0].normal),
                      kReach * std::ldexp(spacing_, -int{key.level})});
  weights_.push_back(std::ldexp(count, -2 * int{key.level}));
  points_.insert(points_.end(), points.begin(), points.end());
  first_.push_back(static_cast<std::uint32_t>(points_.size()));
}

std::optional<std::uint32_t> SurfelSet::find(const trace::Hit& hit) const {
  const bool back = !hit.front && !target_.model().parts()[hit.part].closed;
  const SurfelKey coarse = key_of(hit.part, hit.triangle, hit.barycentric, back, 0);
  const std::uint8_t level = level_of(coarse);
  const SurfelKey key =
      level == 0 ? coarse : key_of(hit.part, hit.triangle, hit.barycentric, back, level);
  const auto [low, high] = std::equal_range(keys_.begin(), keys_.end(), key);
  if (low == high) return std::nullopt;
  const auto begin = static_cast<std::uint32_t>(low - keys_.begin());
  const auto end = static_cast<std::uint32_t>(high - keys_.begin());
  if (end == begin + 1 && surfels_[begin].limit_count == 0) return begin;
  const auto corner = corners(target_.model().parts()[hit.part].mesh, hit.triangle);
  const Vec3 at = target_.placement(hit.part).model_from_mesh(
      corner[0] + hit.barycentric.x * (corner[1] - corner[0]) +
      hit.barycentric.y * (corner[2] - corner[0]));
  return nearest_part(begin, end, at);
}

// Of the surfels of one cube, that of the point nearest to a place, on its side of plates.
std::optional<std::uint32_t> SurfelSet::nearest_part(std::uint32_t begin, std::uint32_t end,
                                                     const Vec3& place) const {
  std::optional<std::uint32_t> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t s = begin; s < end; ++s) {
    const std::span limits(surfels_[s].limits.data(), surfels_[s].limit_count);
    const bool within = std::ranges::all_of(
        limits, [&](const Vec4& limit) { return glm::dot(limit, Vec4(place, 1)) >= 0; });
    if (!within) continue;
    for (std::uint32_t p = first_[s]; p < first_[s + 1]; ++p) {
      const Vec3 apart = points_[p].start - place;
      const double square = glm::dot(apart, apart);
      if (square >= least) continue;
      best = s;
      least = square;
    }
  }
  return best;
}

}  // namespace panwright::transport
