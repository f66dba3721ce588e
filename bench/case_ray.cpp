// Ray casting: speed against the exact sphere.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/parallel.h"
#include "bench/bench.h"

#include "geometry/tessellate/tessellate.h"
#include "tests/support/ray_caster.h"

namespace panwright::bench::case_ray {

namespace {

struct Outcome {
  double worst = 0;         // metres
  std::uint64_t wrong = 0;  // rays that hit or missed against the rule
};

// Parallel rays on a square grid over the disc of a sphere of radius 1.
std::vector<geometry::Ray> grid(int side, double range) {
  std::vector<geometry::Ray> rays;
  rays.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  const Vec3 toward(0.36, -0.48, 0.8);
  const Vec3 right(0.8, 0.6, 0);
  const Vec3 up = glm::cross(toward, right);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      rays.push_back({toward * range + right * (2.2 * (x + 0.5) / side - 1.1) +
                          up * (2.2 * (y + 0.5) / side - 1.1),
                      -toward});
  return rays;
}

// Against the sphere. The mesh lies up to `depth` inside: near the limb either answer is right.
Outcome compare(const support::RayCaster& caster, const std::vector<geometry::Ray>& rays,
                double depth) {
  Outcome outcome;
  for (const geometry::Ray& ray : rays) {
    const auto hit = caster.closest(ray);
    const double along = glm::dot(ray.origin, -ray.direction);
    const Vec3 across = ray.origin + along * ray.direction;
    const double impact = glm::length(across);
    if (impact > 1 - depth && impact < 1) continue;
    if (hit.has_value() != (impact < 1)) {
      ++outcome.wrong;
      continue;
    }
    // distance of the hit from the sphere itself, whatever the slope
    if (hit) {
      const Vec3 place = across + (hit->distance - along) * ray.direction;
      outcome.worst = std::max(outcome.worst, std::fabs(glm::length(place) - 1));
    }
  }
  return outcome;
}

void run(Context& context) {
  const int side = context.quick() ? 64 : 1024;
  for (const std::uint32_t rings : {100u, 400u, 700u}) {
    if (context.quick() && rings > 100) continue;
    DiagnosticLog log;
    const auto mesh = geometry::tessellated(
        geometry::Sphere{1, geometry::SphereCounts{rings, rings}}, {}, {}, log);
    const Timing build = timed(
        [&] {
          support::RayCaster caster;
          caster.add(*mesh, Mat4(1));
          caster.build();
        },
        context.quick() ? 1 : 3);
    support::RayCaster caster;
    caster.add(*mesh, Mat4(1));
    caster.build();
    const std::vector<geometry::Ray> rays = grid(side, 1e5);
    const auto cast_all = [&](bool any) {
      const std::size_t chunk = 4096;
      parallel_for((rays.size() + chunk - 1) / chunk, [&](std::size_t task) {
        const std::size_t end = std::min(rays.size(), (task + 1) * chunk);
        for (std::size_t i = task * chunk; i < end; ++i) {
          const bool hit = any ? caster.any(rays[i]) : caster.closest(rays[i]).has_value();
          // keeps the call from being left out
          if (hit && rays[i].max_distance < 0) std::abort();
        }
      });
    };
    const std::vector<Timing> timings =
        interleaved({{"closest", [&] { cast_all(false); }}, {"any", [&] { cast_all(true); }}},
                    context.quick() ? 3 : 5);
    const Outcome outcome = compare(caster, rays, mesh->error);
    for (std::size_t i = 0; i < 3; ++i) {
      Row row{.case_name = "ray",
              .setting = fmt::format("{} triangles={} range=1e5 R",
                                     i == 0 ? "closest" : (i == 1 ? "any" : "build"),
                                     mesh->triangles.size()),
              .speed_unit = i == 2 ? "Mtri/s" : "Mray/s",
              .error = outcome.worst,
              .error_unit = "m",
              .reference = "sphere of radius 1 m; the mesh's own error is included",
              .reference_error = mesh->error,
              // 1e5 R away the double of an origin is worth 1.5e-11
              .must_error = mesh->error + 1e-9};
      if (i == 2)
        set_rate(row, build, 1e-6 * static_cast<double>(mesh->triangles.size()));
      else
        set_rate(row, timings[i], 1e-6 * static_cast<double>(rays.size()));
      context.add(row);
    }
    if (outcome.wrong > 0)
      context.note(
          fmt::format("{} of {} rays hit or miss against the rule", outcome.wrong, rays.size()));
  }
}

const bool kAdded = add_case({"ray", "ray casting on spheres", run});

}  // namespace

}  // namespace panwright::bench::case_ray
