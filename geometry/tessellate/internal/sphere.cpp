#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/parallel.h"
#include "base/text.h"
#include "geometry/internal/limits.h"
#include "geometry/tessellate/internal/circle.h"
#include "geometry/tessellate/internal/maximum.h"
#include "geometry/tessellate/internal/revolution_problem.h"
#include "geometry/tessellate/internal/revolve.h"
#include "geometry/tessellate/internal/staggered.h"
#include "geometry/tessellate/internal/tessellators.h"

namespace panwright::geometry {

namespace {

using internal::kChunk;
using internal::Staggered;
using internal::staggered;
using internal::staggered_mesh;
using internal::Steps;
using internal::turn;

// half the spacing of single precision relative to the number
constexpr double kFloatRounding = 0x1p-24;

std::optional<Staggered> plan(double error, bool texcoords, std::uint64_t most) {
  return staggered(Vec3(1), Steps(1, 1, Steps::Kind::staggered), error, texcoords,
                   static_cast<double>(most));
}

// what rounding to single precision leaves of the error, relative to the radius
double relative_error(const Sphere& sphere, const TessellationOptions& options) {
  const double asked = options.max_error / sphere.radius;
  // note: vertices stand out by the error
  return asked - kFloatRounding * 1.01 * (1 + std::min(1.0, asked));
}

class SphereBuilder {
 public:
  SphereBuilder(double radius, const SphereCounts& counts, bool texcoords)
      : radius_(radius), rings_(counts.rings), quads_(counts.quads), texcoords_(texcoords) {
    columns_ = texcoords ? quads_ + 1 : quads_;
    pole_vertices_ = texcoords ? quads_ : 1;
    vertices_ = 2 * pole_vertices_ + (rings_ - 1) * columns_;
    triangles_ = 2 * quads_ * (rings_ - 1);
  }

  std::uint64_t vertices() const { return vertices_; }
  std::uint64_t triangles() const { return triangles_; }

  Mesh build() const {
    Mesh mesh;
    mesh.positions.resize(vertices_);
    mesh.normals.resize(vertices_);
    if (texcoords_) mesh.texcoords.resize(vertices_);
    mesh.triangles.resize(triangles_);
    std::vector<det::SinCos> longitudes(columns_);
    for (std::uint64_t i = 0; i < columns_; ++i) longitudes[i] = turn(i % quads_, quads_);
    fill_poles(mesh);
    // note: small spheres stay on this thread, starting others costs more than they save
    const std::uint64_t rows = std::max<std::uint64_t>(1, kChunk / columns_);
    const std::uint64_t tasks = (rings_ - 1 + rows - 1) / rows;
    parallel_for(tasks, [&](std::size_t task) {
      const std::uint64_t end = std::min(rings_, (task + 1) * rows + 1);
      for (std::uint64_t ring = task * rows + 1; ring < end; ++ring)
        fill_ring(mesh, ring, longitudes);
    });
    mesh.closed = true;
    return mesh;
  }

 private:
  std::uint64_t ring_start(std::uint64_t ring) const {
    return pole_vertices_ + (ring - 1) * columns_;
  }

  void fill_poles(Mesh& mesh) const {
    for (std::uint64_t i = 0; i < pole_vertices_; ++i) {
      const std::uint64_t north = vertices_ - pole_vertices_ + i;
      mesh.normals[i] = {0, 0, -1};
      mesh.normals[north] = {0, 0, 1};
      mesh.positions[i] = {0, 0, -radius_};
      mesh.positions[north] = {0, 0, radius_};
      if (!texcoords_) continue;
      const double u = (static_cast<double>(i) + 0.5) / static_cast<double>(quads_);
      mesh.texcoords[i] = {u, 0};
      mesh.texcoords[north] = {u, 1};
    }
    const std::uint64_t first = ring_start(1);
    const std::uint64_t last = ring_start(rings_ - 1);
    const std::uint64_t north = vertices_ - pole_vertices_;
    for (std::uint64_t i = 0; i < quads_; ++i) {
      const std::uint64_t next = texcoords_ ? i + 1 : (i + 1) % quads_;
      const std::uint64_t pole = texcoords_ ? i : 0;
      mesh.triangles[i] = triangle(pole, first + next, first + i);
      mesh.triangles[triangles_ - quads_ + i] = triangle(last + i, last + next, north + pole);
    }
  }

  // the vertices of a ring, and the triangles between it and the ring north of it
  void fill_ring(Mesh& mesh, std::uint64_t ring, const std::vector<det::SinCos>& longitudes) const {
    // latitude −π/2 + π·ring/rings
    const det::SinCos polar = turn(ring, 2 * rings_);
    const std::uint64_t start = ring_start(ring);
    for (std::uint64_t i = 0; i < columns_; ++i) {
      const Vec3 n(polar.sin * longitudes[i].cos, polar.sin * longitudes[i].sin, -polar.cos);
      mesh.normals[start + i] = n;
      mesh.positions[start + i] = radius_ * n;
      if (texcoords_)
        mesh.texcoords[start + i] = {static_cast<double>(i) / static_cast<double>(quads_),
                                     static_cast<double>(ring) / static_cast<double>(rings_)};
    }
    if (ring == rings_ - 1) return;
    Triangle* out = mesh.triangles.data() + quads_ + 2 * quads_ * (ring - 1);
    for (std::uint64_t i = 0; i < quads_; ++i) {
      const std::uint64_t next = texcoords_ || i + 1 < quads_ ? i + 1 : 0;
      const std::uint64_t south = start;
      const std::uint64_t north = start + columns_;
      *out++ = triangle(south + i, south + next, north + next);
      *out++ = triangle(south + i, north + next, north + i);
    }
  }

  static Triangle triangle(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    return {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
            static_cast<std::uint32_t>(c)};
  }

  double radius_;
  std::uint64_t rings_;
  std::uint64_t quads_;
  bool texcoords_;
  std::uint64_t columns_ = 0;
  std::uint64_t pole_vertices_ = 0;
  std::uint64_t vertices_ = 0;
  std::uint64_t triangles_ = 0;
};

bool size_is_held(const Sphere& sphere, SourceSpan where, DiagnosticLog& log) {
  if (sphere.radius >= kMinRadius && sphere.radius <= kMaxCoordinate) return true;
  log.report(
      Code("E2010"), where,
      fmt::format("a sphere of radius {} m, expected {} to {} m", format_double(sphere.radius),
                  format_double(kMinRadius), format_double(kMaxCoordinate)));
  return false;
}

Result<Mesh> counted_sphere(const Sphere& sphere, const TessellationOptions& options,
                            SourceSpan where, DiagnosticLog& log) {
  const SphereCounts counts = *sphere.counts;
  assert(counts.rings >= 2 && counts.quads >= 3);
  // note: the product of two 32-bit counts fits 64 bits, twice it may not
  const std::uint64_t half = std::uint64_t{counts.quads} * (counts.rings - 1);
  const std::uint64_t limit = std::min(options.max_triangles, kMaxVertices);
  if (half > limit / 2) {
    log.report(Code("E2003"), where,
               fmt::format("a sphere of {} rings and {} quads needs more than {} triangles",
                           counts.rings, counts.quads, limit));
    return failed;
  }
  const SphereBuilder builder(sphere.radius, counts, options.texcoords);
  if (builder.vertices() > kMaxVertices) {
    log.report(Code("E2003"), where,
               fmt::format("a sphere of {} rings and {} quads with texture coordinates needs more "
                           "than {} vertices",
                           counts.rings, counts.quads, kMaxVertices));
    return failed;
  }
  Mesh mesh = builder.build();
  mesh.error = sphere_error(mesh, sphere.radius, Vec3(0));
  return mesh;
}

Result<Mesh> staggered_sphere(const Sphere& sphere, const TessellationOptions& options,
                              SourceSpan where, DiagnosticLog& log) {
  assert(options.max_error > 0);
  const double relative = relative_error(sphere, options);
  if (relative <= 0) {
    log.report(Code("E2003"), where,
               fmt::format("an error of {} m cannot be achieved with single-precision vertices on "
                           "a sphere of radius {} m, expected at least {} m",
                           format_double(options.max_error), format_double(sphere.radius),
                           format_double(kFloatRounding * 1.02 * sphere.radius)));
    return failed;
  }
  const std::uint64_t limit = std::min(options.max_triangles, kMaxVertices);
  const std::optional<Staggered> rings = plan(relative, options.texcoords, limit);
  if (!rings || rings->vertices > static_cast<double>(kMaxVertices)) {
    log.report(Code("E2003"), where,
               fmt::format("a sphere of radius {} m with an error of {} m needs more than {} "
                           "triangles",
                           format_double(sphere.radius), format_double(options.max_error), limit));
    return failed;
  }
  const det::SinCos begin =
      internal::directions(sphere.sector, internal::fewest_segments(sphere.sector)).front();
  Mesh mesh = staggered_mesh(
      *rings, {.radii = Vec3(sphere.radius), .out = sphere.radius * rings->out, .begin = begin},
      Steps(1, 1, Steps::Kind::staggered), options.texcoords);
  mesh.error = sphere_error(mesh, sphere.radius, Vec3(0));
  return mesh;
}

}  // namespace

namespace internal {

namespace {

// the part between two latitudes; whole ones turn from another meridian
Revolution sphere_revolution(const Sphere& s) {
  Revolution r{.kind = "sphere", .sector = s.sector};
  if (s.counts) r.counts = {s.counts->quads, s.counts->rings};
  const double south = std::max(s.latitude_min, -0.5 * kPi);
  const double north = std::min(s.latitude_max, 0.5 * kPi);
  r.parts.push_back(Part::curved(Curve::arc({0, 0}, s.radius, south, north)));
  r.closed = s.whole();
  return r;
}

// explicit counts about another first meridian are a revolution's
bool plain(const Sphere& s) { return s.whole() && (!s.counts || s.sector.begin == 0); }

}  // namespace

Problem problem(const Sphere& s) {
  if (auto p = size_problem(s.radius, "radius", "a radius")) return p;
  // note: so that 90 degrees in radians, rounded up, is a pole
  const double most = 0.5 * kPi * (1 + 1e-12);
  if (!(s.latitude_min >= -most && s.latitude_max <= most &&
        s.latitude_max - s.latitude_min > 1e-12))
    return ShapeProblem{
        Code("E2017"),
        fmt::format(
            "latitudes from {:.12g} to {:.12g} deg, expected -90 to 90 deg, the lowest first",
            s.latitude_min / kDegree, s.latitude_max / kDegree),
        "latitude_min"};
  if (auto p = sector_problem(s.sector)) return p;
  if (!s.counts) return std::nullopt;
  const bool poles = s.latitude_min <= -0.5 * kPi && s.latitude_max >= 0.5 * kPi;
  const std::uint32_t least = poles ? 2 : 1;
  if (s.counts->rings < least || s.counts->quads < 1)
    return ShapeProblem{
        Code("E2018"),
        fmt::format("{} and {}, expected at least {} and {}", counted(s.counts->rings, "ring"),
                    counted(s.counts->quads, "quad"), least, fewest_segments(s.sector)),
        s.counts->rings < least ? "rings" : "segments"};
  return counts_problem({s.counts->quads, s.counts->rings}, s.sector, least);
}

Result<Mesh> make(const Sphere& s, const TessellationOptions& options, SourceSpan where,
                  DiagnosticLog& log) {
  if (plain(s)) {
    if (!size_is_held(s, where, log)) return failed;
    return s.counts ? counted_sphere(s, options, where, log)
                    : staggered_sphere(s, options, where, log);
  }
  if (const Problem p = problem(s)) {
    log.report(p->code, where, p->message);
    return failed;
  }
  return revolved(sphere_revolution(s), options, where, log);
}

double planned(const Sphere& s, const TessellationOptions& options) {
  if (!plain(s)) return planned_triangles(sphere_revolution(s), options);
  if (s.counts) return 2.0 * s.counts->quads * (s.counts->rings - 1.0);
  const double relative = relative_error(s, options);
  if (relative <= 0) return static_cast<double>(kMaxVertices);
  const std::optional<Staggered> rings = plan(relative, options.texcoords, kMaxVertices);
  return rings ? rings->triangles : static_cast<double>(kMaxVertices);
}

std::vector<CircularEdge> circular_edges(const Sphere& s) {
  if (s.whole() || s.counts) return {};
  std::vector<CircularEdge> result;
  for (const double latitude : {s.latitude_min, s.latitude_max}) {
    if (std::fabs(latitude) >= 0.5 * kPi) continue;
    const det::SinCos angle = det::sincos(latitude);
    result.push_back(circular_edge(s.radius * angle.cos, s.radius * angle.sin, s.sector));
  }
  return result;
}

std::uint32_t segments(const Sphere& s, const TessellationOptions& options) {
  return s.whole() ? 0 : shared_segments(sphere_revolution(s), options);
}

}  // namespace internal

}  // namespace panwright::geometry
