#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "base/text.h"
#include "geometry/internal/triangle.h"
#include "geometry/tessellate/internal/circle.h"
#include "geometry/tessellate/internal/maximum.h"
#include "geometry/tessellate/internal/profile.h"
#include "geometry/tessellate/internal/revolution_problem.h"
#include "geometry/tessellate/internal/revolve.h"
#include "geometry/tessellate/internal/tessellators.h"

namespace panwright::geometry::internal {

namespace {

constexpr double kMostVertices = 4294967295.0;
// steps towards the requested error; one or two are usual
constexpr int kIterations = 24;
// a little less than requested spares most meshes a second try
constexpr double kMargin = 0.998;
// below this many triangles a plan makes the mesh, as whole numbers matter then
constexpr double kSmall = 4096;
// intervals of a quarter turn before halving, and how often they are halved
constexpr int kNodes = 16;
constexpr int kDepth = 40;
// a facet is examined in 4^this parts where its plane is not enough
constexpr int kHalvings = 3;

// A circle's parameter, stepped so that the ellipse x = a cos t, y = b sin t has chords of equal
// sag: steps go with the inverse square root of the distance between centre and tangent.
class Steps {
 public:
  Steps(double a, double b)
      : even_(a == b), sharp_(std::max(a, b) > 3 * std::min(a, b)), density_(made(a, b)) {}

  bool sharp() const { return sharp_; }

  // of a whole turn: turn over count is the step
  double integral() const { return 4 * density_.total(); }

  // cos and sin at k of n steps of a whole turn, symmetric to the last bit
  det::SinCos at(std::uint64_t k, std::uint64_t n) const {
    if (even_) return turn(k, n);
    std::uint64_t num = 4 * k;
    const bool lower = num > 2 * n;
    if (lower) num = 4 * n - num;
    const bool left = num > n;
    if (left) num = 2 * n - num;
    det::SinCos r{0, 1};
    if (num == n)
      r = {1, 0};
    else if (num > 0)
      r = det::sincos(density_.place(static_cast<double>(num) / static_cast<double>(n)));
    if (left) r.cos = -r.cos;
    if (lower) r.sin = -r.sin;
    return r;
  }

 private:
  static Density made(double a, double b) {
    // of the distance between the centre and the tangent, relative to the longer one
    const double unit = std::max(a, b);
    const double ra = unit / a, rb = unit / b;
    const auto value = [&](double t) {
      const det::SinCos s = det::sincos(t);
      return std::sqrt(unit / std::hypot(s.cos * ra, s.sin * rb));
    };
    std::vector<double> t{0}, v{value(0)};
    struct Span {
      double end, value;
      int depth;
    };
    std::vector<Span> todo;
    for (int i = 1; i <= kNodes; ++i) {
      const double end = 0.5 * kPi * (static_cast<double>(i) / kNodes);
      todo.push_back({end, value(end), 0});
      while (!todo.empty()) {
        const Span span = todo.back();
        const double middle = 0.5 * (t.back() + span.end);
        const double mid = value(middle);
        if (span.depth < kDepth && std::fabs(mid - 0.5 * (v.back() + span.value)) > 0.01 * mid) {
          todo.back().depth = span.depth + 1;
          todo.push_back({middle, mid, span.depth + 1});
          continue;
        }
        todo.pop_back();
        t.push_back(span.end);
        v.push_back(span.value);
      }
    }
    return {std::move(t), std::move(v)};
  }

  bool even_, sharp_;
  Density density_;
};

struct Grid {
  std::uint64_t quads = 0;  // segments about the axis
  std::uint64_t rings = 0;  // bands from pole to pole
  double triangles() const {
    return 2.0 * static_cast<double>(quads) * (static_cast<double>(rings) - 1);
  }
};

class Tessellator {
 public:
  Tessellator(const Ellipsoid& shape, const TessellationOptions& options)
      : shape_(shape),
        options_(options),
        balanced_(shape.counts == Counts{}),
        around_(shape.radii.x, shape.radii.y),
        // the longer of the two meridians needs the shorter steps
        along_(std::max(shape.radii.x, shape.radii.y), shape.radii.z) {
    const double largest = std::max({shape.radii.x, shape.radii.y, shape.radii.z});
    const double rounding = rounding_bound(largest + std::min(largest, options.max_error));
    half_range_ = options.max_error - rounding;
    least_error_ = 1.01 * rounding;
  }

  double half_range() const { return half_range_; }
  double least_error() const { return least_error_; }
  bool counted() const { return shape_.counts.around != 0 && shape_.counts.along != 0; }

  // The patch at (u, v) with steps du, dv bends by h (cos²v du² + dv²)/8, h the distance between
  // the centre and the tangent plane there; steps that go with 1/sqrt(h) bend everywhere alike.
  // Equal shares for both are the fewest.
  Grid grid(double half_range) const {
    const double sag = (balanced_ ? 1 : 0.5) * half_range;
    const double step = std::sqrt(8 * sag);
    Grid g;
    g.quads = chosen(shape_.counts.around, around_.integral() / step, 3);
    g.rings = chosen(shape_.counts.along, 0.5 * along_.integral() / step, 2);
    // sharp ends get a vertex
    if (shape_.counts.around == 0 && around_.sharp()) g.quads += g.quads % 2;
    if (shape_.counts.along == 0 && along_.sharp()) g.rings += g.rings % 2;
    return g;
  }

  void make(const Grid& grid, Mesh& mesh) {
    grid_ = grid;
    columns_ = grid.quads + (options_.texcoords ? 1 : 0);
    poles_ = options_.texcoords ? grid.quads : 1;
    const std::uint64_t vertices = 2 * poles_ + (grid.rings - 1) * columns_;
    mesh.positions.resize(vertices);
    mesh.normals.resize(vertices);
    if (options_.texcoords) mesh.texcoords.resize(vertices);
    mesh.triangles.resize(2 * grid.quads * (grid.rings - 1));
    mesh.closed = true;
    angles(grid);
    std::vector<double> furthest(grid.rings + 1);
    const std::uint64_t rows = std::max<std::uint64_t>(1, kChunk / columns_);
    parallel_for((grid.rings + rows) / rows, [&](std::size_t task) {
      const std::uint64_t end = std::min(grid.rings, (task + 1) * rows - 1);
      for (std::uint64_t ring = task * rows; ring <= end; ++ring) {
        furthest[ring] = fill(mesh, ring);
        if (ring < grid.rings) join(mesh, ring);
      }
    });
    furthest_ = *std::max_element(furthest.begin(), furthest.end());
  }

  // No point of the mesh lies further from the ellipsoid. Points outside: corners decide, as the
  // distance to a convex body is convex. Points inside: see depth().
  double error(const Mesh& mesh) const {
    const double enough = balanced_ ? half_range_ : 0;
    const Vec3& radii = shape_.radii;
    const double smallest = std::min({radii.x, radii.y, radii.z});
    const double inside = maximum(mesh.triangles.size(), [&](std::size_t begin, std::size_t end) {
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
        deepest = plane <= enough
                      ? plane
                      : std::max(deepest, std::min(plane, depth(a, b, c, deepest, kHalvings)));
      }
      return deepest;
    });
    return std::max(furthest_, inside) * (1 + 1e-12);
  }

 private:
  // How deep the points of a triangle lie at most, or less than `known`. With u = x/radii the depth
  // of x is at most (1 − |u|)·|u|/|u/radii|, the way to the surface of |u| = 1 against its
  // gradient, as |u| is convex; both factors are bounded over the triangle, in parts where they
  // differ.
  double depth(const Vec3& a, const Vec3& b, const Vec3& c, double known, int halvings) const {
    const Vec3& r = shape_.radii;
    const double unit = std::min({r.x, r.y, r.z});
    const Vec3 q = unit / r;
    const double below = 1 - glm::length(nearest_to_origin(a / r, b / r, c / r));
    if (!(below > 0)) return 0;
    const double gradient = glm::length(nearest_to_origin(a / r * q, b / r * q, c / r * q));
    const double bound = below * unit / gradient;
    if (bound <= known || halvings == 0) return bound;
    const Vec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
    double deepest = 0;
    for (const auto& [x, y, z] : {std::array{a, ab, ca}, std::array{ab, b, bc},
                                  std::array{ca, bc, c}, std::array{ab, bc, ca}})
      deepest = std::max(deepest, depth(x, y, z, std::max(known, deepest), halvings - 1));
    return deepest;
  }

  static std::uint64_t chosen(std::uint32_t given, double needed, double least) {
    if (given != 0) return given;
    return static_cast<std::uint64_t>(std::clamp(std::ceil(needed), least, kMostVertices));
  }

  void angles(const Grid& grid) {
    // explicit counts: equal steps of the parameters
    longitudes_.resize(grid.quads);
    for (std::uint64_t i = 0; i < grid.quads; ++i)
      longitudes_[i] = balanced_ ? around_.at(i, grid.quads) : turn(i, grid.quads);
    latitudes_.resize(grid.rings + 1);
    for (std::uint64_t j = 0; j <= grid.rings; ++j) {
      det::SinCos& latitude = latitudes_[j];
      if (balanced_) {
        // a quarter turn behind, from the south pole
        latitude = along_.at((2 * j + 3 * grid.rings) % (4 * grid.rings), 4 * grid.rings);
      } else {
        const det::SinCos polar = turn(j, 2 * grid.rings);
        latitude = {-polar.cos, polar.sin};
      }
      if (j == 0 || j == grid.rings) latitude.cos = 0;
    }
    const Vec3& radii = shape_.radii;
    around_step_ = squares(longitudes_, radii.x, radii.y, true);
    along_step_ = squares(latitudes_, std::max(radii.x, radii.y), radii.z, false);
    if (!options_.texcoords) return;
    u_.resize(grid.quads + 1);
    for (std::uint64_t i = 0; i < grid.quads; ++i) {
      const double share = det::atan2(longitudes_[i].sin, longitudes_[i].cos) / (2 * kPi);
      u_[i] = share < 0 ? share + 1 : share;
    }
    u_.back() = 1;
  }

  // For vertices of the ellipse x = a cos t, y = b sin t: eight times the mean sag of their chords
  // over the distance between centre and tangent, which is step² where that distance changes
  // little. A chord's deepest point is at its middle parameter, as on the circle that the ellipse
  // is an image of.
  static std::vector<double> squares(const std::vector<det::SinCos>& t, double a, double b,
                                     bool ring) {
    const double unit = std::max(a, b);
    const double ra = unit / a, rb = unit / b;
    const std::size_t n = t.size();
    const auto tangent = [&](double x, double y) {
      return std::hypot(x, y) / std::hypot(x * ra, y * rb);
    };
    const auto sag = [&](std::size_t i) {
      const det::SinCos& p = t[i];
      const det::SinCos& q = t[i + 1 < n ? i + 1 : 0];
      const double x = p.cos + q.cos, y = p.sin + q.sin;
      const double dx = p.cos - q.cos, dy = p.sin - q.sin;
      const double chord = dx * dx + dy * dy;
      // 1 − cos of half the step
      const double depth = 0.25 * chord / (1 + std::sqrt(std::max(0.0, 1 - 0.25 * chord)));
      return depth * (x == 0 && y == 0 ? 1 : tangent(x, y));
    };
    std::vector<double> result(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double before = i > 0 ? sag(i - 1) : ring ? sag(n - 1) : sag(0);
      const double after = ring || i + 1 < n ? sag(i) : before;
      result[i] = 4 * (before + after) / tangent(t[i].cos, t[i].sin);
    }
    return result;
  }

  // the point's normal, not of unit length, scaled by the smallest radius
  Vec3 normal(std::size_t i, std::size_t j) const {
    const double s = std::min({shape_.radii.x, shape_.radii.y, shape_.radii.z});
    return {latitudes_[j].cos * longitudes_[i].cos * (s / shape_.radii.x),
            latitudes_[j].cos * longitudes_[i].sin * (s / shape_.radii.y),
            latitudes_[j].sin * (s / shape_.radii.z)};
  }

  // the vertices of a ring; returns how far they stand out
  double fill(Mesh& mesh, std::uint64_t ring) const {
    const Vec3& radii = shape_.radii;
    const double smallest = std::min({radii.x, radii.y, radii.z});
    double furthest = 0;
    const bool pole = ring == 0 || ring == grid_.rings;
    const std::uint64_t count = pole ? poles_ : columns_;
    const std::uint64_t start = start_of(ring);
    const double v = det::atan2(latitudes_[ring].sin, latitudes_[ring].cos) / kPi + 0.5;
    for (std::uint64_t k = 0; k < count; ++k) {
      const std::size_t i = pole ? 0 : k % grid_.quads;
      const Vec3 scaled = normal(i, ring);
      const double length = glm::length(scaled);
      const Vec3 n = scaled / length;
      const det::SinCos& lon = longitudes_[i];
      const det::SinCos& lat = latitudes_[ring];
      const Vec3 p = radii * Vec3(lat.cos * lon.cos, lat.cos * lon.sin, lat.sin);
      // half of how far chords sag, both ways together
      const double out =
          balanced_
              ? smallest / length * (lat.cos * lat.cos * around_step_[i] + along_step_[ring]) / 16
              : 0;
      furthest = std::max(furthest, out);
      mesh.positions[start + k] = p + out * n;
      mesh.normals[start + k] = n;
      if (!options_.texcoords) continue;
      mesh.texcoords[start + k] = {pole ? 0.5 * (u_[k] + u_[k + 1]) : u_[k], v};
    }
    return furthest;
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
  bool balanced_;
  Steps around_, along_;
  double half_range_ = 0, least_error_ = 0;
  Grid grid_;
  std::uint64_t columns_ = 0, poles_ = 0;
  std::vector<det::SinCos> longitudes_, latitudes_;
  std::vector<double> around_step_, along_step_;  // squares of steps
  std::vector<double> u_;                         // texture, by column
  double furthest_ = 0;
};

// The mesh, with its error, or nothing where it has too many triangles.
std::optional<Mesh> made(const Ellipsoid& s, const TessellationOptions& options,
                         Tessellator& tessellator) {
  const double most = std::min(static_cast<double>(options.max_triangles), kMostVertices);
  double target = kMargin * tessellator.half_range();
  Mesh mesh;
  for (int i = 0;; ++i) {
    const Grid grid = tessellator.grid(target);
    if (!(grid.triangles() <= most) ||
        static_cast<double>(grid.quads + 1) * static_cast<double>(grid.rings + 1) > kMostVertices)
      return std::nullopt;
    tessellator.make(grid, mesh);
    const double error = tessellator.error(mesh);
    if (error <= tessellator.half_range() || !(s.counts == Counts{}) || i == kIterations) {
      set_error(mesh, error);
      return mesh;
    }
    target *= std::clamp(kMargin * tessellator.half_range() / error, 0.5, kMargin);
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
  Tessellator tessellator(s, options);
  if (tessellator.half_range() <= 0 && !tessellator.counted()) {
    log.report(
        Code::E2003, where,
        fmt::format("an error of {} m cannot be achieved with single-precision vertices on an "
                    "ellipsoid of this size, expected at least {} m",
                    format_double(options.max_error), format_double(tessellator.least_error())));
    return failed;
  }
  std::optional<Mesh> mesh = made(s, options, tessellator);
  if (mesh) return std::move(*mesh);
  log.report(Code::E2003, where,
             fmt::format("an ellipsoid with an error of {} m needs more than {} triangles",
                         format_double(options.max_error), options.max_triangles));
  return failed;
}

double planned(const Ellipsoid& s, const TessellationOptions& options) {
  Tessellator tessellator(s, options);
  if (tessellator.half_range() <= 0 && !tessellator.counted()) return kMostVertices;
  const double triangles = tessellator.grid(kMargin * tessellator.half_range()).triangles();
  if (triangles > kSmall) return triangles;
  TessellationOptions plain = options;
  plain.texcoords = false;
  plain.max_triangles = std::uint64_t{1} << 32;
  Tessellator small(s, plain);
  const std::optional<Mesh> mesh = made(s, plain, small);
  return mesh ? static_cast<double>(mesh->triangles.size()) : kMostVertices;
}

}  // namespace panwright::geometry::internal
