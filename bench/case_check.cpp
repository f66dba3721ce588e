// Examination of meshes and computed normals.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "bench/bench.h"

#include "geometry/mesh/check.h"
#include "geometry/mesh/strip.h"
#include "geometry/tessellate/tessellate.h"

namespace panwright::bench::case_check {

namespace {

// 4π/3 less what the polyhedron lacks: prismatoids between similar polygons.
double polyhedron_volume(std::uint32_t rings, std::uint32_t quads) {
  const double polygon = 0.5 * quads * std::sin(2 * kPi / quads);
  double volume = 0;
  for (std::uint32_t j = 0; j < rings; ++j) {
    const double r0 = std::sin(kPi * j / rings);
    const double r1 = std::sin(kPi * (j + 1) / rings);
    volume += polygon * 2 * std::sin(kPi * (j + 0.5) / rings) * std::sin(0.5 * kPi / rings) / 3 *
              (r0 * r0 + r0 * r1 + r1 * r1);
  }
  return volume;
}

// The largest angle between computed normals and the radii of the sphere.
double normal_error(const geometry::Mesh& mesh) {
  double worst = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    worst = std::max(worst, angle_between(mesh.normals[i], mesh.positions[i]));
  return worst;
}

void run(Context& context) {
  for (const std::uint32_t rings : {100u, 500u, 1000u}) {
    if (context.quick() && rings > 100) continue;
    const std::uint32_t quads = rings;
    DiagnosticLog log;
    const auto made = geometry::tessellated(
        geometry::Sphere{1, geometry::SphereCounts{rings, quads}}, {}, {}, log);
    const geometry::Mesh& mesh = *made;
    geometry::Mesh bare;
    bare.positions = mesh.positions;
    bare.triangles = mesh.triangles;
    geometry::MeshReport report;
    geometry::Mesh smoothed;
    const std::vector<Timing> timings =
        interleaved({{"check", [&] { report = geometry::check(mesh); }},
                     {"normals",
                      [&] {
                        smoothed = bare;
                        geometry::compute_normals(smoothed, 0.5);
                      }}},
                    context.runs());
    const double millions = 1e-6 * static_cast<double>(mesh.triangles.size());
    const double volume = polyhedron_volume(rings, quads);
    Row row{.case_name = "check",
            .setting = fmt::format("check triangles={}", mesh.triangles.size()),
            .speed_unit = "Mtri/s",
            .error = std::fabs(report.volume - volume) / volume,
            .error_unit = "relative",
            .reference = "volume as a sum of prismatoids",
            .reference_error = 1e-14,
            .must_error = 1e-13};
    set_rate(row, timings[0], millions);
    context.add(row);
    if (!report.closed) context.note("a sphere was not found closed");
    Row normals{.case_name = "check",
                .setting = fmt::format("compute_normals triangles={}", mesh.triangles.size()),
                .speed_unit = "Mtri/s",
                .error = normal_error(smoothed),
                .error_unit = "rad",
                .reference = "radii of the sphere",
                .reference_error = 2e-16};
    set_rate(normals, timings[1], millions);
    // a million triangles in about a second
    normals.must = 1;
    context.add(normals);
  }
}

const bool kAdded = add_case({"check", "examination of meshes, computed normals", run});

}  // namespace

}  // namespace panwright::bench::case_check
