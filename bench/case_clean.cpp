// Cleaning of meshes: speed against error.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "bench/bench.h"
#include "geometry/mesh/clean.h"
#include "geometry/tessellate/tessellate.h"
#include "tests/geometry/shapes.h"

namespace panwright::bench::case_clean {

namespace {

using geometry::CleanOptions;
using geometry::CleanReport;
using geometry::Mesh;

Mesh bare(const geometry::Shape& shape) {
  DiagnosticLog log;
  const auto made = geometry::tessellated(shape, {}, {}, log);
  Mesh mesh;
  mesh.positions = made->positions;
  mesh.triangles = made->triangles;
  return mesh;
}

// Corners, each with its own vertex, moved by up to `noise`.
Mesh soup(const Mesh& mesh, double noise) {
  geometry::shapes::Random random(1);
  Mesh out;
  for (const geometry::Triangle& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(out.positions.size());
    for (const std::uint32_t v : t)
      out.positions.push_back(mesh.positions[v] + noise * random() * random.direction());
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

struct Job {
  std::string setting;
  Mesh mesh;
  CleanOptions options;
  double must;  // Mtri/s; 0: none
  // the error of a cleaned mesh and what it may be
  double (*error)(const Mesh&, const CleanReport&);
  const char* error_unit;
  const char* reference;
  double must_error;
};

double against_radii(const Mesh& mesh, const CleanReport&) {
  double worst = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    worst = std::max(worst, angle_between(mesh.normals[i], mesh.positions[i]));
  return worst;
}

// A cylinder about z with caps, radius 1: radial at its side, ±z on its caps.
double against_cylinder(const Mesh& mesh, const CleanReport&) {
  double worst = 0;
  for (const geometry::Triangle& t : mesh.triangles) {
    const Vec3& a = mesh.positions[t[0]];
    const Vec3 facet = glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
    const bool cap = std::fabs(facet.z) > 0.5 * glm::length(facet);
    for (const std::uint32_t v : t) {
      const Vec3& p = mesh.positions[v];
      const Vec3 exact = cap ? Vec3(0, 0, facet.z) : Vec3(p.x, p.y, 0);
      worst = std::max(worst, angle_between(mesh.normals[v], exact));
    }
  }
  return worst;
}

double largest_move(const Mesh&, const CleanReport& report) { return report.largest_move; }

void run(Context& context) {
  const std::uint32_t rings = context.quick() ? 50 : 1000;
  const std::uint32_t quads = context.quick() ? 50 : 500;
  const Mesh sphere = bare(geometry::Sphere{1, geometry::SphereCounts{rings, quads}});
  geometry::Cylinder round;
  round.radius = 1;
  round.height = 2;
  round.counts.around = context.quick() ? 100 : 200'000;
  CleanOptions plain;
  plain.drop_degenerate = plain.drop_duplicates = plain.orient = plain.examine = false;
  CleanOptions near;
  near.tolerance = 1e-6;
  const char* radii = "radii of the sphere";
  // a million triangles in 0.45 s
  const double must = context.quick() ? 0 : 1 / 0.45;
  // normals by angle lie within half a facet's turn of the radii, squared
  const double turn = 2 * kPi / std::min(2 * rings, quads);
  std::vector<Job> jobs;
  jobs.push_back(
      {"weld, normals, order", sphere, plain, must, against_radii, "rad", radii, turn * turn});
  jobs.push_back({"all", sphere, {}, must, against_radii, "rad", radii, turn * turn});
  jobs.push_back({"all, of single triangles",
                  soup(sphere, 0),
                  {},
                  0,
                  against_radii,
                  "rad",
                  radii,
                  turn * turn});
  jobs.push_back({"all, of a cylinder with caps",
                  bare(round),
                  {},
                  0,
                  against_cylinder,
                  "rad",
                  "radii and axis of the cylinder",
                  1e-9});
  jobs.push_back({"all, weld within 1e-6 m", soup(sphere, 4e-7), near, 0, largest_move, "m",
                  "where vertices were; the bound is the tolerance", 1e-6});
  std::vector<Mesh> results(jobs.size());
  std::vector<CleanReport> reports(jobs.size());
  std::vector<Variant> variants;
  for (std::size_t i = 0; i < jobs.size(); ++i)
    variants.push_back({jobs[i].setting, [&, i] {
                          results[i] = jobs[i].mesh;
                          reports[i] = geometry::clean(results[i], jobs[i].options);
                        }});
  const std::vector<Timing> timings = interleaved(variants, context.quick() ? 3 : 7);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    Row row{
        .case_name = "clean",
        .setting = fmt::format("{} triangles={}", jobs[i].setting, jobs[i].mesh.triangles.size()),
        .speed_unit = "Mtri/s",
        .error = jobs[i].error(results[i], reports[i]),
        .error_unit = jobs[i].error_unit,
        .reference = jobs[i].reference,
        .must_error = jobs[i].must_error};
    row.must = jobs[i].must;
    set_rate(row, timings[i], 1e-6 * static_cast<double>(jobs[i].mesh.triangles.size()));
    context.add(row);
    if (!results[i].closed) context.note(fmt::format("'{}' was not closed", jobs[i].setting));
  }
}

const bool kAdded = add_case({"clean", "cleaning of meshes", run});

}  // namespace

}  // namespace panwright::bench::case_clean
