#include "geometry/mesh/levels.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/parallel.h"
#include "geometry/internal/limits.h"
#include "geometry/internal/weld.h"
#include "geometry/mesh/check.h"
#include "geometry/mesh/diffuse_flux.h"
#include "geometry/mesh/internal/surface_search.h"
#include "geometry/mesh/simplify.h"

namespace panwright::geometry {
namespace {

constexpr double kFinest = 3e-5;  // of the diagonal: the first tolerance
constexpr std::size_t kLeastPart = 8;

// A connected part, and what was made of it.
struct Part {
  struct Step {
    Mesh mesh;
    double high = 0;
    double cost = 0;  // of what the whole may be off in area and normals; 1: all of it
  };
  std::vector<std::uint32_t> triangles;  // of the mesh
  double area = 0;                       // m²
  bool locked = false;
  std::vector<Step> steps;  // from the finest
};

void append(Mesh& out, const Mesh& more) {
  const auto base = static_cast<std::uint32_t>(out.positions.size());
  const auto add = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  add(out.positions, more.positions);
  add(out.normals, more.normals);
  add(out.texcoords, more.texcoords);
  add(out.colors, more.colors);
  for (const Triangle& t : more.triangles)
    out.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

// The triangles of a part, with the vertices that they use.
//
//   index  V, all kNone; so again afterwards
Mesh extract(const Mesh& mesh, std::span<const std::uint32_t> triangles,
             std::vector<std::uint32_t>& index) {
  Mesh out;
  for (const std::uint32_t i : triangles) {
    Triangle t = mesh.triangles[i];
    for (std::uint32_t& corner : t) {
      if (index[corner] == kNone) {
        index[corner] = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(mesh.positions[corner]);
        if (!mesh.normals.empty()) out.normals.push_back(mesh.normals[corner]);
        if (!mesh.texcoords.empty()) out.texcoords.push_back(mesh.texcoords[corner]);
        if (!mesh.colors.empty()) out.colors.push_back(mesh.colors[corner]);
      }
      corner = index[corner];
    }
    out.triangles.push_back(t);
  }
  for (const std::uint32_t i : triangles)
    for (const std::uint32_t corner : mesh.triangles[i]) index[corner] = kNone;
  out.closed = mesh.closed;
  return out;
}

// For each vertex the first one at its place that has its texture coordinates and colour.
std::vector<std::uint32_t> corner_points(const Mesh& mesh,
                                         const std::vector<std::uint32_t>& place) {
  if (mesh.texcoords.empty() && mesh.colors.empty()) return place;
  std::vector<std::uint32_t> order(place.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t v) {
    const Vec2 uv = mesh.texcoords.empty() ? Vec2(0) : mesh.texcoords[v];
    const Vec3 color = mesh.colors.empty() ? Vec3(0) : mesh.colors[v];
    return std::make_tuple(place[v], uv.x, uv.y, color.x, color.y, color.z);
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto x = key(a), y = key(b);
    return x != y ? x < y : a < b;
  });
  std::vector<std::uint32_t> first(place.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  return first;
}

std::vector<Part> parts_of(const Mesh& mesh, std::span<const char> shared) {
  const std::vector<std::uint32_t> place = welded(mesh.positions);
  std::vector<std::uint32_t> root = corner_points(mesh, place);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t corner : {t[1], t[2]}) {
      const std::uint32_t a = find(t[0]);
      const std::uint32_t b = find(corner);
      root[std::max(a, b)] = std::min(a, b);
    }
  std::vector<std::uint32_t> part_of(mesh.positions.size(), kNone);
  std::vector<Part> parts;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t at = find(mesh.triangles[i][0]);
    if (part_of[at] == kNone) {
      part_of[at] = static_cast<std::uint32_t>(parts.size());
      parts.emplace_back();
    }
    parts[part_of[at]].triangles.push_back(i);
  }
  // where parts meet: a vertex's place is of this part, or of several
  constexpr std::uint32_t kSeveral = kNone - 1;
  std::vector<std::uint32_t> of_place(mesh.positions.size(), kNone);
  for (std::uint32_t k = 0; k < parts.size(); ++k)
    for (const std::uint32_t i : parts[k].triangles)
      for (const std::uint32_t v : mesh.triangles[i]) {
        std::uint32_t& part = of_place[place[v]];
        part = part == kNone || part == k ? k : kSeveral;
      }
  for (Part& part : parts)
    part.locked = std::ranges::any_of(part.triangles, [&](std::uint32_t i) {
      return std::ranges::any_of(mesh.triangles[i], [&](std::uint32_t v) {
        return of_place[place[v]] == kSeveral || (!shared.empty() && shared[v]);
      });
    });
  return parts;
}

struct Range {
  double least = 0, most = 0;  // metres
};

double area_of(const Mesh& mesh, std::span<const std::uint32_t> triangles) {
  double sum = 0;
  for (const std::uint32_t i : triangles) {
    const Triangle& t = mesh.triangles[i];
    const Vec3& corner = mesh.positions[t[0]];
    sum += glm::length(glm::cross(mesh.positions[t[1]] - corner, mesh.positions[t[2]] - corner));
  }
  return sum / 2;
}

void simplify(Part& part, const Mesh& full, double whole_area, const Range& range,
              const LevelOptions& options, const Job& job) {
  Simplifier simplifier(full, part.locked);
  const double size = simplifier.size();
  if (!(size > 0)) return;
  const MeasuredMesh measured(full);
  const DistanceOptions narrow{.relative = options.interval,
                               .absolute = range.least / 2,
                               .searches = 256,
                               .give_up = range.most};
  std::size_t before = part.triangles.size();
  for (double error = std::max(range.least / 4, 1e-6 * size);
       error <= 2 * range.most && error <= size; error *= options.growth) {
    job.poll();
    simplifier.step(0, error);
    const std::size_t left = simplifier.triangles();
    if (left == 0) return;
    if (static_cast<double>(left) > options.worth * static_cast<double>(before)) continue;
    before = left;
    Mesh mesh = simplifier.mesh();
    const double area_error = projected_area_error(full, mesh, job);
    if (area_error > options.most_part_area_error) return;
    const MeasuredMesh coarse(mesh);
    const DistanceInterval found = hausdorff_distance(measured, coarse, narrow, job);
    if (found.low > range.most) return;
    if (found.high > range.most) continue;
    const double turn = normal_error(measured, coarse, found.high, job).rms;
    if (turn > options.most_part_normal_error) return;
    const double cost = part.area / whole_area *
                        std::max(area_error / options.most_area_error,
                                 std::pow(turn / options.most_normal_error, 2));
    part.steps.push_back({std::move(mesh), found.high, cost});
  }
}

class Maker {
 public:
  Maker(const Mesh& mesh, const LevelOptions& options, const Job& job)
      : mesh_(mesh), options_(options), job_(job), full_(mesh) {}

  std::vector<MeshLevel> run() {
    const double diagonal = full_.search().diagonal();
    range_ = {std::max(options_.least_error, kFinest * diagonal), options_.most_error * diagonal};
    if (!(diagonal > 0) || !(range_.most >= range_.least)) return {};
    make_parts();
    std::vector<MeshLevel> levels;
    double before = static_cast<double>(mesh_.triangles.size());
    // note: std::ilogb and std::ldexp are exact
    for (int k = std::ilogb(range_.least / options_.unit);; ++k) {
      const double tolerance = std::ldexp(options_.unit, k);
      if (tolerance > range_.most) break;
      if (tolerance < range_.least) continue;
      const std::size_t count = choose(tolerance);
      if (count < options_.least_triangles) break;
      if (static_cast<double>(count) > options_.share * before) continue;
      MeshLevel level = chosen_level();
      if (level.normals.rms > options_.most_normal_error ||
          level.area_error > options_.most_area_error)
        break;
      if (options_.most_flux_error < HUGE_VAL) {
        level.flux_error = diffuse_flux_error(mesh_, level.mesh, job_);
        if (level.flux_error > options_.most_flux_error) continue;
      }
      before = static_cast<double>(count);
      // what is coarser and as near serves as well
      while (!levels.empty() && levels.back().distance.high >= level.distance.high)
        levels.pop_back();
      levels.push_back(std::move(level));
    }
    return levels;
  }

 private:
  void make_parts() {
    parts_ = parts_of(mesh_, options_.shared);
    std::vector<std::uint32_t> index(mesh_.positions.size(), kNone);
    std::vector<std::pair<Part*, Mesh>> work;
    double area = 0;
    for (Part& part : parts_) {
      part.area = area_of(mesh_, part.triangles);
      area += part.area;
    }
    for (Part& part : parts_)
      if (part.triangles.size() >= kLeastPart)
        work.emplace_back(&part, extract(mesh_, part.triangles, index));
    parallel_for(
        work.size(),
        [&](std::size_t i) {
          simplify(*work[i].first, work[i].second, area, range_, options_, job_);
        },
        job_);
  }

  // Triangles that a part has after some of its steps, and their cost.
  static std::size_t triangles_after(const Part& part, std::size_t steps) {
    return steps == 0 ? part.triangles.size() : part.steps[steps - 1].mesh.triangles.size();
  }
  static double cost_after(const Part& part, std::size_t steps) {
    return steps == 0 ? 0 : part.steps[steps - 1].cost;
  }

  // Takes steps within a tolerance, the cheapest for each triangle that goes first, while the whole
  // may be off so much. Returns the triangles that are left.
  std::size_t choose(double tolerance) {
    struct Next {
      double price = 0, cost = 0;
      std::size_t part = 0, steps = 0, saved = 0;
    };
    const auto is_later = [](const Next& a, const Next& b) {
      return a.price != b.price ? a.price > b.price : a.part > b.part;
    };
    std::vector<Next> waiting;
    const auto offer = [&](std::size_t i) {
      const Part& part = parts_[i];
      std::size_t steps = taken_[i];
      while (steps < part.steps.size() && !(part.steps[steps].high <= tolerance)) ++steps;
      if (steps++ == part.steps.size()) return;
      const std::size_t saved = triangles_after(part, taken_[i]) - triangles_after(part, steps);
      const double cost = cost_after(part, steps) - cost_after(part, taken_[i]);
      waiting.push_back({cost / static_cast<double>(saved), cost, i, steps, saved});
      std::push_heap(waiting.begin(), waiting.end(), is_later);
    };
    taken_.assign(parts_.size(), 0);
    std::size_t count = mesh_.triangles.size();
    double spent = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) offer(i);
    while (!waiting.empty()) {
      std::pop_heap(waiting.begin(), waiting.end(), is_later);
      const Next next = waiting.back();
      waiting.pop_back();
      if (spent + next.cost > 1) continue;
      spent += next.cost;
      count -= next.saved;
      taken_[next.part] = next.steps;
      offer(next.part);
    }
    return count;
  }

  MeshLevel chosen_level() const {
    MeshLevel level;
    double high = 0;
    std::vector<std::uint32_t> index(mesh_.positions.size(), kNone);
    std::vector<std::uint32_t> whole;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const Part& part = parts_[i];
      if (taken_[i] == 0) {
        whole.insert(whole.end(), part.triangles.begin(), part.triangles.end());
        continue;
      }
      const Part::Step& step = part.steps[taken_[i] - 1];
      append(level.mesh, step.mesh);
      high = std::max(high, step.high);
    }
    append(level.mesh, extract(mesh_, whole, index));
    if (mesh_.closed) set_closed(level.mesh);
    const MeasuredMesh measured(level.mesh);
    level.distance = hausdorff_distance(
        full_, measured,
        {.relative = options_.interval, .absolute = range_.least / 2, .searches = 16}, job_);
    // each part is within its own bound, so the whole is within the largest
    level.distance.high = std::max(std::min(level.distance.high, high), level.distance.low);
    level.normals = normal_error(full_, measured, level.distance.high, job_);
    level.area_error = projected_area_error(mesh_, level.mesh, job_);
    level.mesh.error = level.distance.high;
    return level;
  }

  const Mesh& mesh_;
  const LevelOptions& options_;
  const Job& job_;
  const MeasuredMesh full_;
  Range range_;
  std::vector<Part> parts_;
  std::vector<std::size_t> taken_;  // steps of each part, for the level that is made
};

}  // namespace

std::vector<MeshLevel> mesh_levels(const Mesh& mesh, const LevelOptions& options, const Job& job) {
  if (mesh.triangles.empty()) return {};
  return Maker(mesh, options, job).run();
}

}  // namespace panwright::geometry
