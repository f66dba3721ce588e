// Exact shapes: making and packing their meshes, against distances, counts and fluxes of their own.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>

#include "bench/bench.h"
#include "geometry/tessellate/tessellate.h"
#include "pan/writer.h"
#include "tests/support/shape_distance.h"

namespace panwright::bench::case_shapes {

namespace {

using geometry::Mesh;

struct Subject {
  std::string name;
  geometry::Shape shape;
  double size;  // tolerances are shares of it
  oracles::Distance distance;
  std::function<double(double)> count;  // closed form of the triangles for an error in metres
  double reference_error = 1e-12;       // of the distance, a share of the size
  bool flat = false;                    // exact, whatever error is allowed
};

// balanced: half of both dips, in equal shares; outlines of equal area stand out by h²/3
double outline(double radius, double e) { return M_PI / std::sqrt(3 * e / radius); }

double dish_count(double radius, double focal, double e) {
  double chords = 0;
  const int n = 10000;
  for (int i = 0; i < n; ++i)
    chords += radius / n * std::sqrt(1 / (16 * focal * e)) *
              std::pow(1 + std::pow((i + 0.5) / n * radius / (2 * focal), 2), -0.25);
  const double lever = radius * radius / std::hypot(radius, 2 * focal);
  const double segments = std::max(outline(radius, e), M_PI / std::sqrt(2 * e / lever));
  return segments * (2 * chords - 1);
}

// The fewest of many small triangles, equilateral where the ellipsoid is an image of the unit
// sphere: ∫ h dω / (3√3 e), h the distance between centre and tangent plane.
double ellipsoid_count(const Vec3& r, double e) {
  double sum = 0;
  const int n = 400;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double t = (i + 0.5) * M_PI / n, l = (j + 0.5) * M_PI / 2 / n;
      const Vec3 u(std::sin(t) * std::cos(l), std::sin(t) * std::sin(l), std::cos(t));
      sum += std::sin(t) / glm::length(u / r);
    }
  return sum * 4 * (M_PI / n) * (M_PI / 2 / n) / (3 * std::sqrt(3.0) * e);
}

void add_pipes(std::vector<Subject>& all) {
  geometry::Tube pipe;
  pipe.path = {{0, 0, 0}, {0, 0, 2}, {1.5, 0, 2.5}, {1.5, 2, 3}, {0, 2, 4}};
  pipe.radius = 0.3;
  all.push_back({"tube of 4 pieces, 0.3", pipe, 1, oracles::distance_to_mitred_tube(pipe, 1e-6),
                 nullptr, 1e-6});
  // the chords of the axis are shorter than 1e-4, and it bends by less than 4 a metre
  pipe.spline = true;
  all.push_back(
      {"tube, spline, 0.3", pipe, 1, oracles::distance_to_spline_tube(pipe, 30000), nullptr, 5e-9});
}

// A box's faces as a grid of squares.
geometry::Polygons grid(std::uint32_t n) {
  geometry::Polygons s;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> known;
  const auto vertex = [&](const std::array<std::uint32_t, 3>& p) {
    const auto [at, added] = known.emplace(p, static_cast<std::uint32_t>(s.positions.size()));
    if (added) s.positions.push_back(Vec3(p[0], p[1], p[2]) / double(n) - Vec3(0.5));
    return at->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::uint32_t side : {0u, n})
      for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t k = 0; k < n; ++k) {
          std::vector<std::uint32_t> outline;
          for (const auto& [u, v] : {std::pair(i, k), std::pair(i + 1, k), std::pair(i + 1, k + 1),
                                     std::pair(i, k + 1)}) {
            std::array<std::uint32_t, 3> p{};
            p[axis] = side;
            p[(axis + 1) % 3] = u;
            p[(axis + 2) % 3] = v;
            outline.push_back(vertex(p));
          }
          if (side == 0) std::reverse(outline.begin(), outline.end());
          s.faces.push_back({outline, {}});
        }
  return s;
}

void add_flat(std::vector<Subject>& all) {
  const auto add = [&](std::string name, const auto& shape, double triangles,
                       oracles::Distance distance) {
    all.push_back({std::move(name), shape, 1, std::move(distance),
                   [triangles](double) { return triangles; }, 1e-12, true});
  };
  const geometry::Plane plane{1.5, 1};
  add("plane 1.5 x 1", plane, 2, oracles::distance_to(plane));
  // a cogwheel with a hole
  geometry::Extrude wheel;
  wheel.height = 0.2;
  wheel.holes.emplace_back();
  for (int i = 0; i < 4000; ++i) {
    const double angle = 2 * M_PI * i / 4000, radius = i % 4 < 2 ? 1 : 0.95;
    wheel.outline.push_back(radius * Vec2(std::cos(angle), std::sin(angle)));
    if (i % 4 == 0) wheel.holes[0].push_back(0.5 * Vec2(std::cos(angle), std::sin(angle)));
  }
  add("extrude, 5000 corners", wheel, 2 * 5000 + 2 * 5000, oracles::distance_to(wheel));
  add("polygons, 60000 squares", grid(100), 120000, [](const Vec3& p) {
    const Vec3 q = glm::abs(p) - Vec3(0.5);
    const double inside = std::min(0.0, std::max({q.x, q.y, q.z}));
    return std::fabs(glm::length(glm::max(q, Vec3(0))) + inside);
  });
}

std::vector<Subject> subjects() {
  using namespace geometry;
  std::vector<Subject> all;
  const auto add = [&](std::string name, const auto& shape, double size,
                       std::function<double(double)> count) {
    all.push_back({std::move(name), shape, size, oracles::distance_to(shape), std::move(count)});
  };
  add("cylinder 1 x 2", Cylinder{1, 2}, 1, [](double e) { return 4 * outline(1, e) - 4; });
  add("cone 1 x 2", Cone{1, 0, 2}, 1, [](double e) { return 2 * outline(1, e) - 2; });
  for (const double top : {0.7, 0.25, 0.04})
    add(fmt::format("frustum 1, {:g} x 2", top), Cone{1, top, 2}, 1,
        [top](double e) { return 2 * outline(1, e) + 2 * outline(top, e) - 4; });
  add("disc 1, 0.3", Disc{1, 0.3}, 1, [](double e) { return outline(1, e) + outline(0.3, e); });
  add("torus 1, 0.25", Torus{1, 0.25}, 1,
      [](double e) { return M_PI * M_PI * std::sqrt(1.25 * 0.25) / e; });
  add("dish 2, f 0.5", Dish{2, 0.5}, 1, [](double e) { return dish_count(1, 0.5, e); });
  add("shell 2, f 0.4, 0.05", Dish{2, 0.4, 0.05}, 1,
      [](double e) { return 2 * dish_count(1, 0.4, e) + 2 * outline(1, e); });
  add("ellipsoid 1, 1, 1", Ellipsoid{{1, 1, 1}}, 1, [](double e) {
    return ellipsoid_count({1, 1, 1}, e);
  });
  add("ellipsoid 3, 2, 1", Ellipsoid{{3, 2, 1}}, 3, [](double e) {
    return ellipsoid_count({3, 2, 1}, e);
  });
  add("ellipsoid 1, 1, 100", Ellipsoid{{1, 1, 100}}, 100, [](double e) {
    return ellipsoid_count({1, 1, 100}, e);
  });
  add("zone -30..60", Sphere{1, {}, -kPi / 6, kPi / 3, {}}, 1,
      [](double e) { return 2 * M_PI / std::sqrt(2 * e) * (M_PI / 4) / std::sqrt(2 * e); });
  Lathe vase;
  vase.profile = {{0, -1}, {1, -0.7}, {0.6, 0}, {0.8, 0.9}, {0, 1.5}};
  add("vase", vase, 1, [](double e) { return 6 * outline(1, e); });
  vase.spline = true;
  // a thousand chords for each pair of points are off by 1e-6, and it falls with the square
  all.push_back({"vase, spline", vase, 1, oracles::to_revolved(oracles::profile_of(vase, 30000)),
                 nullptr, 2e-9});
  const Vec3 half = Vec3(1, 0.7, 0.5) - Vec3(0.2);
  all.push_back({"box 2 x 1.4 x 1, round 0.2", geometry::Box{{2, 1.4, 1}, 0.2, true}, 1,
                 [half](const Vec3& p) {
                   const Vec3 q = glm::abs(p) - half;
                   const double inside = std::min(0.0, std::max({q.x, q.y, q.z}));
                   return std::fabs(glm::length(glm::max(q, Vec3(0))) + inside - 0.2);
                 },
                 nullptr});
  add_pipes(all);
  add_flat(all);
  return all;
}

// At most this many triangles are sampled, spread over the mesh.
Mesh sample_of(const Mesh& mesh, std::size_t most) {
  if (mesh.triangles.size() <= most) return mesh;
  Mesh some = mesh;
  some.triangles.clear();
  for (std::size_t i = 0; i < most; ++i)
    some.triangles.push_back(mesh.triangles[i * mesh.triangles.size() / most]);
  return some;
}

// Light that a Lambert surface sends to an eye, by facets with smooth normals; nothing hides
// another. Seven points a triangle: Radon's rule of the fifth degree.
double flux(const Mesh& mesh, const Vec3& eye, const Vec3& light) {
  constexpr double kA = 0.470142064105115, kB = 0.101286507323456;
  constexpr double kWeights[7] = {0.225,
                                  0.132394152788506,
                                  0.132394152788506,
                                  0.132394152788506,
                                  0.125939180544827,
                                  0.125939180544827,
                                  0.125939180544827};
  const Vec3 points[7] = {Vec3(1.0 / 3),        {1 - 2 * kA, kA, kA}, {kA, 1 - 2 * kA, kA},
                          {kA, kA, 1 - 2 * kA}, {1 - 2 * kB, kB, kB}, {kB, 1 - 2 * kB, kB},
                          {kB, kB, 1 - 2 * kB}};
  double sum = 0;
  for (const geometry::Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const Vec3 area = 0.5 * glm::cross(b - a, c - a);
    for (int k = 0; k < 7; ++k) {
      const Vec3& w = points[k];
      const Vec3 to_eye = eye - (w.x * a + w.y * b + w.z * c);
      const double seen = glm::dot(area, to_eye);
      if (seen <= 0) continue;
      const Vec3 n = glm::normalize(w.x * mesh.normals[t[0]] + w.y * mesh.normals[t[1]] +
                                    w.z * mesh.normals[t[2]]);
      const double squared = glm::dot(to_eye, to_eye);
      sum +=
          kWeights[k] * std::max(0.0, glm::dot(n, light)) * seen / (squared * std::sqrt(squared));
    }
  }
  return sum;
}

std::optional<Mesh> made(const geometry::Shape& shape, double max_error) {
  geometry::TessellationOptions options;
  options.max_error = max_error;
  DiagnosticLog log;
  auto mesh = geometry::tessellated(shape, options, {}, log);
  if (!mesh) return std::nullopt;
  return *std::move(mesh);
}

// The worst error of flux over phases, seen from a range, relative to that at phase 0.
double flux_error(const Mesh& mesh, const Mesh& fine, double range) {
  const Vec3 to_eye = glm::normalize(Vec3(0.4, 0.25, 0.9));
  const Vec3 across = glm::normalize(glm::cross(to_eye, Vec3(0.3, -1, 0.2)));
  const Vec3 eye = range * to_eye;
  const double full = flux(fine, eye, to_eye);
  double worst = 0;
  for (const double phase : {0.0, 30.0, 60.0, 90.0, 120.0}) {
    const Vec3 light = std::cos(phase * kDegree) * to_eye + std::sin(phase * kDegree) * across;
    worst = std::max(worst, std::fabs(flux(mesh, eye, light) - flux(fine, eye, light)) / full);
  }
  return worst;
}

void run(Context& context) {
  struct Setting {
    const Subject* subject;
    double share;
  };
  const std::vector<Subject> all = subjects();
  std::vector<Setting> settings;
  for (const Subject& subject : all)
    for (const double share : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6})
      if (subject.flat ? share == 1e-2 : !context.quick() || share > 5e-4)
        settings.push_back({&subject, share});
  std::vector<Variant> variants;
  for (const Setting& s : settings)
    variants.push_back({s.subject->name, [&s] {
                          const auto mesh = made(s.subject->shape, s.share * s.subject->size);
                          if (!mesh) std::abort();
                          const pan::PackedMesh packed = pan::packed(*mesh, s.subject->name);
                          if (packed.indices.empty()) std::abort();
                        }});
  const std::vector<Timing> timings = interleaved(variants, context.quick() ? 3 : 5);
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const Subject& subject = *settings[i].subject;
    const double max_error = settings[i].share * subject.size;
    const Mesh mesh = *made(subject.shape, max_error);
    const std::size_t triangles = mesh.triangles.size();
    const Mesh some = sample_of(mesh, context.quick() ? 2000 : 40000);
    const auto measured =
        oracles::sampled_distance(some, subject.distance, triangles < 2000 ? 12 : 4);
    const double bytes =
        24.0 * static_cast<double>(mesh.positions.size()) + 12.0 * static_cast<double>(triangles);
    Row row{
        .case_name = "shapes",
        .setting = fmt::format(
            "{} max_error={:g} triangles={} bytes={:.0f} us={:.4g} rms={:.3g} "
            "measured/requested={:.3f}{}",
            subject.name, max_error, triangles, bytes, 1e6 * timings[i].median, measured.rms,
            measured.worst / max_error,
            subject.count ? fmt::format(" count/closed_form={:.3f}",
                                        static_cast<double>(triangles) / subject.count(max_error))
                          : ""),
        .speed_unit = "Mtri/s",
        .error = measured.worst,
        .error_unit = "m",
        .reference = "distance to the shape, sampled on float32 vertices",
        .reference_error = subject.reference_error * subject.size};
    set_rate(row, timings[i], 1e-6 * static_cast<double>(triangles));
    row.must_error = max_error + row.reference_error;
    if (triangles > 10000) row.must = 5;
    context.add(row);
    // a sample may miss the worst place, but may not find a worse one than was promised
    if (measured.worst > mesh.error + row.reference_error)
      context.note(fmt::format("{}: more than the bound of {} m", row.setting, mesh.error));
    if (settings[i].share < 5e-4 || (context.quick() && settings[i].share < 5e-2)) continue;
    const Mesh fine = *made(subject.shape, 0.01 * max_error);
    for (const double range : {10.0, 100.0, 1000.0}) {
      Row light = row;
      light.setting = fmt::format("{} max_error={:g} triangles={} Lambert flux from {:g} sizes",
                                  subject.name, max_error, triangles, range);
      light.error = flux_error(mesh, fine, range * subject.size);
      light.error_unit = "relative";
      light.reference =
          "mesh of a hundredth of the error, phases 0 to 120 degrees, of the flux at 0";
      light.reference_error = 0.01 * light.error;
      light.must_error = 0;
      light.must = 0;
      context.add(light);
    }
  }
}

const bool kAdded =
    add_case({"shapes", "making and packing exact shapes, against their error", run});

}  // namespace

}  // namespace panwright::bench::case_shapes
