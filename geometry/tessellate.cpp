#include "geometry/tessellate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/text.h"
#include "geometry/internal/tessellators.h"
#include "geometry/internal/triangle.h"

namespace panwright::geometry {

namespace {

constexpr std::uint64_t kMaxVertices = 0xffffffffu;
// half the spacing of single precision relative to the number
constexpr double kFloatRounding = 0x1p-24;
// elements that one task handles; small meshes stay on the calling thread
constexpr std::size_t kChunk = std::size_t{1} << 16;

// sin and cos of 2π·k/n, from the first octant, so that a sphere is symmetric to the last bit
det::SinCos turn(std::uint64_t k, std::uint64_t n) {
  std::uint64_t num = 4 * k;
  const std::uint64_t den = 4 * n;
  const bool lower = 2 * num > den;
  if (lower) num = den - num;
  const bool left = 4 * num > den;
  if (left) num = den / 2 - num;
  const bool steep = 8 * num > den;
  if (steep) num = den / 4 - num;
  det::SinCos r{std::sqrt(0.5), std::sqrt(0.5)};
  if (8 * num != den)
    r = det::sincos(2 * kPi * (static_cast<double>(num) / static_cast<double>(den)));
  if (steep) std::swap(r.sin, r.cos);
  if (left) r.cos = -r.cos;
  if (lower) r.sin = -r.sin;
  return r;
}

// How far the facets of an inscribed sphere of radius 1 dip inside: the band nearest the equator
// decides. It lies across the equator when rings is odd, and touches it otherwise.
double inscribed_depth(std::uint64_t rings, std::uint64_t quads) {
  const double half_band = 0.5 * kPi / static_cast<double>(rings);
  const double half_step = kPi / static_cast<double>(quads);
  const double sin_half_step = det::sin(half_step);
  const double sin_band = det::sin(half_band);
  if (rings % 2 == 1) {
    // 1 − cos·cos without cancellation
    const double a = det::sin(0.5 * half_band);
    const double b = det::sin(0.5 * half_step);
    return 2 * a * a + 2 * b * b - 4 * a * a * b * b;
  }
  const double k2 = 1 - sin_half_step * sin_half_step;
  const double s2 = sin_band * sin_band;
  const double c2 = 1 - s2;
  const double x2_deficit = (c2 * (sin_half_step * sin_half_step) + k2 * s2) / (c2 + k2 * s2);
  return x2_deficit / (1 + std::sqrt(1 - x2_deficit));
}

// The fewest quads for which the depth is allowed, or 0 where no number of them is enough.
std::uint64_t fewest_quads(std::uint64_t rings, double depth) {
  const double half_band = 0.5 * kPi / static_cast<double>(rings);
  double sin2 = 0;  // of π/quads at the allowed depth
  if (rings % 2 == 1) {
    const double a = det::sin(0.5 * half_band);
    if (depth <= 2 * a * a) return 0;
    const double b2 = (0.5 * depth - a * a) / (1 - 2 * a * a);
    sin2 = 4 * b2 * (1 - b2);
    if (b2 >= 0.5) sin2 = 1;
  } else {
    const double s = det::sin(half_band);
    const double room = depth * (2 - depth) - s * s;
    if (room <= 0) return 0;
    const double x2 = (1 - depth) * (1 - depth);
    sin2 = std::min(1.0, room / (1 - s * s - x2 * s * s));
  }
  const double half_step = det::atan2(std::sqrt(sin2), std::sqrt(1 - sin2));
  auto quads = std::max<std::uint64_t>(3, static_cast<std::uint64_t>(std::ceil(kPi / half_step)));
  // the analytic answer can be off by its own rounding
  while (inscribed_depth(rings, quads) > depth) ++quads;
  while (quads > 3 && inscribed_depth(rings, quads - 1) <= depth) --quads;
  return quads;
}

Vec3 stored(const Vec3& p, const Vec3& origin) {
  const Vec3 d = p - origin;
  return {static_cast<double>(static_cast<float>(d.x)),
          static_cast<double>(static_cast<float>(d.y)),
          static_cast<double>(static_cast<float>(d.z))};
}

// The maximum of body(begin, end) over chunks of [0, count): the same whatever the threads.
template <class Body>
double maximum(std::size_t count, const Body& body) {
  std::vector<double> parts((count + kChunk - 1) / kChunk, 0.0);
  parallel_for(parts.size(), [&](std::size_t i) {
    parts[i] = body(i * kChunk, std::min(count, (i + 1) * kChunk));
  });
  double worst = 0;
  for (const double part : parts) worst = std::max(worst, part);
  return worst;
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

Result<Mesh> tessellated_sphere(const Sphere& sphere, const TessellationOptions& options,
                                SourceSpan where, DiagnosticLog& log) {
  if (!(sphere.radius >= kMinRadius && sphere.radius <= kMaxCoordinate)) {
    log.report(Code::E2010, where,
               fmt::format("a sphere of radius {} m; from {} to {} m is accepted",
                           format_double(sphere.radius), format_double(kMinRadius),
                           format_double(kMaxCoordinate)));
    return failed;
  }
  SphereCounts counts;
  double radius = sphere.radius;
  if (sphere.counts) {
    assert(sphere.counts->rings >= 2 && sphere.counts->quads >= 3);
    counts = *sphere.counts;
  } else {
    assert(options.max_error > 0);
    // what rounding to single precision may add on top of the facets
    const double relative = options.max_error / sphere.radius - kFloatRounding * 1.01;
    if (relative <= 0) {
      log.report(Code::E2003, where,
                 fmt::format("an error of {} m cannot be kept by single-precision vertices on a "
                             "sphere of radius {} m; from {} m is accepted",
                             format_double(options.max_error), format_double(sphere.radius),
                             format_double(kFloatRounding * 1.02 * sphere.radius)));
      return failed;
    }
    counts = sphere_counts(relative);
    // balance: facets dip inside by as much as vertices stand out
    const double depth = inscribed_depth(counts.rings, counts.quads);
    radius *= 1 + depth / (2 - depth);
  }
  // note: the product of two 32-bit counts fits 64 bits, twice it may not
  const std::uint64_t half = std::uint64_t{counts.quads} * (counts.rings - 1);
  const std::uint64_t limit = std::min(options.max_triangles, kMaxVertices);
  if (half > limit / 2) {
    log.report(Code::E2003, where,
               fmt::format("a sphere of {} rings and {} quads has more than {} triangles",
                           counts.rings, counts.quads, limit));
    return failed;
  }
  const SphereBuilder builder(radius, counts, options.texcoords);
  if (builder.vertices() > kMaxVertices) {
    log.report(Code::E2003, where,
               fmt::format("a sphere of {} rings and {} quads with texture coordinates has more "
                           "than {} vertices",
                           counts.rings, counts.quads, kMaxVertices));
    return failed;
  }
  Mesh mesh = builder.build();
  mesh.error = sphere_error(mesh, sphere.radius, Vec3(0));
  return mesh;
}

}  // namespace

bool within_limits(const Mesh& mesh, const TessellationOptions& options, SourceSpan where,
                   DiagnosticLog& log) {
  const std::uint64_t limit = std::min(options.max_triangles, kMaxVertices);
  if (mesh.triangles.size() > limit) {
    log.report(Code::E2003, where,
               fmt::format("a mesh of {} triangles; at most {} are accepted", mesh.triangles.size(),
                           limit));
    return false;
  }
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3& p = mesh.positions[i];
    for (int axis = 0; axis < 3; ++axis) {
      if (std::fabs(p[axis]) <= kMaxCoordinate) continue;
      log.report(Code::E2010, where,
                 fmt::format("position {} has a coordinate of {} m; up to {} m is accepted", i,
                             format_double(p[axis]), format_double(kMaxCoordinate)));
      return false;
    }
  }
  return true;
}

namespace internal {

Problem problem(const Sphere&) { return std::nullopt; }

Result<Mesh> make(const Sphere& sphere, const TessellationOptions& options, SourceSpan where,
                  DiagnosticLog& log) {
  return tessellated_sphere(sphere, options, where, log);
}

double planned(const Sphere& sphere, const TessellationOptions& options) {
  const SphereCounts counts =
      sphere.counts ? *sphere.counts : sphere_counts(options.max_error / sphere.radius);
  return 2.0 * counts.quads * (counts.rings - 1.0);
}

std::vector<Rim> rims(const Sphere&) { return {}; }
std::uint32_t segments(const Sphere&, const TessellationOptions&) { return 0; }

}  // namespace internal

Result<Mesh> tessellated(const Shape& shape, const TessellationOptions& options, SourceSpan where,
                         DiagnosticLog& log) {
  return std::visit(
      [&](const auto& s) -> Result<Mesh> {
        if constexpr (std::is_same_v<std::decay_t<decltype(s)>, MeshShape>) {
          assert(s != nullptr);
          if (!within_limits(*s, options, where, log)) return failed;
          Mesh copy = *s;
          copy.error = rounding_error(s->positions, Vec3(0));
          return copy;
        } else {
          return internal::make(s, options, where, log);
        }
      },
      shape);
}

double planned_triangles(const Shape& shape, const TessellationOptions& options) {
  return std::visit(
      [&](const auto& s) -> double {
        if constexpr (std::is_same_v<std::decay_t<decltype(s)>, MeshShape>)
          return static_cast<double>(s->triangles.size());
        else
          return internal::planned(s, options);
      },
      shape);
}

std::vector<Rim> rims_of(const Shape& shape) {
  return std::visit(
      [](const auto& s) -> std::vector<Rim> {
        if constexpr (requires { internal::rims(s); })
          return internal::rims(s);
        else
          return {};
      },
      shape);
}

std::uint32_t segments_of(const Shape& shape, const TessellationOptions& options) {
  return std::visit(
      [&](const auto& s) -> std::uint32_t {
        if constexpr (requires { internal::segments(s, options); })
          return internal::segments(s, options);
        else
          return 0;
      },
      shape);
}

SphereCounts sphere_counts(double max_error) {
  assert(max_error > 0);
  constexpr std::uint64_t kSaturated = std::uint64_t{1} << 31;
  const double depth = std::min(1.0, 2 * max_error / (1 + max_error));
  // equal steps along both axes are the optimum of small errors; whole numbers shift it a little
  const double ideal = 0.5 * kPi / std::sqrt(depth);
  if (ideal > 1e8) return {kSaturated, kSaturated};
  const auto first = static_cast<std::uint64_t>(std::max(2.0, std::floor(0.8 * ideal) - 3));
  const auto last = static_cast<std::uint64_t>(std::ceil(1.2 * ideal) + 6);
  std::uint64_t best_rings = 0;
  std::uint64_t best_quads = 0;
  for (std::uint64_t rings = first; rings <= last; ++rings) {
    const std::uint64_t quads = fewest_quads(rings, depth);
    if (quads == 0) continue;
    if (best_rings == 0 || quads * (rings - 1) < best_quads * (best_rings - 1)) {
      best_rings = rings;
      best_quads = quads;
    }
  }
  assert(best_rings != 0);
  return {static_cast<std::uint32_t>(std::min(best_rings, kSaturated)),
          static_cast<std::uint32_t>(std::min(best_quads, kSaturated))};
}

double sphere_error(const Mesh& mesh, double radius, const Vec3& origin) {
  // the furthest point of a triangle from the centre is a corner, the nearest may lie inside
  const double outside = maximum(mesh.positions.size(), [&](std::size_t begin, std::size_t end) {
    double worst = 0;
    for (std::size_t i = begin; i < end; ++i)
      worst = std::max(worst,
                       std::fabs(glm::length(stored(mesh.positions[i], origin) + origin) - radius));
    return worst;
  });
  const double inside = maximum(mesh.triangles.size(), [&](std::size_t begin, std::size_t end) {
    double nearest = radius;
    for (std::size_t i = begin; i < end; ++i) {
      const Triangle& t = mesh.triangles[i];
      const Vec3 a = stored(mesh.positions[t[0]], origin) + origin;
      const Vec3 b = stored(mesh.positions[t[1]], origin) + origin;
      const Vec3 c = stored(mesh.positions[t[2]], origin) + origin;
      // a triangle is no nearer than its plane, and most planes are no nearer than the record
      const Vec3 n = glm::cross(b - a, c - a);
      const double height = glm::dot(n, a);
      const double bound = nearest * nearest * glm::dot(n, n);
      if (height * height > bound * (1 + 1e-12)) continue;
      nearest = std::min(nearest, glm::length(nearest_to_origin(a, b, c)));
    }
    return radius - nearest;
  });
  return std::max(outside, inside);
}

double rounding_error(std::span<const Vec3> positions, const Vec3& origin) {
  const double squared = maximum(positions.size(), [&](std::size_t begin, std::size_t end) {
    double worst = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 miss = (positions[i] - origin) - stored(positions[i], origin);
      worst = std::max(worst, glm::dot(miss, miss));
    }
    return worst;
  });
  return std::sqrt(squared);
}

}  // namespace panwright::geometry
