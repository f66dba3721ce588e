#include "compiler/internal/visibility.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>

#include "base/random.h"
#include "compiler/internal/visibility_rays.h"

namespace panwright::compiler::internal {

namespace {

// sine of the angle between facets of one surface
constexpr double kSmooth = 0.2;
constexpr std::size_t kSteps = 8;  // parts of the rays from outside
constexpr std::uint32_t kFirstProbes = 32;
constexpr std::uint64_t kProbes = 1'000'000;  // for all triangles together, at least
constexpr std::uint32_t kMostProbes = 4096;   // for one
constexpr std::uint32_t kMostDeepProbes = 16384;
constexpr std::uint32_t kDeepProbes = 2048;  // for each that faces a visible side
// rays of images as wide as the model, of which those through undecided triangles are cast: as many
// as 7,600 of 256² pixels hold
constexpr double kAreaRays = 5e8;
// of the radius squared: such an image covers 4 of it, and a face shows half its area
constexpr double kBallArea = 8;
constexpr int kAreaRounds = 4;
constexpr int kFrontierRounds = 8;
constexpr std::uint64_t kFrontierRays = 400'000;   // of a round
constexpr std::uint64_t kMostFrontierRays = 2048;  // through one triangle
constexpr int kExplorations = 64;                  // rounds
constexpr int kConfirmations = 3;

Vec3 on_sphere(double a, double b) {
  const double z = 2 * a - 1;
  const double across = std::sqrt(std::max(0.0, 1 - z * z));
  const auto turn = det::sincos(2 * kPi * b);
  return {across * turn.cos, across * turn.sin, z};
}

double part(double x) { return x - std::floor(x); }

// A direction within a cone about d; a and b are random.
Vec3 in_cone(const Vec3& d, double angle, std::uint32_t a, std::uint32_t b) {
  const auto [right, up] = perpendiculars(d);
  const double r = angle * std::sqrt(in_unit(a));
  const auto turn = det::sincos(2 * kPi * in_unit(b));
  return glm::normalize(d + r * turn.cos * right + r * turn.sin * up);
}

// Decides where rays are cast: evenly from outside, then where something may still be found.
class VisibilitySearch {
 public:
  VisibilitySearch(WorldTriangles model, const VisibilityOptions& options, const Job& job)
      : rays_(std::move(model), job), options_(options), job_(job) {}

  Visibility run() {
    const std::uint32_t count = rays_.triangles();
    exposed_ = std::vector<std::atomic<char>>(count);
    kept_.resize(count);
    if (rays_.prepare()) {
      search();
      keep_ambiguous();
    }
    Visibility out;
    out.visible.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) out.visible[i] = rays_.is_visible(i) || kept_[i];
    out.rays = rays_.rays();
    out.last_rays = last_rays_;
    out.last_found = last_found_;
    out.probes = probes_;
    out.kept.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) out.kept[i] = rays_.is_undecided(i) && kept_[i];
    return out;
  }

 private:
  void search() {
    Phase phase(job_, "finding hidden parts", kSteps + 5);
    std::vector<FirstHit> late;
    for (std::size_t step = 0; step < kSteps; ++step) {
      const std::vector<FirstHit> found = cast_from_outside(options_.rays_from_outside / kSteps);
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
      const std::vector<FirstHit> found = cast_from_outside(last_rays_);
      last_found_ = found.size();
      if (found.empty()) break;
      explore(found, false);
    }
  }

  // Even in direction and position: multiples of powers of the root of x⁵ = x + 1 (Roberts, "The
  // unreasonable effectiveness of quasirandom sequences", 2018).
  std::vector<FirstHit> cast_from_outside(std::uint64_t count) {
    const std::uint64_t base = outside_;
    outside_ += count;
    return rays_.cast(
        count,
        [&](std::uint64_t i) -> std::optional<OutsideRay> {
          const auto n = static_cast<double>(base + i) + 0.5;
          const Vec3 d = on_sphere(part(n * 0.8566748838545029), part(n * 0.733891856627126));
          const double r = rays_.radius() * std::sqrt(part(n * 0.6287067210378087));
          const auto turn = det::sincos(2 * kPi * part(n * 0.5385972572236101));
          const auto [right, up] = perpendiculars(d);
          return rays_.ray_through(rays_.centre() + r * turn.cos * right + r * turn.sin * up, d);
        },
        false);
  }

  // ---- what was hit and what is near it

  // What was found where little is visible tells where more may be: rays close by, and rays through
  // the neighbours.
  void explore(std::vector<FirstHit> found, bool everywhere) {
    for (int i = 0; i < kExplorations && (!found.empty() || everywhere); ++i) {
      std::vector<FirstHit> next = cast_close_to(found);
      const std::vector<FirstHit> more = cast_through_neighbours(found, everywhere);
      next.insert(next.end(), more.begin(), more.end());
      found = std::move(next);
      everywhere = false;
    }
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
    const auto c = rays_.corners(triangle);
    const std::uint32_t k = number / 4 % 3;
    return c[k] + u * (c[(k + 1) % 3] - c[k]) + v * (c[(k + 2) % 3] - c[k]);
  }

  // Rays a little aside of those that found something, and turned about points along them: the gap
  // that let them through is at one of these.
  std::vector<FirstHit> cast_close_to(const std::vector<FirstHit>& found) {
    constexpr std::uint64_t kAside = 24;
    constexpr std::uint64_t kTurned = 72;
    const auto make = [&](std::uint64_t i) -> std::optional<OutsideRay> {
      const std::uint32_t triangle =
          found[static_cast<std::size_t>(i / (kAside + kTurned))].triangle;
      const auto k = static_cast<std::uint32_t>(i % (kAside + kTurned));
      const auto random = philox({triangle, k, 1, 0}, {0x51947, 2});
      const auto more = philox({triangle, k, 2, 0}, {0x51947, 2});
      // from 1e-4 to 0.1, of a turn or of the radius
      const double width = 1e-4 * det::exp(6.907755278982137 * in_unit(more[2]));
      const OutsideRay& first = rays_.ray_to(triangle);
      const Vec3& along = first.direction;
      const Vec3 d = in_cone(along, width, random[0], random[1]);
      if (k >= kAside) {
        const double middle = glm::dot(rays_.centre() - first.origin, along);
        const double distance = middle + rays_.radius() * (2 * in_unit(random[2]) - 1);
        return rays_.ray_through(first.origin + distance * along, d);
      }
      const auto [right, up] = perpendiculars(d);
      const double reach = k % 2 == 0 ? 0 : width * rays_.radius();
      const Vec3 point = point_of(triangle, 2, more) +
                         reach * (2 * in_unit(random[2]) - 1) * right +
                         reach * (2 * in_unit(random[3]) - 1) * up;
      return rays_.ray_through(point, d);
    };
    return rays_.cast(found.size() * (kAside + kTurned), make);
  }

  // Rays through undecided triangles next to visible ones, from where those are visible.
  std::vector<FirstHit> cast_through_neighbours(const std::vector<FirstHit>& found,
                                                bool everywhere) {
    constexpr std::uint64_t kRays = 8;
    constexpr std::size_t kMostPairs = 3;                        // for each triangle
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;  // undecided, visible
    if (everywhere) {
      for (std::uint32_t i = 0; i < rays_.triangles(); ++i) {
        if (!rays_.is_undecided(i)) continue;
        std::size_t taken = 0;
        rays_.for_neighbours(i, [&](std::uint32_t other) {
          if (rays_.is_visible(other) && taken < kMostPairs) pairs.push_back({i, other}), ++taken;
        });
      }
    } else {
      for (const FirstHit& one : found)
        rays_.for_neighbours(one.triangle, [&](std::uint32_t other) {
          if (rays_.is_undecided(other)) pairs.push_back({other, one.triangle});
        });
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    const auto make = [&](std::uint64_t i) -> std::optional<OutsideRay> {
      const auto [triangle, visible] = pairs[static_cast<std::size_t>(i / kRays)];
      const auto k = static_cast<std::uint32_t>(i % kRays);
      const auto random = philox({triangle, visible, k, 0}, {0x51947, 3});
      const auto more = philox({triangle, visible, k, 1}, {0x51947, 3});
      const double angle = k < 3 ? 0.01 : k < 6 ? 0.1 : 0.5;
      return rays_.ray_through(point_of(triangle, k, random),
                               in_cone(rays_.ray_to(visible).direction, angle, more[0], more[1]));
    };
    return rays_.cast(pairs.size() * kRays, make);
  }

  // ---- probes of undecided triangles

  enum class Which { all, enclosed, exposed };

  std::vector<std::uint32_t> undecided(Which which) const {
    std::vector<std::uint32_t> out;
    for (std::uint32_t i = 0; i < rays_.triangles(); ++i)
      if (rays_.is_undecided(i) &&
          (which == Which::all || (which == Which::exposed) == (exposed_[i] != 0)))
        out.push_back(i);
    return out;
  }

  // Rays through what was not hit, in rounds; what they find is explored. First a few through all,
  // which tell what faces a visible surface: that is where gaps are, and many more go there. Where
  // such triangles are too many to be sure of, they stay.
  void probe_all() {
    const std::uint32_t first = std::min(kFirstProbes, options_.rays_per_triangle);
    probe_rounds(Which::all, 0, first, first);
    probe_rounds(Which::enclosed, kProbes, options_.rays_per_triangle, kMostProbes);
    probes_ = done_;
    done_ = first;
    const std::uint64_t exposed = undecided(Which::exposed).size();
    if (exposed * kDeepProbes <= options_.max_probes)
      probe_rounds(Which::exposed, options_.max_probes / 3, kDeepProbes, kMostDeepProbes);
    else
      keep_exposed_ = true;
  }

  // In all, at least as many as `total`, within the bounds for each triangle.
  void probe_rounds(Which which, std::uint64_t total, std::uint32_t least, std::uint32_t most) {
    std::uint32_t each = std::max(4u, done_);
    while (true) {
      const std::vector<std::uint32_t> triangles = undecided(which);
      if (triangles.empty()) return;
      const auto needed = static_cast<std::uint32_t>(
          std::clamp<std::uint64_t>(total / triangles.size(), least, std::max(least, most)));
      if (done_ >= needed) return;
      const std::uint32_t number = std::min(each, needed - done_);
      explore(probe(triangles, number, which != Which::exposed), false);
      done_ += number;
      each *= 2;
    }
  }

  // classify: notes which triangles face a visible side
  std::vector<FirstHit> probe(const std::vector<std::uint32_t>& triangles, std::uint32_t number,
                              bool classify) {
    const auto make = [&](std::uint64_t i) -> std::optional<OutsideRay> {
      const std::uint32_t triangle = triangles[static_cast<std::size_t>(i / number)];
      const auto sample = static_cast<std::uint32_t>(done_ + i % number);
      const auto random = philox({triangle, sample, 0, 0}, {0x51947, 1});
      const Vec3 point = point_of(triangle, sample, random);
      const Vec3 outwards = on_sphere(in_unit(random[2]), in_unit(random[3]));
      // most are occluded by what is near
      const geometry::Ray ray{point, outwards, kDepthSlack * rays_.radius()};
      if (classify) {
        const auto hit = rays_.caster().closest(ray);
        if (hit && rays_.was_hit_before(*hit)) exposed_[triangle] = 1;
        if (hit && !rays_.has_transparent()) return std::nullopt;
      } else if (!rays_.has_transparent() && rays_.caster().any(ray)) {
        return std::nullopt;
      }
      return rays_.ray_through(point, -outwards);
    };
    return rays_.cast(triangles.size() * std::uint64_t{number}, make);
  }

  // ---- slivers and large areas

  // An undecided triangle and those next to it that are visible.
  struct Neighbours {
    std::uint32_t triangle;
    std::size_t count;
    std::array<std::uint32_t, 8> visible;
  };

  // Triangles next to visible ones: what shows of them may be a sliver, seen edge on.
  void search_frontier() {
    std::vector<char> searched(rays_.triangles(), 0);
    for (int i = 0; i < kFrontierRounds; ++i) {
      std::vector<Neighbours> frontier;
      for (std::uint32_t t = 0; t < searched.size(); ++t) {
        if (searched[t] || !rays_.is_undecided(t)) continue;
        Neighbours one{t, 0, {}};
        rays_.for_neighbours(t, [&](std::uint32_t other) {
          if (rays_.is_visible(other) && one.count < one.visible.size())
            one.visible[one.count++] = other;
        });
        if (one.count == 0) continue;
        searched[t] = 1;
        frontier.push_back(one);
      }
      if (frontier.empty()) return;
      explore(cast_through_frontier(frontier), false);
    }
  }

  std::vector<FirstHit> cast_through_frontier(const std::vector<Neighbours>& frontier) {
    const std::uint64_t each =
        std::clamp<std::uint64_t>(kFrontierRays / frontier.size(), 16, kMostFrontierRays);
    return rays_.cast(frontier.size() * each, [&](std::uint64_t i) -> std::optional<OutsideRay> {
      const Neighbours& one = frontier[static_cast<std::size_t>(i / each)];
      const auto k = static_cast<std::uint32_t>(i % each);
      const auto random = philox({one.triangle, k, 3, 0}, {0x51947, 4});
      const auto more = philox({one.triangle, k, 4, 0}, {0x51947, 4});
      const double spread = in_unit(more[2]);
      const OutsideRay& beside = rays_.ray_to(one.visible[k % one.count]);
      return rays_.ray_through(point_of(one.triangle, k, random),
                               in_cone(beside.direction, 0.5 * spread * spread, more[0], more[1]));
    });
  }

  // Rays through what is undecided as those of images are: evenly over area and direction. What is
  // large takes most of them, as it would take most pixels.
  void search_by_area() {
    const std::uint64_t most = options_.max_probes / kAreaRounds;
    for (int round = 0; round < kAreaRounds; ++round) {
      std::vector<std::uint32_t> triangles;
      std::vector<double> sums;  // of areas, in squares of the radius
      double sum = 0;
      for (std::uint32_t i = 0; i < rays_.triangles(); ++i) {
        if (!rays_.is_undecided(i) || !exposed_[i] || keep_exposed_) continue;
        triangles.push_back(i);
        sums.push_back(sum += rays_.area(i) / (rays_.radius() * rays_.radius()));
      }
      const auto count = static_cast<std::uint64_t>(
          std::min(static_cast<double>(most), kAreaRays / kAreaRounds * sum / kBallArea));
      if (count == 0) return;
      const auto make = [&](std::uint64_t i) -> std::optional<OutsideRay> {
        const auto index = static_cast<std::uint32_t>(i);
        const auto random = philox({index, static_cast<std::uint32_t>(round), 0, 0}, {0x51947, 5});
        const auto more = philox({index, static_cast<std::uint32_t>(round), 1, 0}, {0x51947, 5});
        const double at =
            sum * (static_cast<double>(i) + in_unit(random[0])) / static_cast<double>(count);
        const std::size_t k = std::min<std::size_t>(
            static_cast<std::size_t>(std::upper_bound(sums.begin(), sums.end(), at) - sums.begin()),
            sums.size() - 1);
        return ray_by_area(triangles[k], random, more);
      };
      explore(rays_.cast(count, make), false);
    }
  }

  // Through any point of a triangle, from a direction that is even over the area that it shows.
  std::optional<OutsideRay> ray_by_area(std::uint32_t triangle,
                                        const std::array<std::uint32_t, 4>& random,
                                        const std::array<std::uint32_t, 4>& more) const {
    double u = in_unit(random[1]);
    double v = in_unit(random[2]);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const auto [a, b, c] = rays_.corners(triangle);
    const Vec3 point = a + u * (b - a) + v * (c - a);
    const Vec3 front = rays_.normal(triangle);
    const Vec3 outwards = glm::normalize((random[3] & 1 ? front : -front) +
                                         on_sphere(in_unit(more[0]), in_unit(more[1])));
    if (!is_finite(outwards)) return std::nullopt;
    if (!rays_.has_transparent() &&
        rays_.caster().any({point, outwards, kDepthSlack * rays_.radius()}))
      return std::nullopt;
    return rays_.ray_through(point, -outwards);
  }

  // ---- what stays in doubt

  // Decides which triangles stay although nothing hit them: those that face a visible surface,
  // where they are too many to be sure of, and else those that continue a visible one about as
  // smoothly as one surface. Of a gap that shows a sliver of one, few rays may hit the next.
  void keep_ambiguous() {
    for (std::uint32_t i = 0; i < kept_.size(); ++i)
      if (rays_.is_undecided(i) && exposed_[i])
        kept_[i] = keep_exposed_ || continues_visible_surface(i);
  }

  bool continues_visible_surface(std::uint32_t triangle) const {
    const Vec3 front = rays_.normal(triangle);
    bool found = false;
    rays_.for_neighbours(triangle, [&](std::uint32_t other) {
      if (found || !rays_.is_visible(other)) return;
      found = rays_.common_corners(triangle, other) >= 2 &&
              glm::length(glm::cross(front, rays_.normal(other))) < kSmooth;
    });
    return found;
  }

  VisibilityRays rays_;
  VisibilityOptions options_;
  const Job& job_;
  bool keep_exposed_ = false;
  std::vector<std::atomic<char>> exposed_;  // T: faces a visible side
  std::vector<char> kept_;                  // T: ambiguous
  std::uint64_t outside_ = 0;               // rays from outside so far
  std::uint64_t last_rays_ = 0;
  std::uint64_t last_found_ = 0;
  std::uint64_t probes_ = 0;  // through each triangle that was not hit
  std::uint32_t done_ = 0;    // the same, or through each exposed one
};

// For each triangle, the first one with the same corners.
std::vector<std::uint32_t> unique_triangles(const WorldTriangles& model) {
  const std::vector<std::uint32_t> position = unique_positions(model.positions).first;
  struct Entry {
    std::array<std::uint32_t, 3> positions;  // in ascending order
    char transparent;
    std::uint32_t triangle;
    auto operator<=>(const Entry&) const = default;
  };
  std::vector<Entry> entries(model.triangles.size());
  for (std::uint32_t i = 0; i < entries.size(); ++i) {
    const geometry::Triangle& t = model.triangles[i];
    entries[i] = {{position[t[0]], position[t[1]], position[t[2]]}, model.transparent[i], i};
    std::sort(entries[i].positions.begin(), entries[i].positions.end());
  }
  std::sort(entries.begin(), entries.end());
  std::vector<std::uint32_t> firsts(entries.size());
  for (std::size_t i = 0, first = 0; i < entries.size(); ++i) {
    if (entries[i].positions != entries[first].positions ||
        entries[i].transparent != entries[first].transparent)
      first = i;
    firsts[entries[i].triangle] = entries[first].triangle;
  }
  return firsts;
}

}  // namespace

Visibility visibility_of(WorldTriangles model, const VisibilityOptions& options, const Job& job) {
  // of coincident triangles one is searched for: all of them are visible, or none
  const std::vector<std::uint32_t> firsts = unique_triangles(model);
  const std::vector<char> candidate = model.candidate;
  std::vector<std::uint32_t> moved(firsts.size());
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < firsts.size(); ++i) {
    if (firsts[i] == i) {
      moved[i] = count++;
      model.triangles[moved[i]] = model.triangles[i];
      model.transparent[moved[i]] = model.transparent[i];
      model.candidate[moved[i]] = model.candidate[i];
    } else {
      moved[i] = moved[firsts[i]];
      model.candidate[moved[i]] |= model.candidate[i];
    }
  }
  model.triangles.resize(count);
  model.transparent.resize(count);
  model.candidate.resize(count);
  const Visibility once = VisibilitySearch(std::move(model), options, job).run();
  Visibility out = once;
  out.visible.resize(firsts.size());
  out.kept.resize(firsts.size());
  for (std::size_t i = 0; i < firsts.size(); ++i) {
    out.visible[i] = once.visible[moved[i]];
    out.kept[i] = candidate[i] && once.kept[moved[i]];
    out.ambiguous += out.kept[i];
  }
  return out;
}

}  // namespace panwright::compiler::internal
