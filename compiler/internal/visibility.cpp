#include "compiler/internal/visibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/random.h"
#include "compiler/internal/visibility_sampling.h"
#include "compiler/internal/visibility_state.h"

namespace panwright::compiler::internal {

namespace {

// sine of the angle between facets of one surface
constexpr double kSmooth = 0.2;
// sine of the angle below which a ray runs along a surface
constexpr double kGrazing = 0.02;
// rays of a triangle that need no others beside them: seams are too narrow to be met so soon
constexpr std::uint32_t kSure = 8;
constexpr std::uint32_t kNormals = 2;      // first rays of a triangle, along its normals
constexpr std::uint32_t kFirstBeside = 4;  // along what neighbours see
constexpr std::uint32_t kClassify = 16;    // rays that tell what a triangle faces
constexpr std::uint32_t kOnwards = 32;     // of which onwards from there so many are followed
// rays that meet what faces a visible side and stays for that: as if they met a visible one
constexpr char kNearExposed = 4;
constexpr std::uint32_t kLeastProbes = 32;
constexpr std::uint64_t kProbes = 1'000'000;  // of all triangles together, at least
constexpr std::uint32_t kMostProbes = 4096;   // of one
constexpr std::uint64_t kSweep = 250'000;     // rays from outside
constexpr std::uint32_t kSharedRounds = 16;
constexpr std::size_t kAlone = 4;  // parts of a mesh that is worth a search of its own
constexpr int kExplorations = 64;  // rounds
constexpr int kConfirmations = 3;
// what a triangle that faces a visible side takes
constexpr std::uint32_t kDeepPasses = 4;
constexpr std::uint32_t kDeepProbes = 256;  // in a pass
constexpr std::uint32_t kGuided = 64;       // in a pass
constexpr std::uint32_t kBeside = 32;       // along what neighbours see, in a pass
constexpr std::uint64_t kDeepRays = kDeepPasses * (kDeepProbes + kGuided + kBeside);
// rays of images as wide as the model, of which those through undecided triangles are cast: as many
// as 1,500 of 256² pixels hold
constexpr double kAreaRays = 1e8;
// of the radius squared: such an image covers 4 of it, and a face shows half its area
constexpr double kBallArea = 8;
constexpr std::uint32_t kMostAreaRays = 65536;  // of one triangle
constexpr std::size_t kMostPortals = 512;
constexpr std::uint32_t kOfGap = 16;            // rays towards one, of each triangle, at most
constexpr std::uint64_t kMostGuided = 250'000;  // where what faces a visible side stays anyway

// A ray that leads outside through a gap.
struct Portal {
  Vec3 point{0};
  Vec3 direction{0};
  Vec3 gap{0};
  bool narrow = false;
};

class VisibilitySearch : VisibilityState {
 public:
  using VisibilityState::VisibilityState;

  Visibility run() {
    if (rays_.prepare())
      search();
    else
      for (std::uint32_t w = 0; w < rays_.triangles(); ++w) keep(w);
    return result();
  }

 private:
  // Remembers rays that found what few find, and where on them the gap is that let them through:
  // beyond it most directions lead outside.
  void note_portals(const std::vector<Find>& finds) {
    constexpr std::size_t kAtOnce = 64;
    const std::size_t count = std::min({finds.size(), kAtOnce, kMostPortals - portals_.size()});
    if (count == 0) return;
    std::vector<Portal> made(count);
    round(count, [&](std::size_t i, Harvest& out) {
      made[i] = portal_of(finds[i * finds.size() / count], out);
    });
    for (const Portal& portal : made)
      if (portal.narrow) portals_.push_back(portal);
  }

  // The share of directions about a ray that lead outside from a place on it.
  double open_share(const Find& find, double along, Harvest& out) const {
    constexpr std::uint32_t kRays = 12;
    std::uint32_t open = 0;
    for (std::uint32_t k = 0; k < kRays; ++k) {
      const auto random = philox({find.triangle, k, 10, 0}, {0x51947, 7});
      ++out.rays;
      open += rays_.escapes(find.triangle, find.point + along * find.direction,
                            cosine(find.direction, random[0], random[1]));
    }
    return static_cast<double>(open) / kRays;
  }

  Portal portal_of(const Find& find, Harvest& out) const {
    constexpr int kSteps = 12;
    constexpr double kNarrow = 0.3;
    constexpr double kOutside = 0.75;
    Portal portal;
    portal.narrow = open_share(find, 0, out) < kNarrow;
    double low = 0;
    double high = 2 * rays_.radius();
    for (int step = 0; portal.narrow && step < kSteps; ++step) {
      const double middle = 0.5 * (low + high);
      (open_share(find, middle, out) >= kOutside ? high : low) = middle;
    }
    portal.point = find.point;
    portal.direction = find.direction;
    portal.gap = find.point + high * find.direction;
    return portal;
  }

  // ---- rays from triangles

  // The k-th ray of a triangle: along both normals, then by the cosine on both sides. Never quite
  // along the normals nor from the middle, where a symmetrical model has its seams.
  std::pair<Vec3, Vec3> ray_of(std::uint32_t w, std::uint32_t k, const std::array<Vec3, 3>& corners,
                               const Vec3& front) const {
    constexpr double kTilt = 0.02;
    const Vec3 normal = k % 2 == 0 ? front : -front;
    const auto random = philox({w, k, 0, 0}, {0x51947, 1});
    if (k < kNormals && front != Vec3(0))
      return {point_of(corners, 2, random),
              glm::normalize(normal + kTilt * on_sphere(in_unit(random[2]), in_unit(random[3])))};
    return {point_of(corners, k / 2, random), cosine(normal, random[2], random[3])};
  }

  // Rays k in [from, to) of triangles, each until one escapes. Those not known to face a visible
  // side are told, from ray `classify` on.
  std::vector<Find> probe(const std::vector<std::uint32_t>& items, std::uint32_t from,
                          std::uint32_t to, std::uint32_t classify) {
    return round(items.size(), [&](std::size_t i, Harvest& out) {
      const std::uint32_t w = items[i];
      const std::array<Vec3, 3> corners = rays_.corners(w);
      const Vec3 front = normal_of(corners);
      for (std::uint32_t k = from; k < to; ++k) {
        const auto [point, direction] = ray_of(w, k, corners, front);
        ++out.rays;
        if (k < classify || exposed_[w]) {
          if (!rays_.escapes(w, point, direction)) continue;
        } else if (const auto met = rays_.meets(w, point, direction)) {
          const std::size_t side = 2 * std::size_t{met->triangle} + met->side;
          if (side_seen_[side]) {
            exposed_[w] = 1;
            out.exposed.push_back(2 * std::size_t{w} + side_of(front, direction));
          } else if (keep_exposed_ && side_exposed_[side]) {
            if (++near_exposed_[w] >= kNearExposed) exposed_[w] = 1;
          } else if (k < kOnwards) {
            go_on(w, k, *met, out);
          }
          continue;
        }
        if (!take(w, point, direction, front, k >= kSure, out)) continue;
        break;
      }
    });
  }

  // Notes a ray that escaped, if others beside it do as well.
  //   check  else this is looked at only where it runs along the surface, as seams between parts
  //          that touch do
  bool take(std::uint32_t w, const Vec3& point, const Vec3& direction, const Vec3& front,
            bool check, Harvest& out) const {
    if (check || std::fabs(glm::dot(front, direction)) < kGrazing) {
      out.rays += 2;
      if (!rays_.is_open(w, point, direction)) return false;
    }
    out.finds.push_back({w, side_of(front, direction), point, direction});
    return true;
  }

  // Rays onwards from what a ray met: whether that is seen itself.
  void go_on(std::uint32_t w, std::uint32_t k, const Meeting& met, Harvest& out) {
    const Vec3 front = rays_.normal(met.triangle);
    constexpr std::uint32_t kRays = 1;
    for (std::uint32_t j = 0; j < kRays; ++j) {
      const auto random = philox({w, k, 1, j}, {0x51947, 2});
      const Vec3 direction = cosine(met.side == 0 ? front : -front, random[0], random[1]);
      ++out.rays;
      if (!rays_.escapes(met.triangle, met.point, direction) ||
          !take(met.triangle, met.point, direction, front, true, out))
        continue;
      exposed_[w] = 1;
      return;
    }
  }

  // ---- along what others see

  void list_neighbours() {
    if (listed_) return;
    listed_ = true;
    constexpr std::uint32_t kMost = 2'000'000;
    std::vector<char> wanted(parts_.size(), 1);
    if (rays_.triangles() > kMost) {
      wanted.assign(parts_.size(), 0);
      for (const std::uint32_t w : undecided(Which::all)) wanted[rays_.part_of(w)] = 1;
    }
    rays_.list_neighbours(wanted);
  }

  // Rays from undecided triangles along those that their neighbours escaped by.
  std::vector<Find> cast_beside(std::vector<std::uint32_t> items, std::uint32_t each,
                                std::uint32_t stream) {
    std::erase_if(items, [&](std::uint32_t w) {
      bool any = false;
      rays_.for_neighbours(w, [&](std::uint32_t other) { any = any || is_seen(other); });
      return !any;
    });
    fit(items, each + 2);
    return round(items.size(), [&](std::size_t i, Harvest& out) {
      const std::uint32_t w = items[i];
      std::array<std::uint32_t, 8> seen;
      std::uint32_t count = 0;
      rays_.for_neighbours(w, [&](std::uint32_t other) {
        if (is_seen(other) && count < seen.size()) seen[count++] = other;
      });
      const std::array<Vec3, 3> corners = rays_.corners(w);
      const Vec3 front = normal_of(corners);
      for (std::uint32_t k = 0; k < each; ++k) {
        const auto random = philox({w, k, 2, stream}, {0x51947, 3});
        const auto more = philox({w, k, 3, stream}, {0x51947, 3});
        const Vec3 point = point_of(corners, k, random);
        const double spread = in_unit(more[2]);
        const Vec3 direction = in_cone(directions_[index_of(seen[k % count])],
                                       k == 0 ? 0 : 0.5 * spread * spread, more[0], more[1]);
        ++out.rays;
        if (rays_.escapes(w, point, direction) &&
            take(w, point, direction, front, done_ >= kSure, out))
          return;
      }
    });
  }

  // What was found tells where more may be: among the neighbours, and theirs.
  void explore(std::vector<Find> found) {
    const std::uint32_t each = done_ < kSure ? kFirstBeside : 2 * kFirstBeside;
    for (int i = 0; i < kExplorations && !found.empty(); ++i) {
      list_neighbours();
      std::vector<std::uint32_t> items;
      for (const Find& find : found)
        rays_.for_neighbours(find.triangle, [&](std::uint32_t other) {
          if (is_undecided(other) && !(keep_exposed_ && exposed_[other])) items.push_back(other);
        });
      std::sort(items.begin(), items.end());
      items.erase(std::unique(items.begin(), items.end()), items.end());
      found = cast_beside(std::move(items), each, static_cast<std::uint32_t>(i));
      if (done_ >= kClassify) note_portals(found);
    }
  }

  // Rays from triangles to gaps that others were seen through, from number `first` on.
  std::vector<Find> cast_guided(const std::vector<std::uint32_t>& items, std::size_t first,
                                std::uint32_t each) {
    return round(items.size(), [&](std::size_t i, Harvest& out) {
      const std::uint32_t w = items[i];
      const std::array<Vec3, 3> corners = rays_.corners(w);
      const Vec3 front = normal_of(corners);
      for (std::uint32_t k = 0; k < each; ++k) {
        const auto stream = static_cast<std::uint32_t>(first);
        const auto random = philox({w, k, 4, stream}, {0x51947, 4});
        const auto more = philox({w, k, 5, stream}, {0x51947, 4});
        const auto aside = philox({w, k, 6, stream}, {0x51947, 4});
        const Vec3 point = point_of(corners, k, random);
        const Portal& portal = portals_[first + more[0] % (portals_.size() - first)];
        // at the gap, or anywhere, near places more often
        const double u = in_unit(more[1]);
        const Vec3 at =
            k % 4 == 3 ? portal.point + 2 * rays_.radius() * u * u * portal.direction : portal.gap;
        const double width = 1e-4 * det::exp(6.907755278982137 * in_unit(more[2]));
        const Vec3 line = at - point +
                          width * rays_.radius() * in_unit(more[3]) *
                              on_sphere(in_unit(aside[0]), in_unit(aside[1]));
        const double length = glm::length(line);
        if (!(length > 0)) continue;
        ++out.rays;
        if (rays_.escapes(w, point, line / length) &&
            take(w, point, line / length, front, true, out))
          return;
      }
    });
  }

  // Until there are no new ones.
  void search_gaps() {
    const std::uint64_t most = keep_exposed_ ? kMostGuided : max_rays_ / 4;
    for (int i = 0; i < kExplorations && gaps_used_ < portals_.size(); ++i) {
      const std::vector<std::uint32_t> items = undecided(Which::all);
      const auto fresh = static_cast<std::uint32_t>(portals_.size() - gaps_used_);
      const std::uint32_t each = std::min(kGuided, kOfGap * fresh);
      if (items.empty() || guided_ + items.size() * each > most) return;
      guided_ += items.size() * each;
      std::vector<Find> found = cast_guided(items, gaps_used_, each);
      gaps_used_ = portals_.size();
      note_portals(found);
      explore(std::move(found));
    }
  }

  // ---- rays from outside

  // Even in direction and position: multiples of powers of the root of x⁵ = x + 1 (Roberts, "The
  // unreasonable effectiveness of quasirandom sequences", 2018).
  std::vector<Find> sweep() {
    if (cast_ + kSweep > max_rays_) return {};
    const std::uint64_t base = swept_;
    swept_ += kSweep;
    return round(kSweep, [&](std::size_t i, Harvest& out) {
      const auto n = static_cast<double>(base + i) + 0.5;
      const Vec3 d = on_sphere(part(n * 0.8566748838545029), part(n * 0.733891856627126));
      const double r = rays_.radius() * std::sqrt(part(n * 0.6287067210378087));
      const auto turn = det::sincos(2 * kPi * part(n * 0.5385972572236101));
      const auto [right, up] = perpendiculars(d);
      ++out.rays;
      const auto met =
          rays_.first_from_outside(rays_.centre() + r * turn.cos * right + r * turn.sin * up, d);
      if (!met || side_seen_[2 * std::size_t{met->triangle} + met->side]) return;
      const Vec3 front = rays_.normal(met->triangle);
      // at an outline, a hit that rounding may have made proves nothing
      if (rays_.escapes(met->triangle, met->point, -d))
        take(met->triangle, met->point, -d, front, true, out);
    });
  }

  // ---- the search

  void search() {
    Phase phase(job_, "finding hidden parts", 7);
    share_evidence();
    hide_alone();
    limit_parts();
    phase.advance();
    probe_all(kNormals, kNormals);
    phase.advance();
    if (undecided(Which::all).empty()) return;
    explore_everywhere();
    for (const std::uint32_t to : {kSure, kClassify}) {
      probe_all(to, kNormals);
      drop_exposed();
    }
    phase.advance();
    if (undecided(Which::all).empty()) return;
    std::vector<Find> found = sweep();
    note_portals(found);
    explore(std::move(found));
    phase.advance();
    probe_enclosed();
    phase.advance();
    search_exposed();
    search_by_area();
    phase.advance();
    confirm();
    keep_smooth();
  }

  void probe_all(std::uint32_t to, std::uint32_t classify) {
    std::vector<std::uint32_t> items = undecided(Which::all);
    fit(items, 2 * (to - done_));
    probe(items, done_, to, classify);
    done_ = to;
  }

  void explore_everywhere() {
    list_neighbours();
    std::vector<Find> found = cast_beside(undecided(Which::all), kFirstBeside, 100);
    explore(std::move(found));
  }

  // A triangle of a mesh is looked for in one of its parts after the other, and a part by one of
  // its triangles after the other.
  void share_evidence() {
    for (std::uint32_t r = 0; r < kSharedRounds; ++r) {
      std::vector<std::uint32_t> items;
      for (std::size_t m = 0; m < parts_of_.size(); ++m) {
        const std::vector<std::uint32_t>& parts = parts_of_[m];
        const std::uint32_t count = mesh_first_[m + 1] - mesh_first_[m];
        if (parts.size() < 2 || count == 0) continue;
        // in parts that are seen rather than in those that others may hide
        std::vector<std::uint32_t> seen = parts;
        if (r % 2 == 1)
          std::erase_if(seen, [&](std::uint32_t p) { return parts_[p] != State::seen; });
        for (std::uint32_t t = 0; t < count && !seen.empty(); ++t) {
          if (triangles_[mesh_first_[m] + t] != State::unknown) continue;
          const std::uint32_t random = philox({t, r, 7, 0}, {0x51947, 5})[0];
          items.push_back(rays_.first_of(seen[random % seen.size()]) + t);
        }
        for (const std::uint32_t p : parts) {
          if (parts_[p] != State::unknown) continue;
          items.push_back(rays_.first_of(p) + philox({p, r, 8, 0}, {0x51947, 5})[0] % count);
        }
      }
      if (items.empty()) return;
      std::sort(items.begin(), items.end());
      items.erase(std::unique(items.begin(), items.end()), items.end());
      std::erase_if(items, [&](std::uint32_t w) { return !is_undecided(w); });
      if (cast_ + 4 * items.size() > max_rays_ / 2) return;
      probe(items, r == 0 ? 0 : 4 * r - 2, 4 * r + 2, kMostProbes);
    }
  }

  // What a mesh hides from itself is hidden wherever it stands.
  void hide_alone() {
    for (std::uint32_t m = 0; m < parts_of_.size(); ++m) {
      const std::vector<std::uint32_t>& parts = parts_of_[m];
      const auto begin = triangles_.begin() + mesh_first_[m];
      const auto end = triangles_.begin() + mesh_first_[m + 1];
      if (parts.size() < kAlone || std::find(begin, end, State::unknown) == end) continue;
      VisibilityModel alone;
      alone.meshes = {model_.meshes[m]};
      alone.divisible = {1};
      alone.parts.emplace_back();
      VisibilityOptions options = options_;
      options.max_rays = rays_left() / 4;
      options.least_slack = 0;
      bool transparent = false;
      for (const std::uint32_t p : parts) {
        transparent = transparent || model_.parts[p].transparent;
        options.least_slack = std::max(options.least_slack, slack_in(p));
      }
      if (transparent || !std::isfinite(options.least_slack)) continue;
      const Visibility found = visibility_of(alone, options, job_);
      cast_ += found.rays;
      for (std::size_t t = 0; t < found.shown[0].size(); ++t)
        if (!found.shown[0][t] && begin[static_cast<std::ptrdiff_t>(t)] == State::unknown)
          begin[static_cast<std::ptrdiff_t>(t)] = State::hidden_alone;
    }
  }

  // Where meshes have so many parts that those not seen yet are too many to be sure of, they stay.
  void limit_parts() {
    std::vector<std::uint32_t> items = undecided(Which::all);
    std::erase_if(items, [&](std::uint32_t w) {
      return parts_of_[model_.parts[rays_.part_of(w)].mesh].size() < 2;
    });
    if (items.size() * kLeastProbes <= max_rays_ / 2) return;
    for (const std::uint32_t w : items) keep(w);
    capped_ = true;
  }

  // What counts as one surface, in the frame of a part, at least.
  double slack_in(std::uint32_t p) const {
    const Mat3 inverse = glm::inverse(Mat3(model_.parts[p].world_from_mesh));
    double most = 0;
    for (int column = 0; column < 3; ++column) most += glm::dot(inverse[column], inverse[column]);
    return rays_.slack() * std::sqrt(most);
  }

  // What faces a visible side stays where that is too many to be sure of, and then what faces that.
  void drop_exposed() {
    const std::uint64_t left = rays_left();
    if (undecided(Which::exposed).size() * kDeepRays > left / 2) keep_exposed_ = true;
  }

  // Triangles that face hidden sides alone take more rays the fewer they are.
  void probe_enclosed() {
    while (true) {
      drop_exposed();
      const std::uint64_t left = rays_left();
      std::vector<std::uint32_t> items = undecided(Which::enclosed);
      if (items.empty()) return;
      const std::uint64_t wanted =
          keep_exposed_
              ? 2 * std::uint64_t{options_.rays_per_triangle}
              : std::clamp<std::uint64_t>(kProbes / items.size(), options_.rays_per_triangle,
                                          std::max(options_.rays_per_triangle, kMostProbes));
      const std::uint64_t most = std::max<std::uint64_t>(kLeastProbes, left / 2 / items.size());
      const auto needed = static_cast<std::uint32_t>(std::min(wanted, most));
      if (done_ >= needed) return;
      const std::uint32_t number = std::min(done_, needed - done_);
      fit(items, 2 * number);
      std::vector<Find> found = probe(items, done_, done_ + number, 0);
      done_ += number;
      note_portals(found);
      explore(std::move(found));
      search_gaps();
    }
  }

  // Triangles that face a visible side: gaps are there.
  void search_exposed() {
    std::uint32_t done = kClassify;
    for (std::uint32_t pass = 0; pass < kDeepPasses; ++pass) {
      std::vector<std::uint32_t> items = undecided(Which::exposed);
      if (items.empty()) return;
      fit(items, kDeepProbes);
      std::vector<Find> found = probe(items, done, done + kDeepProbes, 0);
      done += kDeepProbes;
      note_portals(found);
      explore(std::move(found));
      search_gaps();
      found = cast_beside(undecided(Which::exposed), kBeside, 200 + pass);
      note_portals(found);
      explore(std::move(found));
    }
  }

  // Rays through what is undecided as those of images are: evenly over area and direction. What is
  // large takes most of them, as it would take most pixels.
  void search_by_area() {
    const std::vector<std::uint32_t> items = undecided(Which::exposed);
    std::vector<std::uint32_t> numbers;
    double sum = 0;
    for (const std::uint32_t w : items) sum += rays_.area(w) / (rays_.radius() * rays_.radius());
    const double left = static_cast<double>(rays_left());
    const double each = std::min(kAreaRays / kBallArea, left / 2 / std::max(sum, 1e-300));
    std::vector<std::pair<std::uint32_t, std::uint32_t>> jobs;  // triangle, first ray
    constexpr std::uint32_t kTogether = 256;
    for (const std::uint32_t w : items) {
      const double number = each * rays_.area(w) / (rays_.radius() * rays_.radius());
      const auto count = static_cast<std::uint32_t>(std::min<double>(number, kMostAreaRays));
      for (std::uint32_t k = 0; k < count; k += kTogether) jobs.push_back({w, k});
    }
    std::vector<Find> found = round(jobs.size(), [&](std::size_t i, Harvest& out) {
      const auto [w, first] = jobs[i];
      const std::array<Vec3, 3> corners = rays_.corners(w);
      const Vec3 front = normal_of(corners);
      for (std::uint32_t k = first; k < first + kTogether; ++k) {
        const auto random = philox({w, k, 9, 0}, {0x51947, 6});
        const Vec3 point = point_of(corners, 2, random);
        const Vec3 direction = cosine(k % 2 == 0 ? front : -front, random[2], random[3]);
        ++out.rays;
        if (rays_.escapes(w, point, direction) && take(w, point, direction, front, true, out))
          return;
      }
    });
    note_portals(found);
    explore(std::move(found));
    if (!jobs.empty()) search_gaps();
  }

  void confirm() {
    for (int i = 0; i < kConfirmations; ++i) {
      if (undecided(Which::all).empty()) return;
      std::vector<Find> found = sweep();
      last_found_ = found.size();
      if (found.empty()) return;
      note_portals(found);
      explore(std::move(found));
      search_gaps();
    }
  }

  // ---- what stays in doubt

  // Triangles that continue a visible one about as smoothly as one surface stay: of a gap that
  // shows a sliver of one, few rays may meet the next.
  void keep_smooth() {
    std::vector<std::uint32_t> doubtful = undecided(Which::all);
    std::erase_if(doubtful, [&](std::uint32_t w) { return !continues_visible_surface(w); });
    for (const std::uint32_t w : doubtful) keep(w);
  }

  bool continues_visible_surface(std::uint32_t w) const {
    const Vec3 front = rays_.normal(w);
    bool found = false;
    rays_.for_neighbours(w, [&](std::uint32_t other) {
      // where parts touch, surfaces of both continue each other
      if (found || !is_seen(other) || (!exposed_[w] && rays_.part_of(w) != rays_.part_of(other)))
        return;
      found = rays_.common_corners(w, other) >= 2 &&
              glm::length(glm::cross(front, rays_.normal(other))) < kSmooth;
    });
    return found;
  }

  std::vector<Portal> portals_;  // rays that found what few find
  std::size_t gaps_used_ = 0;    // of them
  bool listed_ = false;          // neighbours
  std::uint64_t swept_ = 0;      // rays from outside
  std::uint64_t guided_ = 0;     // rays towards gaps
};

}  // namespace

Visibility visibility_of(const VisibilityModel& model, const VisibilityOptions& options,
                         const Job& job) {
  return VisibilitySearch(model, options, job).run();
}

}  // namespace panwright::compiler::internal
