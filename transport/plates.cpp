#include "transport/internal/plates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>

#include "base/parallel.h"
#include "light/surfels.h"
#include "trace/mesh_point.h"

namespace panwright::transport {
namespace {

// Height of a line of sight above the points at its ends: of the cube's side, and of what is free.
constexpr double kOfSide = 0.25;
constexpr double kOfFree = 0.45;

Vec3 raised(const Point& point, double side) {
  return point.start + std::min(kOfSide * side, kOfFree * point.free) * point.normal;
}

std::optional<geometry::InstanceHit> between(const trace::Target& target, const Vec3& from,
                                             const Vec3& to) {
  const Vec3 way = to - from;
  const double length = glm::length(way);
  if (!(length > 0)) return {};
  return target.closest({from, way / length, 0, length}, trace::Insides::stop);
}

}  // namespace

std::vector<std::uint8_t> groups_of(const trace::Target& target, std::span<const Point> points,
                                    double side) {
  struct Group {
    std::size_t first = 0, farthest = 0, count = 0;
    double width = 0;
  };
  const auto sees = [&](const Vec3& from, std::size_t point) {
    return !between(target, from, raised(points[point], side));
  };
  std::vector<Group> groups;
  std::vector<std::uint8_t> numbers(points.size(), kNoGroup);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 from = raised(points[i], side);
    const auto found = std::ranges::find_if(groups, [&](const Group& group) {
      return sees(from, group.first) && (group.count == 1 || sees(from, group.farthest));
    });
    if (found == groups.end() && groups.size() == kMostGroups) continue;
    Group& group = found == groups.end() ? groups.emplace_back(Group{i, i, 0, 0}) : *found;
    numbers[i] = static_cast<std::uint8_t>(&group - groups.data());
    ++group.count;
    const double width = glm::length(points[i].start - points[group.first].start);
    if (width > group.width) {
      group.width = width;
      group.farthest = i;
    }
  }
  return numbers;
}

namespace {

// Surfels by cubes as wide as their largest reach.
class Neighbours {
 public:
  Neighbours(std::span<const light::Surfel> surfels, double side) : side_(side) {
    for (std::uint32_t s = 0; s < surfels.size(); ++s)
      cubes_[key(glm::floor(surfels[s].position / side_))].push_back(s);
  }
  template <class Use>
  void each(const Vec3& at, const Use& use) const {
    const Vec3 cube = glm::floor(at / side_);
    for (int i = 0; i < 27; ++i) {
      const auto found = cubes_.find(key(cube + Vec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
      if (found == cubes_.end()) continue;
      for (const std::uint32_t s : found->second) use(s);
    }
  }

 private:
  static std::uint64_t key(const Vec3& cube) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k)
      key = key << 21 |
            (static_cast<std::uint64_t>(std::clamp(cube[k], -1048576.0, 1048575.0) + 1048576) &
             0x1fffff);
    return key;
  }
  double side_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cubes_;
};

// A point that a surfel reaches.
struct Reached {
  std::uint32_t point = 0;
  bool seen = true;
};

// A plane that may part a surfel from what it does not see.
struct Blocker {
  Vec3 normal{0};  // unit, towards the surfel
  double place = 0;
};

// Finds the limits of one surfel after the other.
class Limits {
 public:
  Limits(const trace::Target& target, std::span<const Point> points,
         std::span<const std::uint32_t> first, std::span<const light::Surfel> surfels)
      : target_(target), points_(points), first_(first), surfels_(surfels) {
    for (std::size_t s = 0; s < surfels.size(); ++s) {
      std::uint32_t middle = first[s];
      double least = std::numeric_limits<double>::infinity();
      for (std::uint32_t p = first[s]; p < first[s + 1]; ++p) {
        const Vec3 apart = points[p].start - surfels[s].position;
        if (glm::dot(apart, apart) < least) {
          least = glm::dot(apart, apart);
          middle = p;
        }
      }
      middles_.push_back(middle);
    }
  }

  void find(std::uint32_t s, const Neighbours& neighbours, light::Surfel& to) const {
    std::vector<Reached> reached;
    std::vector<Blocker> blockers;
    neighbours.each(surfels_[s].position,
                    [&](std::uint32_t other) { look_at(s, other, reached, blockers); });
    if (blockers.empty()) return;
    to.limit_count = 0;
    while (to.limit_count < light::Surfel::kMostLimits) {
      const std::optional<Vec4> best = best_limit(s, reached, blockers);
      if (!best) break;
      to.limits[to.limit_count++] = *best;
      std::erase_if(reached, [&](const Reached& one) {
        return glm::dot(*best, Vec4(points_[one.point].start, 1)) < 0;
      });
    }
  }

 private:
  // Adds the points of another surfel that are reached, and what stands before them.
  void look_at(std::uint32_t s, std::uint32_t other, std::vector<Reached>& reached,
               std::vector<Blocker>& blockers) const {
    constexpr double kAcross = 8;  // as light::irradiance_at()
    const light::Surfel& own = surfels_[s];
    const light::Surfel& its = surfels_[other];
    if (other == s || !(glm::dot(own.normal, its.normal) > 0)) return;
    if (glm::length(its.position - own.position) > own.radius + its.radius) return;
    const std::size_t before = reached.size();
    for (std::uint32_t p = first_[other]; p < first_[other + 1]; ++p) {
      const Vec3 apart = points_[p].start - own.position;
      const double across = glm::dot(apart, own.normal);
      if (glm::dot(apart, apart) + kAcross * across * across < own.radius * own.radius)
        reached.push_back({p, true});
    }
    const std::size_t count = reached.size() - before;
    if (count == 0) return;
    // two lines of sight: past a strut light gets round
    const Point& middle = points_[middles_[s]];
    const double side = own.radius;
    std::optional<Blocker> first;
    for (const std::size_t share : {2u, 4u}) {
      const Point& point = points_[reached[before + count / share].point];
      const Vec3 from = raised(middle, side), to = raised(point, std::min(side, its.radius));
      const auto hit = between(target_, from, to);
      if (!hit) return;
      if (!first) first = blocker_at(*hit, from, to);
    }
    for (std::size_t i = before; i < reached.size(); ++i) reached[i].seen = false;
    const bool known = std::ranges::any_of(
        blockers, [&](const Blocker& one) { return glm::dot(one.normal, first->normal) > 0.999; });
    if (!known) blockers.push_back(*first);
  }

  Blocker blocker_at(const geometry::InstanceHit& hit, const Vec3& from, const Vec3& to) const {
    const trace::Placement& placement = target_.placements()[hit.instance];
    const pan::MeshView& mesh = target_.model().parts()[target_.parts()[hit.instance]].mesh;
    const trace::Place place = trace::place_of(mesh, hit.triangle, hit.barycentric);
    const Vec3 way = glm::normalize(to - from);
    Vec3 normal =
        trace::unit_or(placement.normals * trace::point_of(mesh, place, true).facet, -way);
    if (glm::dot(normal, way) > 0) normal = -normal;
    return {normal, glm::dot(normal, from + hit.distance * way)};
  }

  // The plane that parts the surfel's points from most of those that it does not see.
  std::optional<Vec4> best_limit(std::uint32_t s, std::span<const Reached> reached,
                                 std::span<const Blocker> blockers) const {
    constexpr double kLeastGap = 1e-3;  // of the radius
    constexpr int kWorth = 8;           // of a point that is not seen beside one that is
    constexpr double kMargin = 0.25;    // of the gap between points of both sides
    constexpr double kLeft = 0.05;      // of its points, about a corner of plates
    std::optional<Vec4> best;
    std::vector<double> places;
    int most = 0;
    for (const Blocker& blocker : blockers) {
      const Vec3& normal = blocker.normal;
      double beyond = -std::numeric_limits<double>::infinity();
      places.clear();
      for (std::uint32_t p = first_[s]; p < first_[s + 1]; ++p)
        places.push_back(glm::dot(normal, points_[p].start));
      std::ranges::sort(places);
      const double own =
          places[static_cast<std::size_t>(kLeft * static_cast<double>(places.size()))];
      const double least = kLeastGap * surfels_[s].radius;
      for (const Reached& one : reached) {
        const double place = glm::dot(normal, points_[one.point].start);
        if (!one.seen && place < own - least) beyond = std::max(beyond, place);
      }
      if (!std::isfinite(beyond)) continue;
      const double gap = own - beyond;
      const double place = std::clamp(blocker.place, beyond + kMargin * gap, own - kMargin * gap);
      int score = 0;
      for (const Reached& one : reached)
        if (glm::dot(normal, points_[one.point].start) < place) score += one.seen ? -1 : kWorth;
      if (score <= most) continue;
      most = score;
      best = Vec4(normal, -place);
    }
    return best;
  }

  const trace::Target& target_;
  std::span<const Point> points_;
  std::span<const std::uint32_t> first_;
  std::span<const light::Surfel> surfels_;
  std::vector<std::uint32_t> middles_;  // the point nearest to the middle of each
};

}  // namespace

void find_limits(const trace::Target& target, std::span<const Point> points,
                 std::span<const std::uint32_t> first, double reach,
                 std::span<light::Surfel> surfels, const Job& job) {
  constexpr std::size_t kAtOnce = 64;
  if (surfels.empty()) return;
  const Neighbours neighbours(surfels, 2 * reach);
  const Limits limits(target, points, first, surfels);
  parallel_for((surfels.size() + kAtOnce - 1) / kAtOnce,
               [&](std::size_t chunk) {
                 const std::size_t end = std::min(surfels.size(), (chunk + 1) * kAtOnce);
                 for (std::size_t s = chunk * kAtOnce; s < end; ++s)
                   limits.find(static_cast<std::uint32_t>(s), neighbours, surfels[s]);
               },
               job);
}

}  // namespace panwright::transport
