#include "compiler/internal/visibility.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "base/parallel.h"
#include "base/random.h"
#include "geometry/ray/instances.h"

namespace panwright::compiler::internal {

namespace {

using geometry::InstanceHit;

constexpr std::size_t kChunk = 2048;  // lines that a thread takes at once
// of the model's radius: surfaces closer than that fight for the same depth in a texture
constexpr double kSlack = 1e-5;
// sine of the angle between surfaces that do so over more than a line
constexpr double kParallel = 1e-3;
// sine of the angle between facets of one surface
constexpr double kSmooth = 0.2;
// of the radius: a line passes an edge on the side where double says it does
constexpr double kRounding = 1e-12;
// of the radius: farther than what a search in single precision may be wrong by (2e-6)
constexpr double kAside = 3e-6;
const Vec2 kThirds[] = {{0.8, 0.6},
                        {-0.9196152422706632, 0.39282032302755},
                        {0.1196152422706632, -0.99282032302755}};  // of a turn apart
// of the lines from outside, every so many-th looks for surfaces in the same place
constexpr std::uint32_t kShare = 8;
constexpr std::size_t kSteps = 8;  // parts of the lines from outside
constexpr std::uint32_t kFirstProbes = 32;
constexpr std::uint64_t kProbes = 1'000'000;  // for all triangles together, at least
constexpr std::uint32_t kMostProbes = 4096;   // for one
constexpr std::uint32_t kMostDeepProbes = 16384;
constexpr std::uint32_t kDeepProbes = 2048;  // for each that faces what is seen
// lines of images as wide as the model, of which those through what is left are followed: as many
// as 7,600 of 256² pixels hold
constexpr double kAreaLines = 5e8;
// of the radius squared: such a texture covers 4 of it, and a face shows half its area
constexpr double kBallArea = 8;
constexpr int kAreaRounds = 4;
constexpr int kFrontierRounds = 8;
constexpr std::uint64_t kFrontierLines = 400'000;   // of a round
constexpr std::uint64_t kMostFrontierLines = 2048;  // through one triangle
constexpr int kExplorations = 64;                   // rounds
constexpr int kConfirmations = 3;

struct Line {
  Vec3 origin;
  Vec3 direction;  // unit, inwards
};

// A triangle that a line of this round was the first to meet.
struct Find {
  std::uint32_t triangle;
  std::uint32_t line;
  auto operator<=>(const Find&) const = default;
};

Vec3 on_sphere(double a, double b) {
  const double z = 2 * a - 1;
  const double across = std::sqrt(std::max(0.0, 1 - z * z));
  const auto turn = det::sincos(2 * kPi * b);
  return {across * turn.cos, across * turn.sin, z};
}

// Two directions across a unit vector.
std::array<Vec3, 2> across(const Vec3& d) {
  const Vec3 other = std::fabs(d.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  const Vec3 right = glm::normalize(glm::cross(d, other));
  return {right, glm::cross(d, right)};
}

double part(double x) { return x - std::floor(x); }

// Numbers for places, equal ones alike, from 0.
std::pair<std::vector<std::uint32_t>, std::uint32_t> places_of(const std::vector<Vec3>& positions) {
  const std::size_t count = positions.size();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(count);
  for (std::uint32_t v = 0; v < count; ++v) {
    std::uint64_t h = 0x9e3779b97f4a7c15ull;  // 2^64 / golden ratio
    for (int axis = 0; axis < 3; ++axis) {
      h ^= std::bit_cast<std::uint64_t>(positions[v][axis] + 0.0);
      h *= 0xff51afd7ed558ccdull;  // MurmurHash3's 64-bit finaliser
      h ^= h >> 32;
    }
    order[v] = {h, v};
  }
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> places(count);
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < count; ++i) {
    number += i > 0 && (order[i].first != order[i - 1].first ||
                        positions[order[i].second] != positions[order[i - 1].second]);
    places[order[i].second] = number;
  }
  return {std::move(places), number + 1};
}

class VisibilityRays {
 public:
  VisibilityRays(World world, const VisibilityOptions& options, const Job& job)
      : world_(std::move(world)), options_(options), job_(job) {}

  Visibility run() {
    const std::size_t count = world_.triangles.size();
    hit_ = std::vector<std::atomic<std::uint16_t>>(2 * count);
    exposed_ = std::vector<std::atomic<char>>(count);
    kept_.resize(count);
    line_.resize(count);
    if (prepare()) {
      trace();
      keep_ambiguous();
    }
    Visibility out;
    out.seen.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) out.seen[i] = seen(i) || kept_[i];
    out.rays = rays_;
    out.last_rays = last_rays_;
    out.last_found = last_found_;
    out.probes = probes_;
    out.kept.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) out.kept[i] = undecided(i) && kept_[i];
    return out;
  }

 private:
  // False: nothing to see.
  bool prepare() {
    if (world_.triangles.empty()) return false;
    Vec3 low(HUGE_VAL);
    Vec3 high(-HUGE_VAL);
    for (const geometry::Triangle& t : world_.triangles)
      for (const std::uint32_t v : t) {
        low = glm::min(low, world_.positions[v]);
        high = glm::max(high, world_.positions[v]);
      }
    centre_ = 0.5 * low + 0.5 * high;
    radius_ = glm::length(0.5 * high - 0.5 * low);
    if (!(radius_ > 0)) return false;
    has_transparent_ = std::find(world_.transparent.begin(), world_.transparent.end(), 1) !=
                       world_.transparent.end();
    caster_.add(caster_.add_mesh(world_.positions, world_.triangles), Mat4(1), true);
    caster_.build(job_);
    list_neighbours();
    return true;
  }

  void trace() {
    Phase phase(job_, "looking for hidden parts", kSteps + 5);
    std::vector<Find> late;
    for (std::size_t step = 0; step < kSteps; ++step) {
      const std::vector<Find> found = from_outside(options_.rays_from_outside / kSteps);
      if (step >= kSteps / 2) late.insert(late.end(), found.begin(), found.end());
      phase.advance();
    }
    explore(late, true);
    phase.advance();
    probe_all();
    phase.advance();
    search_frontier();
    phase.advance();
    search_by_area();
    phase.advance();
    for (int i = 0; i < kConfirmations; ++i) {
      last_rays_ = options_.rays_from_outside;
      const std::vector<Find> found = from_outside(last_rays_);
      last_found_ = found.size();
      if (found.empty()) break;
      explore(found, false);
    }
  }

  // Triangles next to such that are seen: what shows of them may be a sliver, seen edge on.
  void search_frontier() {
    std::vector<char> searched(world_.triangles.size(), 0);
    for (int i = 0; i < kFrontierRounds; ++i) {
      std::vector<Neighbours> frontier;
      for (std::uint32_t t = 0; t < searched.size(); ++t) {
        if (searched[t] || !undecided(t)) continue;
        Neighbours one{t, 0, {}};
        for_neighbours(t, [&](std::uint32_t other) {
          if (seen(other) && one.count < one.seen.size()) one.seen[one.count++] = other;
        });
        if (one.count == 0) continue;
        searched[t] = 1;
        frontier.push_back(one);
      }
      if (frontier.empty()) return;
      explore(through_frontier(frontier), false);
    }
  }

  // Lines through what is left as those of images are: evenly over area and direction. What is
  // large takes most of them, as it would take most pixels.
  void search_by_area() {
    const std::uint64_t most = options_.max_probes / kAreaRounds;
    for (int round = 0; round < kAreaRounds; ++round) {
      std::vector<std::uint32_t> triangles;
      std::vector<double> sums;  // of areas, in squares of the radius
      double sum = 0;
      for (std::uint32_t i = 0; i < world_.triangles.size(); ++i) {
        if (!undecided(i) || !exposed_[i] || keep_exposed_) continue;
        triangles.push_back(i);
        sums.push_back(sum += area(i) / (radius_ * radius_));
      }
      const auto count = static_cast<std::uint64_t>(
          std::min(static_cast<double>(most), kAreaLines / kAreaRounds * sum / kBallArea));
      if (count == 0) return;
      const auto make = [&](std::uint64_t i) -> std::optional<Line> {
        const auto index = static_cast<std::uint32_t>(i);
        const auto random = philox({index, static_cast<std::uint32_t>(round), 0, 0}, {0x51947, 5});
        const auto more = philox({index, static_cast<std::uint32_t>(round), 1, 0}, {0x51947, 5});
        const double at =
            sum * (static_cast<double>(i) + in_unit(random[0])) / static_cast<double>(count);
        const std::size_t k = std::min<std::size_t>(
            static_cast<std::size_t>(std::upper_bound(sums.begin(), sums.end(), at) - sums.begin()),
            sums.size() - 1);
        double u = in_unit(random[1]);
        double v = in_unit(random[2]);
        if (u + v > 1) {
          u = 1 - u;
          v = 1 - v;
        }
        const auto [a, b, c] = corners(triangles[k]);
        const Vec3 point = a + u * (b - a) + v * (c - a);
        // even over the area that a direction shows
        const Vec3 front = normal(triangles[k]);
        const Vec3 outwards = glm::normalize((random[3] & 1 ? front : -front) +
                                             on_sphere(in_unit(more[0]), in_unit(more[1])));
        if (!is_finite(outwards)) return std::nullopt;
        if (!has_transparent_ && caster_.any({point, outwards, kSlack * radius_}))
          return std::nullopt;
        return through(point, -outwards);
      };
      explore(cast(count, make), false);
    }
  }

  double area(std::uint32_t triangle) const {
    const auto [a, b, c] = corners(triangle);
    return 0.5 * glm::length(glm::cross(b - a, c - a));
  }

  // Says which triangles stay although nothing met them: such as face a surface that is seen, where
  // they are too many to be sure of, and else those that go on from a seen one about as smoothly as
  // one surface. Of a gap that shows a sliver of one, few lines may come upon the next.
  void keep_ambiguous() {
    for (std::uint32_t i = 0; i < kept_.size(); ++i)
      if (undecided(i) && exposed_[i]) kept_[i] = keep_exposed_ || goes_on_from_seen(i);
  }

  bool goes_on_from_seen(std::uint32_t triangle) const {
    const Vec3 front = normal(triangle);
    bool found = false;
    for_neighbours(triangle, [&](std::uint32_t other) {
      if (found || !seen(other)) return;
      int common = 0;
      for (const std::uint32_t a : world_.triangles[triangle])
        for (const std::uint32_t b : world_.triangles[other]) common += place_[a] == place_[b];
      found = common >= 2 && glm::length(glm::cross(front, normal(other))) < kSmooth;
    });
    return found;
  }

  // ---- places and neighbours

  // Triangles that have a corner in common, by its place.
  void list_neighbours() {
    std::uint32_t places = 0;
    std::tie(place_, places) = places_of(world_.positions);
    start_.assign(std::size_t{places} + 2, 0);
    for (const geometry::Triangle& t : world_.triangles)
      for (const std::uint32_t v : t) ++start_[place_[v] + 2];
    for (std::size_t i = 2; i < start_.size(); ++i) start_[i] += start_[i - 1];
    around_.resize(start_.back());
    for (std::uint32_t i = 0; i < world_.triangles.size(); ++i)
      for (const std::uint32_t v : world_.triangles[i]) around_[start_[place_[v] + 1]++] = i;
  }

  template <class Body>
  void for_neighbours(std::uint32_t triangle, const Body& body) const {
    constexpr std::uint32_t kMost = 64;  // at one place
    for (const std::uint32_t v : world_.triangles[triangle]) {
      const std::uint32_t begin = start_[place_[v]];
      const std::uint32_t end = std::min(start_[place_[v] + 1], begin + kMost);
      for (std::uint32_t i = begin; i < end; ++i)
        if (around_[i] != triangle) body(around_[i]);
    }
  }

  // Between rounds.
  bool seen(std::uint32_t triangle) const {
    return hit_[2 * std::size_t{triangle}] != 0 || hit_[2 * std::size_t{triangle} + 1] != 0;
  }
  bool undecided(std::uint32_t triangle) const {
    return world_.candidate[triangle] && !seen(triangle);
  }

  // The round in which a side of a triangle was met first; 0: none.
  std::atomic<std::uint16_t>& first_hit(const InstanceHit& hit) {
    return hit_[2 * std::size_t{hit.triangle} + (hit.front ? 0 : 1)];
  }
  bool was_hit_before(const InstanceHit& hit) {
    const std::uint16_t round = first_hit(hit).load(std::memory_order_relaxed);
    return round != 0 && round != round_;
  }

  // An undecided triangle and those next to it that are seen.
  struct Neighbours {
    std::uint32_t triangle;
    std::size_t count;
    std::array<std::uint32_t, 8> seen;
  };

  // ---- one line

  struct Hits {
    static constexpr std::size_t kMost = 64;
    std::array<InstanceHit, kMost> list;
    std::size_t count = 0;
    const World* world = nullptr;
    bool opaque_count = false;
  };

  // Remembers what a ray passes; what hides nothing lets it through.
  static bool remember(const void* data, const InstanceHit& hit) {
    auto& hits = *static_cast<Hits*>(const_cast<void*>(data));
    if (hits.count < Hits::kMost) hits.list[hits.count++] = hit;
    return hits.opaque_count && !hits.world->transparent[hit.triangle];
  }

  std::array<Vec3, 3> corners(std::uint32_t triangle) const {
    const geometry::Triangle& t = world_.triangles[triangle];
    return {world_.positions[t[0]], world_.positions[t[1]], world_.positions[t[2]]};
  }

  // Whether a line goes through a triangle beyond what rounding could have made of it.
  bool goes_through(const Line& line, const InstanceHit& hit) const {
    const auto& [u, v] = std::pair{hit.barycentric.x, hit.barycentric.y};
    constexpr double kClear = 1e-3;
    if (u > kClear && v > kClear && 1 - u - v > kClear) return true;
    const Vec3 at = line.origin + hit.distance * line.direction;
    const auto [a, b, c] = corners(hit.triangle);
    double sign = 0;
    for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
      const Vec3 edge = to - from;
      const double side = glm::dot(line.direction, glm::cross(from - at, edge));
      if (!(std::fabs(side) > kRounding * radius_ * glm::length(edge))) return false;
      if (side * sign < 0) return false;
      sign = side;
    }
    return true;
  }

  // A line that rounding let through a seam is alone: those beside it are stopped.
  bool is_open(const Line& line, const InstanceHit& hit) const {
    const Vec3 front = normal(hit.triangle);
    const double slope = glm::dot(front, line.direction);
    if (slope == 0) return false;
    const auto [right, up] = across(line.direction);
    int open = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec3 aside = kAside * radius_ * (kThirds[k].x * right + kThirds[k].y * up);
      const double end = hit.distance - glm::dot(front, aside) / slope;
      if (std::fabs(end - hit.distance) > radius_) continue;
      Hits hits;
      hits.world = &world_;
      hits.opaque_count = true;
      const geometry::Ray ray{line.origin + aside, line.direction, 0, end - kSlack * radius_};
      open += !(has_transparent_ ? caster_.any(ray, {remember, &hits}) : caster_.any(ray));
    }
    return open >= 2;
  }

  void mark(const Line& line, const InstanceHit& hit, std::uint32_t index,
            std::vector<Find>& found) {
    if (was_hit_before(hit) || !is_open(line, hit)) return;
    first_hit(hit).store(round_, std::memory_order_relaxed);
    found.push_back({hit.triangle, index});
  }

  Vec3 normal(std::uint32_t triangle) const {
    const auto [a, b, c] = corners(triangle);
    const Vec3 cross = glm::cross(b - a, c - a);
    const double length = glm::length(cross);
    return length > 0 ? cross / length : Vec3(0);
  }

  // Marks what a line from outside meets first, and what lies in the same surface.
  // thorough: also where it has been met before
  void follow(const Line& line, std::uint32_t index, bool thorough, std::vector<Find>& found) {
    Hits hits;
    hits.world = &world_;
    hits.opaque_count = true;
    geometry::Ray ray{line.origin, line.direction};
    const auto first =
        has_transparent_ ? caster_.closest(ray, {remember, &hits}) : caster_.closest(ray);
    const double end = first ? first->distance : HUGE_VAL;
    // what it sees through
    for (std::size_t i = 0; i < hits.count; ++i)
      if (world_.transparent[hits.list[i].triangle] &&
          hits.list[i].distance <= end + kSlack * radius_ && goes_through(line, hits.list[i]))
        mark(line, hits.list[i], index, found);
    // past an edge, a line that only seems to meet a triangle proves nothing
    if (!first || !goes_through(line, *first)) return;
    mark(line, *first, index, found);
    if (!thorough && index % kShare != 0) return;
    hits.count = 0;
    hits.opaque_count = false;
    ray.min_distance = end;
    ray.max_distance = end + kSlack * radius_;
    (void)caster_.closest(ray, {remember, &hits});
    if (hits.count < 2) return;
    const Vec3 front = normal(first->triangle);
    for (std::size_t i = 0; i < hits.count; ++i) {
      const InstanceHit& hit = hits.list[i];
      if (hit.triangle != first->triangle && goes_through(line, hit) &&
          glm::length(glm::cross(front, normal(hit.triangle))) < kParallel)
        mark(line, hit, index, found);
    }
  }

  // ---- many lines

  // Follows lines make(i), where it makes one; what they were the first to meet, each triangle
  // once, in order of triangles. The lines are remembered.
  template <class Make>
  std::vector<Find> cast(std::uint64_t count, const Make& make, bool thorough = true) {
    if (round_ < 0xffff) ++round_;
    const auto chunks = static_cast<std::size_t>((count + kChunk - 1) / kChunk);
    std::vector<std::vector<Find>> parts(chunks);
    const auto cast_chunk = [&](std::size_t c) {
      const std::uint64_t end = std::min<std::uint64_t>(count, (c + 1) * kChunk);
      for (std::uint64_t i = c * kChunk; i < end; ++i)
        if (const std::optional<Line> line = make(i))
          follow(*line, static_cast<std::uint32_t>(i), thorough, parts[c]);
    };
    parallel_for(chunks, cast_chunk, job_);
    rays_ += count;
    std::vector<Find> found;
    for (const auto& one : parts) found.insert(found.end(), one.begin(), one.end());
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end(),
                            [](const Find& a, const Find& b) { return a.triangle == b.triangle; }),
                found.end());
    // what is known from its other side is nothing new
    std::erase_if(found, [&](const Find& find) {
      for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
        const std::uint16_t round = hit_[2 * std::size_t{find.triangle} + side];
        if (round != 0 && round != round_) return true;
      }
      return false;
    });
    for (const Find& find : found) line_[find.triangle] = *make(find.line);
    return found;
  }

  Line through(const Vec3& point, const Vec3& inwards) const {
    const double back = glm::dot(point - centre_, inwards) + 2 * radius_;
    return {point - back * inwards, inwards};
  }

  // Even in direction and place: multiples of powers of the root of x⁵ = x + 1 (Roberts, "The
  // unreasonable effectiveness of quasirandom sequences", 2018).
  std::vector<Find> from_outside(std::uint64_t count) {
    const std::uint64_t base = outside_;
    outside_ += count;
    return cast(
        count,
        [&](std::uint64_t i) -> std::optional<Line> {
          const auto n = static_cast<double>(base + i) + 0.5;
          const Vec3 d = on_sphere(part(n * 0.8566748838545029), part(n * 0.733891856627126));
          const double r = radius_ * std::sqrt(part(n * 0.6287067210378087));
          const auto turn = det::sincos(2 * kPi * part(n * 0.5385972572236101));
          const auto [right, up] = across(d);
          return through(centre_ + r * turn.cos * right + r * turn.sin * up, d);
        },
        false);
  }

  // Corners, edges and insides in turn.
  Vec3 point_of(std::uint32_t triangle, std::uint32_t number,
                const std::array<std::uint32_t, 4>& random) const {
    constexpr double kInset = 1e-3;
    double u = in_unit(random[0]);
    double v = in_unit(random[1]);
    if (number % 4 == 0) {  // a corner
      u = v = kInset;
    } else if (number % 4 == 1) {  // an edge
      v = kInset;
    } else if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const auto c = corners(triangle);
    const std::uint32_t k = number / 4 % 3;
    return c[k] + u * (c[(k + 1) % 3] - c[k]) + v * (c[(k + 2) % 3] - c[k]);
  }

  // Lines through what was not met, in rounds; what they find is explored. First a few through all,
  // which tell what faces a surface that is seen: that is where gaps are, and many more go there.
  // Where such triangles are too many to be sure of, they stay.
  void probe_all() {
    const std::uint32_t first = std::min(kFirstProbes, options_.rays_per_triangle);
    probe_rounds(Which::all, 0, first, first);
    probe_rounds(Which::enclosed, kProbes, options_.rays_per_triangle, kMostProbes);
    probes_ = done_;
    done_ = first;
    const std::uint64_t exposed = left(Which::exposed).size();
    if (exposed * kDeepProbes <= options_.max_probes)
      probe_rounds(Which::exposed, options_.max_probes / 3, kDeepProbes, kMostDeepProbes);
    else
      keep_exposed_ = true;
  }

  enum class Which { all, enclosed, exposed };

  std::vector<std::uint32_t> left(Which which) const {
    std::vector<std::uint32_t> out;
    for (std::uint32_t i = 0; i < world_.triangles.size(); ++i)
      if (undecided(i) && (which == Which::all || (which == Which::exposed) == (exposed_[i] != 0)))
        out.push_back(i);
    return out;
  }

  // In all, at least as many as `total`, within the bounds for each triangle.
  void probe_rounds(Which which, std::uint64_t total, std::uint32_t least, std::uint32_t most) {
    std::uint32_t each = std::max(4u, done_);
    while (true) {
      const std::vector<std::uint32_t> triangles = left(which);
      if (triangles.empty()) return;
      const auto wanted = static_cast<std::uint32_t>(
          std::clamp<std::uint64_t>(total / triangles.size(), least, std::max(least, most)));
      if (done_ >= wanted) return;
      const std::uint32_t number = std::min(each, wanted - done_);
      explore(probe(triangles, number, which != Which::exposed), false);
      done_ += number;
      each *= 2;
    }
  }

  // classify: says of triangles whether they face a side that is seen
  std::vector<Find> probe(const std::vector<std::uint32_t>& triangles, std::uint32_t number,
                          bool classify) {
    const auto make = [&](std::uint64_t i) -> std::optional<Line> {
      const std::uint32_t triangle = triangles[static_cast<std::size_t>(i / number)];
      const auto sample = static_cast<std::uint32_t>(done_ + i % number);
      const auto random = philox({triangle, sample, 0, 0}, {0x51947, 1});
      const Vec3 point = point_of(triangle, sample, random);
      const Vec3 outwards = on_sphere(in_unit(random[2]), in_unit(random[3]));
      // most are hidden by what is near
      const geometry::Ray ray{point, outwards, kSlack * radius_};
      if (classify) {
        const auto hit = caster_.closest(ray);
        if (hit && was_hit_before(*hit)) exposed_[triangle] = 1;
        if (hit && !has_transparent_) return std::nullopt;
      } else if (!has_transparent_ && caster_.any(ray)) {
        return std::nullopt;
      }
      return through(point, -outwards);
    };
    return cast(triangles.size() * std::uint64_t{number}, make);
  }

  Vec3 turned(const Vec3& d, double angle, std::uint32_t a, std::uint32_t b) const {
    const auto [right, up] = across(d);
    const double r = angle * std::sqrt(in_unit(a));
    const auto turn = det::sincos(2 * kPi * in_unit(b));
    return glm::normalize(d + r * turn.cos * right + r * turn.sin * up);
  }

  // What was found where little is seen tells where more may be: lines close by, and lines through
  // the neighbours.
  void explore(std::vector<Find> found, bool everywhere) {
    for (int i = 0; i < kExplorations && (!found.empty() || everywhere); ++i) {
      std::vector<Find> next = beside(found);
      const std::vector<Find> more = through_neighbours(found, everywhere);
      next.insert(next.end(), more.begin(), more.end());
      found = std::move(next);
      everywhere = false;
    }
  }

  // Lines a little aside of those that found something, and turned about places on their way: the
  // gap that let them through is one of these.
  std::vector<Find> beside(const std::vector<Find>& found) {
    constexpr std::uint64_t kLines = 24;
    constexpr std::uint64_t kTurned = 72;
    return cast(found.size() * (kLines + kTurned), [&](std::uint64_t i) -> std::optional<Line> {
      const std::uint32_t triangle =
          found[static_cast<std::size_t>(i / (kLines + kTurned))].triangle;
      const auto k = static_cast<std::uint32_t>(i % (kLines + kTurned));
      const auto random = philox({triangle, k, 1, 0}, {0x51947, 2});
      const auto more = philox({triangle, k, 2, 0}, {0x51947, 2});
      // from 1e-4 to 0.1, of a turn or of the radius
      const double width = 1e-4 * det::exp(6.907755278982137 * in_unit(more[2]));
      const Vec3& along = line_[triangle].direction;
      const Vec3 d = turned(along, width, random[0], random[1]);
      if (k >= kLines) {
        const double middle = glm::dot(centre_ - line_[triangle].origin, along);
        const double place = middle + radius_ * (2 * in_unit(random[2]) - 1);
        return through(line_[triangle].origin + place * along, d);
      }
      const auto [right, up] = across(d);
      const double reach = k % 2 == 0 ? 0 : width * radius_;
      const Vec3 point = point_of(triangle, 2, more) +
                         reach * (2 * in_unit(random[2]) - 1) * right +
                         reach * (2 * in_unit(random[3]) - 1) * up;
      return through(point, d);
    });
  }

  // Lines through undecided triangles next to such that are seen, from where those are.
  std::vector<Find> through_neighbours(const std::vector<Find>& found, bool everywhere) {
    constexpr std::uint64_t kLines = 8;
    constexpr std::size_t kMostPairs = 3;                        // for each triangle
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;  // undecided, seen
    if (everywhere) {
      for (std::uint32_t i = 0; i < world_.triangles.size(); ++i) {
        if (!undecided(i)) continue;
        std::size_t taken = 0;
        for_neighbours(i, [&](std::uint32_t other) {
          if (seen(other) && taken < kMostPairs) pairs.push_back({i, other}), ++taken;
        });
      }
    } else {
      for (const Find& find : found)
        for_neighbours(find.triangle, [&](std::uint32_t other) {
          if (undecided(other)) pairs.push_back({other, find.triangle});
        });
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return cast(pairs.size() * kLines, [&](std::uint64_t i) -> std::optional<Line> {
      const auto [triangle, seen] = pairs[static_cast<std::size_t>(i / kLines)];
      const auto k = static_cast<std::uint32_t>(i % kLines);
      const auto random = philox({triangle, seen, k, 0}, {0x51947, 3});
      const auto more = philox({triangle, seen, k, 1}, {0x51947, 3});
      const double angle = k < 3 ? 0.01 : k < 6 ? 0.1 : 0.5;
      return through(point_of(triangle, k, random),
                     turned(line_[seen].direction, angle, more[0], more[1]));
    });
  }

  std::vector<Find> through_frontier(const std::vector<Neighbours>& frontier) {
    const std::uint64_t lines =
        std::clamp<std::uint64_t>(kFrontierLines / frontier.size(), 16, kMostFrontierLines);
    return cast(frontier.size() * lines, [&](std::uint64_t i) -> std::optional<Line> {
      const Neighbours& one = frontier[static_cast<std::size_t>(i / lines)];
      const auto k = static_cast<std::uint32_t>(i % lines);
      const auto random = philox({one.triangle, k, 3, 0}, {0x51947, 4});
      const auto more = philox({one.triangle, k, 4, 0}, {0x51947, 4});
      const double spread = in_unit(more[2]);
      return through(point_of(one.triangle, k, random),
                     turned(line_[one.seen[k % one.count]].direction, 0.5 * spread * spread,
                            more[0], more[1]));
    });
  }

  World world_;
  VisibilityOptions options_;
  const Job& job_;
  geometry::InstanceCaster caster_;
  Vec3 centre_{0};
  double radius_ = 0;
  bool has_transparent_ = false;
  bool keep_exposed_ = false;
  std::vector<std::atomic<std::uint16_t>> hit_;  // 2*T: see met()
  std::vector<std::atomic<char>> exposed_;       // T: faces a side that is seen
  std::vector<char> kept_;                       // T: in doubt
  std::vector<Line> line_;                       // T: that met it
  std::vector<std::uint32_t> place_;             // V
  std::vector<std::uint32_t> start_;             // of the lists in around_, by place
  std::vector<std::uint32_t> around_;
  std::uint16_t round_ = 0;
  std::uint64_t outside_ = 0;  // lines from outside so far
  std::uint64_t rays_ = 0;
  std::uint64_t last_rays_ = 0;
  std::uint64_t last_found_ = 0;
  std::uint64_t probes_ = 0;  // through each triangle that was not seen
  std::uint32_t done_ = 0;    // the same, or through each exposed one
};

// Of each triangle, the first one that has the same corners.
std::vector<std::uint32_t> firsts_of(const World& world) {
  const std::vector<std::uint32_t> place = places_of(world.positions).first;
  struct Entry {
    std::array<std::uint32_t, 3> places;  // in ascending order
    char clear;
    std::uint32_t triangle;
    auto operator<=>(const Entry&) const = default;
  };
  std::vector<Entry> entries(world.triangles.size());
  for (std::uint32_t i = 0; i < entries.size(); ++i) {
    const geometry::Triangle& t = world.triangles[i];
    entries[i] = {{place[t[0]], place[t[1]], place[t[2]]}, world.transparent[i], i};
    std::sort(entries[i].places.begin(), entries[i].places.end());
  }
  std::sort(entries.begin(), entries.end());
  std::vector<std::uint32_t> firsts(entries.size());
  for (std::size_t i = 0, first = 0; i < entries.size(); ++i) {
    if (entries[i].places != entries[first].places || entries[i].clear != entries[first].clear)
      first = i;
    firsts[entries[i].triangle] = entries[first].triangle;
  }
  return firsts;
}

}  // namespace

Visibility visibility_of(World world, const VisibilityOptions& options, const Job& job) {
  // what lies in one place is looked for once: all of it is seen, or none
  const std::vector<std::uint32_t> firsts = firsts_of(world);
  const std::vector<char> wanted = world.candidate;
  std::vector<std::uint32_t> moved(firsts.size());
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < firsts.size(); ++i) {
    if (firsts[i] == i) {
      moved[i] = count++;
      world.triangles[moved[i]] = world.triangles[i];
      world.transparent[moved[i]] = world.transparent[i];
      world.candidate[moved[i]] = world.candidate[i];
    } else {
      moved[i] = moved[firsts[i]];
      world.candidate[moved[i]] |= world.candidate[i];
    }
  }
  world.triangles.resize(count);
  world.transparent.resize(count);
  world.candidate.resize(count);
  const Visibility once = VisibilityRays(std::move(world), options, job).run();
  Visibility out = once;
  out.seen.resize(firsts.size());
  out.kept.resize(firsts.size());
  for (std::size_t i = 0; i < firsts.size(); ++i) {
    out.seen[i] = once.seen[moved[i]];
    out.kept[i] = wanted[i] && once.kept[moved[i]];
    out.ambiguous += out.kept[i];
  }
  return out;
}

}  // namespace panwright::compiler::internal
