// Subdivision surfaces: making meshes of cages, against cages refined by the rules alone.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "bench/bench.h"
#include "geometry/mesh/distance.h"
#include "geometry/tessellate/tessellate.h"
#include "tests/support/cages.h"
#include "tests/support/catmull_clark.h"

namespace panwright::bench::case_subdiv {

namespace {

using geometry::Mesh;
using geometry::Subdiv;

Mesh made(const Subdiv& shape, double max_error) {
  geometry::TessellationOptions options;
  options.max_error = max_error;
  DiagnosticLog log;
  auto mesh = geometry::tessellated(shape, options, {}, log);
  if (!mesh) std::abort();
  return *std::move(mesh);
}

// The largest distance of a vertex from the nearest limit of the cage, refined to the same level.
double limit_error(Subdiv shape, std::uint32_t levels) {
  shape.levels = levels;
  const Mesh mesh = made(shape, 1);
  const std::vector<Vec3> limits =
      oracles::CatmullClark(shape).refined(static_cast<int>(levels)).pushed_used();
  double worst = 0;
  for (const Vec3& p : mesh.positions) {
    double nearest = HUGE_VAL;
    for (const Vec3& q : limits) nearest = std::min(nearest, glm::length(p - q));
    worst = std::max(worst, nearest);
  }
  return worst;
}

void run(Context& context) {
  constexpr double kSharp = geometry::kInfinitelySharp;
  const std::vector<cages::Named> subjects = {
      {"cube", cages::cube()},
      {"cube, ring of creases", cages::creased(cages::cube(), {4, 5, 7, 6, 4}, kSharp)},
      {"cube, ring of sharpness 2", cages::creased(cages::cube(), {4, 5, 7, 6, 4}, 2)},
      {"prism of 5", cages::prism(5)},
      {"sheet of 400 faces", cages::sheet(20, 20)},
  };
  struct Setting {
    const cages::Named* subject;
    double max_error;
  };
  std::vector<Setting> settings;
  for (const cages::Named& subject : subjects)
    for (const double error : {1e-2, 1e-3, 1e-4, 1e-5})
      if (!context.quick() || error > 5e-3) settings.push_back({&subject, error});
  std::vector<Variant> variants;
  for (const Setting& s : settings)
    variants.push_back({s.subject->name, [&s] {
                          if (made(s.subject->shape, s.max_error).triangles.empty()) std::abort();
                        }});
  const std::vector<Timing> timings = interleaved(variants, context.quick() ? 2 : 5);
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const auto& [subject, max_error] = settings[i];
    const Mesh mesh = made(subject->shape, max_error);
    // what the reference misses falls fourfold with each level; finer errors have none
    const bool compared = max_error > 5e-4;
    double there = mesh.error;
    if (compared) {
      const int levels = subject->shape.faces.size() > 100 ? 4 : context.quick() ? 5 : 6;
      const Mesh fine = oracles::CatmullClark(subject->shape).refined(levels).limit_mesh();
      there = geometry::distance_from(geometry::MeasuredMesh(mesh), geometry::MeasuredMesh(fine),
                                      {.relative = 0.02})
                  .low;
    }
    Row row{.case_name = "subdiv",
            .setting = fmt::format(
                "{} max_error={:g} triangles={} us={:.4g} stored/requested={:.3f}", subject->name,
                max_error, mesh.triangles.size(), 1e6 * timings[i].median, mesh.error / max_error),
            .speed_unit = "Mtri/s",
            .error = there,
            .error_unit = "m",
            .reference = compared ? "Hausdorff distance to the cage refined by the rules alone"
                                  : "as measured when it is made",
            .reference_error = compared ? 3e-4 : 0};
    set_rate(row, timings[i], 1e-6 * static_cast<double>(mesh.triangles.size()));
    row.must_error = max_error + row.reference_error;
    context.add(row);
  }
  for (const cages::Named& subject : cages::all()) {
    Row row{.case_name = "subdiv",
            .setting = fmt::format("{}: vertices of levels 1 to 3", subject.name),
            .speed_unit = "",
            .error = 0,
            .error_unit = "m",
            .reference = "cages refined by the rules alone, pushed to the limit by masks",
            .reference_error = 1e-15};
    for (const std::uint32_t levels : {1u, 2u, 3u})
      row.error = std::max(row.error, limit_error(subject.shape, levels));
    row.must_error = 1e-12;
    context.add(row);
  }
}

const bool kAdded =
    add_case({"subdiv", "making subdivision surfaces, against cages refined by their rules", run});

}  // namespace

}  // namespace panwright::bench::case_subdiv
