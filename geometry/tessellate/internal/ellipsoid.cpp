#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "base/text.h"
#include "geometry/internal/limits.h"
#include "geometry/internal/triangle.h"
#include "geometry/tessellate/internal/circle.h"
#include "geometry/tessellate/internal/maximum.h"
#include "geometry/tessellate/internal/revolution_problem.h"
#include "geometry/tessellate/internal/revolve.h"
#include "geometry/tessellate/internal/staggered.h"
#include "geometry/tessellate/internal/steps.h"
#include "geometry/tessellate/internal/tessellators.h"

namespace panwright::geometry::internal {

namespace {

// steps towards the requested error; one or two are usual
constexpr int kErrorSteps = 24;
// a little less than requested spares most meshes a second try
constexpr double kMargin = 0.998;
// where steps about the axis are uneven the plan is an estimate
constexpr double kStep = 0.99;
// triangles of a small mesh
constexpr double kSmallEllipsoid = 4096;
// a facet is examined in 4^this parts where its plane is not enough
constexpr int kHalvings = 3;

struct Grid {
  std::uint64_t quads = 0;  // segments about the axis
  std::uint64_t rings = 0;  // bands from pole to pole
  double triangles() const {
    return 2.0 * static_cast<double>(quads) * (static_cast<double>(rings) - 1);
  }
};

// How deep the points of a triangle lie under the ellipsoid at most, or less than `known`. With
// u = x/radii the depth of x is at most (1 − |u|)·|u|/|u/radii|, the way to the surface of |u| = 1
// against its gradient, as |u| is convex; both factors are bounded over the triangle, in parts
// where they differ.
double facet_depth(const Vec3& radii, const Vec3& a, const Vec3& b, const Vec3& c, double known,
                   int halvings) {
  const double unit = std::min({radii.x, radii.y, radii.z});
  const Vec3 q = unit / radii;
  const double below = 1 - glm::length(nearest_to_origin(a / radii, b / radii, c / radii));
  if (!(below > 0)) return 0;
  const double gradient =
      glm::length(nearest_to_origin(a / radii * q, b / radii * q, c / radii * q));
  const double bound = below * unit / gradient;
  if (bound <= known || halvings == 0) return bound;
  const Vec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
  double deepest = 0;
  for (const auto& [x, y, z] : {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c},
                                std::array{ab, bc, ca}})
    deepest =
        std::max(deepest, facet_depth(radii, x, y, z, std::max(known, deepest), halvings - 1));
  return deepest;
}

// No point of the mesh lies deeper under the ellipsoid; facets that lie no deeper than `enough`
// are not examined further.
double depth_of(const Mesh& mesh, const Vec3& radii, double enough) {
  const double smallest = std::min({radii.x, radii.y, radii.z});
  return maximum(mesh.triangles.size(), [&](std::size_t begin, std::size_t end) {
    double deepest = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Triangle& t = mesh.triangles[i];
      const Vec3& a = mesh.positions[t[0]];
      const Vec3& b = mesh.positions[t[1]];
      const Vec3& c = mesh.positions[t[2]];
      // no deeper than the facet's plane lies under the tangent plane parallel to it
      Vec3 n = glm::cross(b - a, c - a);
      const double length = glm::length(n);
      if (!(length > 0)) continue;
      n /= length;
      const double height = std::max({glm::dot(n, a), glm::dot(n, b), glm::dot(n, c)});
      const double plane = std::min(smallest, glm::length(radii * n) - height);
      if (plane <= deepest) continue;
      deepest =
          plane <= enough
              ? plane
              : std::max(deepest, std::min(plane, facet_depth(radii, a, b, c, deepest, kHalvings)));
    }
    return deepest;
  });
}

// What float32 leaves of the error that is asked for.
struct Room {
  Room(const Ellipsoid& s, const TessellationOptions& options) {
    const double largest = std::max({s.radii.x, s.radii.y, s.radii.z});
    const double rounding = rounding_bound(largest + std::min(largest, options.max_error));
    half_range = options.max_error - rounding;
    least_error = 1.01 * rounding;
  }
  double half_range, least_error;
};

// Explicit counts: a grid of equal steps of the parameters, with vertices on the shape.
class GridBuilder {
 public:
  GridBuilder(const Ellipsoid& shape, const TessellationOptions& options)
      : shape_(shape), options_(options), grid_(grid(shape, Room(shape, options).half_range)) {}

  const Grid& grid() const { return grid_; }

  Mesh build() {
    columns_ = grid_.quads + (options_.texcoords ? 1 : 0);
    poles_ = options_.texcoords ? grid_.quads : 1;
    const std::uint64_t vertices = 2 * poles_ + (grid_.rings - 1) * columns_;
    Mesh mesh;
    mesh.positions.resize(vertices);
    mesh.normals.resize(vertices);
    if (options_.texcoords) mesh.texcoords.resize(vertices);
    mesh.triangles.resize(2 * grid_.quads * (grid_.rings - 1));
    mesh.closed = true;
    angles();
    const std::uint64_t rows = std::max<std::uint64_t>(1, kChunk / columns_);
    parallel_for((grid_.rings + rows) / rows, [&](std::size_t task) {
      const std::uint64_t end = std::min(grid_.rings, (task + 1) * rows - 1);
      for (std::uint64_t ring = task * rows; ring <= end; ++ring) {
        fill(mesh, ring);
        if (ring < grid_.rings) join(mesh, ring);
      }
    });
    return mesh;
  }

 private:
  // A count that is not given is what the error needs. The patch at (u, v) with steps du, dv bends
  // by h (cos²v du² + dv²)/8, h the distance between the centre and the tangent plane there; equal
  // shares for both are the fewest.
  static Grid grid(const Ellipsoid& s, double half_range) {
    const Steps around(s.radii.x, s.radii.y, Steps::Kind::chords);
    // the longer of the two meridians needs the shorter steps
    const Steps along(std::max(s.radii.x, s.radii.y), s.radii.z, Steps::Kind::chords);
    const double step = std::sqrt(4 * half_range);
    Grid g;
    g.quads = chosen(s.counts.around, around.integral() / step, 3);
    g.rings = chosen(s.counts.along, 0.5 * along.integral() / step, 2);
    // sharp ends get a vertex
    if (s.counts.around == 0 && around.sharp()) g.quads += g.quads % 2;
    if (s.counts.along == 0 && along.sharp()) g.rings += g.rings % 2;
    return g;
  }

  static std::uint64_t chosen(std::uint32_t given, double needed, double least) {
    if (given != 0) return given;
    return static_cast<std::uint64_t>(std::clamp(std::ceil(needed), least, kMostVertices));
  }

  void angles() {
    longitudes_.resize(grid_.quads);
    for (std::uint64_t i = 0; i < grid_.quads; ++i) longitudes_[i] = turn(i, grid_.quads);
    latitudes_.resize(grid_.rings + 1);
    for (std::uint64_t j = 0; j <= grid_.rings; ++j) {
      const det::SinCos polar = turn(j, 2 * grid_.rings);
      latitudes_[j] = {-polar.cos, j == 0 || j == grid_.rings ? 0 : polar.sin};
    }
    if (!options_.texcoords) return;
    u_.resize(grid_.quads + 1);
    for (std::uint64_t i = 0; i < grid_.quads; ++i) {
      const double share = det::atan2(longitudes_[i].sin, longitudes_[i].cos) / (2 * kPi);
      u_[i] = share < 0 ? share + 1 : share;
    }
    u_.back() = 1;
  }

  // the point's normal, not of unit length, scaled by the smallest radius
  Vec3 normal(std::size_t i, std::size_t j) const {
    const double s = std::min({shape_.radii.x, shape_.radii.y, shape_.radii.z});
    return {latitudes_[j].cos * longitudes_[i].cos * (s / shape_.radii.x),
            latitudes_[j].cos * longitudes_[i].sin * (s / shape_.radii.y),
            latitudes_[j].sin * (s / shape_.radii.z)};
  }

  // the vertices of a ring
  void fill(Mesh& mesh, std::uint64_t ring) const {
    const bool pole = ring == 0 || ring == grid_.rings;
    const std::uint64_t count = pole ? poles_ : columns_;
    const std::uint64_t start = start_of(ring);
    const double v = det::atan2(latitudes_[ring].sin, latitudes_[ring].cos) / kPi + 0.5;
    for (std::uint64_t k = 0; k < count; ++k) {
      const std::size_t i = pole ? 0 : k % grid_.quads;
      const Vec3 scaled = normal(i, ring);
      const det::SinCos& lon = longitudes_[i];
      const det::SinCos& lat = latitudes_[ring];
      mesh.positions[start + k] =
          shape_.radii * Vec3(lat.cos * lon.cos, lat.cos * lon.sin, lat.sin);
      mesh.normals[start + k] = scaled / glm::length(scaled);
      if (!options_.texcoords) continue;
      mesh.texcoords[start + k] = {pole ? 0.5 * (u_[k] + u_[k + 1]) : u_[k], v};
    }
  }

  std::uint64_t start_of(std::uint64_t ring) const {
    return ring == 0 ? 0 : poles_ + (ring - 1) * columns_;
  }

  void join(Mesh& mesh, std::uint64_t ring) const {
    const std::uint64_t quads = grid_.quads;
    const std::uint64_t low = start_of(ring), high = start_of(ring + 1);
    Triangle* out = mesh.triangles.data() + (ring == 0 ? 0 : quads + 2 * quads * (ring - 1));
    const auto triangle = [](std::uint64_t a, std::uint64_t b, std::uint64_t c) {
      return Triangle{static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                      static_cast<std::uint32_t>(c)};
    };
    for (std::uint64_t i = 0; i < quads; ++i) {
      const std::uint64_t next = i + 1 < columns_ ? i + 1 : 0;
      const std::uint64_t pole = poles_ > 1 ? i : 0;
      if (ring == 0) {
        *out++ = triangle(low + pole, high + next, high + i);
      } else if (ring + 1 == grid_.rings) {
        *out++ = triangle(low + i, low + next, high + pole);
      } else {
        *out++ = triangle(low + i, low + next, high + next);
        *out++ = triangle(low + i, high + next, high + i);
      }
    }
  }

  const Ellipsoid& shape_;
  const TessellationOptions& options_;
  Grid grid_;
  std::uint64_t columns_ = 0, poles_ = 0;
  std::vector<det::SinCos> longitudes_, latitudes_;
  std::vector<double> u_;  // texture, by column
};

// The axis about which rings of vertices lie: with texture coordinates z, else that whose rings are
// the roundest, where equal steps about it are equally good all over.
int polar_axis(const Ellipsoid& s, bool texcoords) {
  if (texcoords) return 2;
  int best = 2;
  double least = 0;
  for (const int axis : {2, 0, 1}) {
    const double a = s.radii[(axis + 1) % 3], b = s.radii[(axis + 2) % 3];
    const double ratio = std::max(a, b) / std::min(a, b);
    if (axis == 2 || ratio < least) {
      best = axis;
      least = ratio;
    }
  }
  return best;
}

bool has_counts(const Ellipsoid& s) { return s.counts.around != 0 && s.counts.along != 0; }

double most_triangles(const TessellationOptions& options) {
  return std::min(static_cast<double>(options.max_triangles), kMostVertices);
}

// Staggered rings without explicit counts.
class Free {
 public:
  Free(const Ellipsoid& s, const TessellationOptions& options)
      : options_(options),
        radii_(s.radii),
        axis_(polar_axis(s, options.texcoords)),
        local_(s.radii[(axis_ + 1) % 3], s.radii[(axis_ + 2) % 3], s.radii[axis_]),
        around_(local_.x, local_.y, Steps::Kind::staggered) {}

  // Below this many triangles a plan makes the mesh: whole numbers matter, and where steps about
  // the axis differ much plans are rough.
  double small() const { return around_.sharp() ? 64 * kSmallEllipsoid : kSmallEllipsoid; }

  // the share of the error that is planned for first
  double margin() const { return around_.even() ? kMargin : kStep; }

  std::optional<Staggered> plan(double half_range) const {
    return staggered(local_, around_, half_range, options_.texcoords, most_triangles(options_));
  }

  // The mesh, with its error in exact arithmetic.
  Mesh mesh(const Staggered& plan, double half_range) const {
    Mesh mesh = staggered_mesh(plan, {.radii = local_, .out = plan.out, .polar_axis = axis_},
                               around_, options_.texcoords);
    // points outside: no vertex is further, and the distance to a convex body is convex
    mesh.error = std::max(plan.out, depth_of(mesh, radii_, half_range)) * (1 + 1e-12);
    return mesh;
  }

 private:
  const TessellationOptions& options_;
  Vec3 radii_;
  int axis_;
  Vec3 local_;  // radii, the polar axis last
  Steps around_;
};

// The mesh, with its error, or nothing where it has too many triangles.
std::optional<Mesh> made_ellipsoid(const Ellipsoid& s, const TessellationOptions& options) {
  if (!(s.counts == Counts{})) {
    GridBuilder builder(s, options);
    const Grid& grid = builder.grid();
    if (!(grid.triangles() <= most_triangles(options)) ||
        static_cast<double>(grid.quads + 1) * static_cast<double>(grid.rings + 1) > kMostVertices)
      return std::nullopt;
    Mesh mesh = builder.build();
    set_error(mesh, depth_of(mesh, s.radii, 0) * (1 + 1e-12));
    return mesh;
  }
  const Free free(s, options);
  const double half_range = Room(s, options).half_range;
  double target = free.margin() * half_range;
  for (int i = 0;; ++i) {
    const std::optional<Staggered> plan = free.plan(target);
    if (!plan || plan->vertices > kMostVertices) return std::nullopt;
    Mesh mesh = free.mesh(*plan, half_range);
    if (mesh.error <= half_range || i == kErrorSteps) {
      set_error(mesh, mesh.error);
      return mesh;
    }
    target *= std::clamp(kMargin * half_range / mesh.error, 0.5, kStep);
  }
}

}  // namespace

Problem problem(const Ellipsoid& s) {
  for (int axis = 0; axis < 3; ++axis)
    if (auto p = size_problem(s.radii[axis], "radii", "a radius")) return p;
  return counts_problem(s.counts, {}, 2);
}

Result<Mesh> make(const Ellipsoid& s, const TessellationOptions& options, SourceSpan where,
                  DiagnosticLog& log) {
  if (const Problem p = problem(s)) {
    log.report(p->code, where, p->message);
    return failed;
  }
  const Room room(s, options);
  if (room.half_range <= 0 && !has_counts(s)) {
    log.report(
        Code("E2003"), where,
        fmt::format("an error of {} m cannot be achieved with single-precision vertices on an "
                    "ellipsoid of this size, expected at least {} m",
                    format_double(options.max_error), format_double(room.least_error)));
    return failed;
  }
  std::optional<Mesh> mesh = made_ellipsoid(s, options);
  if (mesh) return std::move(*mesh);
  log.report(Code("E2003"), where,
             fmt::format("an ellipsoid with an error of {} m needs more than {} triangles",
                         format_double(options.max_error), options.max_triangles));
  return failed;
}

double planned(const Ellipsoid& s, const TessellationOptions& options) {
  const double half_range = Room(s, options).half_range;
  if (half_range <= 0 && !has_counts(s)) return kMostVertices;
  TessellationOptions unlimited = options;
  unlimited.max_triangles = std::uint64_t{1} << 32;
  if (!(s.counts == Counts{})) return GridBuilder(s, unlimited).grid().triangles();
  const Free free(s, unlimited);
  const std::optional<Staggered> plan = free.plan(free.margin() * half_range);
  if (!plan) return kMostVertices;
  if (plan->triangles > free.small()) return plan->triangles;
  const std::optional<Mesh> mesh = made_ellipsoid(s, unlimited);
  return mesh ? static_cast<double>(mesh->triangles.size()) : kMostVertices;
}

}  // namespace panwright::geometry::internal
