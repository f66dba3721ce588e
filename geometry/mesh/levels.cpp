#include "geometry/mesh/levels.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/parallel.h"
#include "geometry/internal/weld.h"
#include "geometry/mesh/check.h"
#include "geometry/mesh/internal/surface_search.h"
#include "geometry/mesh/simplify.h"

namespace panwright::geometry {
namespace {

constexpr double kFinest = 3e-5;  // of the diagonal: the first tolerance
constexpr std::size_t kLeastPart = 8;
constexpr double kWorthMeasuring = 0.8;  // of the triangles of the step before
constexpr std::uint32_t kNone = 0xffffffffu;

// A connected part, and what was made of it.
struct Part {
  struct Step {
    Mesh mesh;
    double high = 0;
  };
  std::vector<std::uint32_t> triangles;  // of the mesh
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

std::vector<Part> parts_of(const Mesh& mesh, std::span<const char> shared) {
  std::vector<std::uint32_t> root = welded(mesh.positions);
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
  if (!shared.empty())
    for (Part& part : parts)
      part.locked = std::ranges::any_of(part.triangles, [&](std::uint32_t i) {
        return std::ranges::any_of(mesh.triangles[i], [&](std::uint32_t v) { return shared[v]; });
      });
  return parts;
}

struct Range {
  double least = 0, most = 0;  // metres
};

void simplify(Part& part, const Mesh& full, const Range& range, const LevelOptions& options,
              const Job& job) {
  Simplifier simplifier(full, part.locked);
  const double size = simplifier.size();
  if (!(size > 0)) return;
  const MeasuredMesh measured(full);
  const DistanceOptions narrow{
      .relative = 0.5, .absolute = range.least / 2, .searches = 256, .give_up = range.most};
  std::size_t before = part.triangles.size();
  for (double error = std::max(range.least / 4, 1e-6 * size);
       error <= 2 * range.most && error <= size; error *= 2) {
    job.poll();
    simplifier.step(0, error);
    const std::size_t left = simplifier.triangles();
    if (left == 0) return;
    if (static_cast<double>(left) > kWorthMeasuring * static_cast<double>(before)) continue;
    before = left;
    Mesh mesh = simplifier.mesh();
    if (projected_area_error(full, mesh, job) > options.most_part_area_error) return;
    const DistanceInterval found = hausdorff_distance(measured, MeasuredMesh(mesh), narrow, job);
    if (found.low > range.most) return;
    if (found.high > range.most) continue;
    part.steps.push_back({std::move(mesh), found.high});
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
      const std::size_t count = triangles_within(tolerance);
      if (count < options_.least_triangles) break;
      if (static_cast<double>(count) > options_.share * before) continue;
      before = static_cast<double>(count);
      MeshLevel level = level_within(tolerance);
      if (level.normals.rms > options_.most_normal_error ||
          level.area_error > options_.most_area_error)
        break;
      levels.push_back(std::move(level));
    }
    return levels;
  }

 private:
  void make_parts() {
    parts_ = parts_of(mesh_, options_.shared);
    std::vector<std::uint32_t> index(mesh_.positions.size(), kNone);
    std::vector<std::pair<Part*, Mesh>> work;
    for (Part& part : parts_)
      if (part.triangles.size() >= kLeastPart)
        work.emplace_back(&part, extract(mesh_, part.triangles, index));
    parallel_for(
        work.size(),
        [&](std::size_t i) { simplify(*work[i].first, work[i].second, range_, options_, job_); },
        job_);
  }

  // null: none of the steps
  static const Part::Step* step_within(const Part& part, double tolerance) {
    const Part::Step* best = nullptr;
    for (const Part::Step& step : part.steps)
      if (step.high <= tolerance) best = &step;
    return best;
  }

  std::size_t triangles_within(double tolerance) const {
    std::size_t count = 0;
    for (const Part& part : parts_) {
      const Part::Step* step = step_within(part, tolerance);
      count += step ? step->mesh.triangles.size() : part.triangles.size();
    }
    return count;
  }

  MeshLevel level_within(double tolerance) const {
    MeshLevel level;
    double high = 0;
    std::vector<std::uint32_t> index(mesh_.positions.size(), kNone);
    std::vector<std::uint32_t> whole;
    for (const Part& part : parts_) {
      const Part::Step* step = step_within(part, tolerance);
      if (!step) {
        whole.insert(whole.end(), part.triangles.begin(), part.triangles.end());
        continue;
      }
      append(level.mesh, step->mesh);
      high = std::max(high, step->high);
    }
    append(level.mesh, extract(mesh_, whole, index));
    if (mesh_.closed) set_closed(level.mesh);
    const MeasuredMesh measured(level.mesh);
    level.distance = hausdorff_distance(
        full_, measured, {.relative = 0.5, .absolute = range_.least / 2, .searches = 16}, job_);
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
};

}  // namespace

std::vector<MeshLevel> mesh_levels(const Mesh& mesh, const LevelOptions& options, const Job& job) {
  if (mesh.triangles.empty()) return {};
  return Maker(mesh, options, job).run();
}

}  // namespace panwright::geometry
