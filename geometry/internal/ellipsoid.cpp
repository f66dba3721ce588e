#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/text.h"
#include "geometry/internal/circle.h"
#include "geometry/internal/maximum.h"
#include "geometry/internal/profile.h"
#include "geometry/internal/revolve.h"
#include "geometry/internal/round_problem.h"
#include "geometry/internal/tessellators.h"

namespace panwright::geometry::internal {

namespace {

constexpr double kMostVertices = 4294967295.0;
// steps towards the error asked for; one or two are usual
constexpr int kIterations = 24;
// intervals of a quarter turn before halving, and how often they are halved
constexpr int kNodes = 16;
constexpr int kDepth = 40;

// A circle's parameter, stepped so that the ellipse x = a cos t, y = b sin t has chords of equal
// sag: steps go with the inverse square root of the distance between centre and tangent.
class Steps {
 public:
  Steps(double a, double b) : even_(a == b), density_(made(a, b)) {}

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

  bool even_;
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
    const double reach = glm::length(shape.radii);
    // note: vertices stand out by less than the smallest radius
    half_range_ = options.max_error - rounding_bound(1.5 * reach);
    least_error_ = rounding_bound(1.52 * reach);
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
    return g;
  }

  Mesh mesh(const Grid& grid) {
    grid_ = grid;
    columns_ = grid.quads + (options_.texcoords ? 1 : 0);
    poles_ = options_.texcoords ? grid.quads : 1;
    const std::uint64_t vertices = 2 * poles_ + (grid.rings - 1) * columns_;
    Mesh mesh;
    mesh.positions.resize(vertices);
    mesh.normals.resize(vertices);
    if (options_.texcoords) mesh.texcoords.resize(vertices);
    mesh.triangles.resize(2 * grid.quads * (grid.rings - 1));
    mesh.closed = true;
    angles(grid);
    const std::uint64_t rows = std::max<std::uint64_t>(1, kChunk / columns_);
    parallel_for((grid.rings + rows) / rows, [&](std::size_t task) {
      const std::uint64_t end = std::min(grid.rings, (task + 1) * rows - 1);
      for (std::uint64_t ring = task * rows; ring <= end; ++ring) {
        fill(mesh, ring);
        if (ring < grid.rings) join(mesh, ring);
      }
    });
    return mesh;
  }

  // No point of the mesh lies further from the ellipsoid. Points outside: corners decide, as the
  // distance to a convex body is convex. Points inside are no deeper than their facet's plane lies
  // under the tangent plane parallel to it, and no deeper than the smallest radius.
  double error(const Mesh& mesh) const {
    const Vec3& radii = shape_.radii;
    const double smallest = std::min({radii.x, radii.y, radii.z});
    const double inside = maximum(mesh.triangles.size(), [&](std::size_t begin, std::size_t end) {
      double deepest = 0;
      for (std::size_t i = begin; i < end; ++i) {
        const Triangle& t = mesh.triangles[i];
        const Vec3& a = mesh.positions[t[0]];
        const Vec3& b = mesh.positions[t[1]];
        const Vec3& c = mesh.positions[t[2]];
        Vec3 n = glm::cross(b - a, c - a);
        const double length = glm::length(n);
        if (!(length > 0)) continue;
        n /= length;
        const double height = std::max({glm::dot(n, a), glm::dot(n, b), glm::dot(n, c)});
        deepest = std::max(deepest, glm::length(radii * n) - height);
      }
      return deepest;
    });
    return std::max(furthest_, std::min(inside, smallest)) * (1 + 1e-12);
  }

 private:
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
      // a quarter turn behind, from the south pole; steps are symmetric to the equator
      const std::uint64_t n = 2 * grid.rings;
      const std::uint64_t k = (j + n - grid.rings / 2) % n;
      det::SinCos& latitude = latitudes_[j];
      if (!balanced_) {
        const det::SinCos polar = turn(j, n);
        latitude = {-polar.cos, polar.sin};
      } else if (grid.rings % 2 == 0) {
        latitude = along_.at(k, n);
      } else {
        const std::uint64_t twice = (2 * j + 2 * n - grid.rings) % (2 * n);
        latitude = along_.at(twice, 2 * n);
      }
      if (j == 0 || j == grid.rings) latitude.cos = 0;
    }
    furthest_ = balanced_ ? standing_out() : 0;
  }

  // how far vertices stand out at unit distance between centre and tangent, by row and column
  double standing_out() {
    const auto squares = [](const std::vector<det::SinCos>& a, std::size_t i, bool ring) {
      // chords to both neighbours, as 2(1 − cos step) that takes the square of the step's place
      const std::size_t n = a.size();
      const auto to = [&](std::size_t k) {
        const double x = a[i].cos - a[k].cos, y = a[i].sin - a[k].sin;
        return x * x + y * y;
      };
      if (!ring && i == 0) return to(1);
      if (!ring && i + 1 == n) return to(n - 2);
      const double before = std::sqrt(to((i + n - 1) % n)), after = std::sqrt(to((i + 1) % n));
      return 0.25 * (before + after) * (before + after);
    };
    around_step_.resize(longitudes_.size());
    along_step_.resize(latitudes_.size());
    for (std::size_t i = 0; i < longitudes_.size(); ++i)
      around_step_[i] = squares(longitudes_, i, true);
    for (std::size_t j = 0; j < latitudes_.size(); ++j)
      along_step_[j] = squares(latitudes_, j, false);
    double most = 0;
    for (std::size_t j = 0; j < latitudes_.size(); ++j)
      for (std::size_t i = 0; i < longitudes_.size(); ++i) most = std::max(most, out(i, j));
    return most;
  }

  // the point's normal, not of unit length, scaled by the smallest radius
  Vec3 normal(std::size_t i, std::size_t j) const {
    const double s = std::min({shape_.radii.x, shape_.radii.y, shape_.radii.z});
    return {latitudes_[j].cos * longitudes_[i].cos * (s / shape_.radii.x),
            latitudes_[j].cos * longitudes_[i].sin * (s / shape_.radii.y),
            latitudes_[j].sin * (s / shape_.radii.z)};
  }

  // how far a vertex stands out
  double out(std::size_t i, std::size_t j) const {
    const double s = std::min({shape_.radii.x, shape_.radii.y, shape_.radii.z});
    const double height = s / glm::length(normal(i, j));
    const double c = latitudes_[j].cos;
    return height * (c * c * around_step_[i] + along_step_[j]) / 16;
  }

  void fill(Mesh& mesh, std::uint64_t ring) const {
    const bool pole = ring == 0 || ring == grid_.rings;
    const std::uint64_t count = pole ? poles_ : columns_;
    const std::uint64_t start = start_of(ring);
    const double v = static_cast<double>(ring) / static_cast<double>(grid_.rings);
    // note: latitudes are not evenly spaced
    const double latitude = det::atan2(latitudes_[ring].sin, latitudes_[ring].cos) / kPi + 0.5;
    for (std::uint64_t k = 0; k < count; ++k) {
      const std::size_t i = pole ? 0 : k % grid_.quads;
      const Vec3 scaled = normal(i, ring);
      const Vec3 n = scaled / glm::length(scaled);
      const det::SinCos& lon = longitudes_[i];
      const det::SinCos& lat = latitudes_[ring];
      const Vec3 p = shape_.radii * Vec3(lat.cos * lon.cos, lat.cos * lon.sin, lat.sin);
      mesh.positions[start + k] = balanced_ ? p + out(i, ring) * n : p;
      mesh.normals[start + k] = n;
      if (!options_.texcoords) continue;
      const double u =
          pole ? (longitude_share(k) + longitude_share(k + 1)) / 2 : longitude_share(k);
      mesh.texcoords[start + k] = {u, balanced_ ? latitude : v};
    }
  }

  double longitude_share(std::uint64_t k) const {
    if (k == grid_.quads) return 1;
    if (!balanced_) return static_cast<double>(k) / static_cast<double>(grid_.quads);
    const double angle = det::atan2(longitudes_[k].sin, longitudes_[k].cos) / (2 * kPi);
    return angle < 0 ? angle + 1 : angle;
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
  std::vector<double> around_step_, along_step_;
  double furthest_ = 0;
};

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
        fmt::format("an error of {} m cannot be kept by single-precision vertices on an "
                    "ellipsoid of this size; from {} m is accepted",
                    format_double(options.max_error), format_double(tessellator.least_error())));
    return failed;
  }
  double target = tessellator.half_range();
  for (int i = 0;; ++i) {
    const Grid grid = tessellator.grid(target);
    const double limit = std::min(static_cast<double>(options.max_triangles), kMostVertices);
    if (!(grid.triangles() <= limit) ||
        static_cast<double>(grid.quads + 1) * static_cast<double>(grid.rings + 1) > kMostVertices) {
      log.report(Code::E2003, where,
                 fmt::format("an ellipsoid of {} rings and {} quads has more than {} triangles",
                             grid.rings, grid.quads, options.max_triangles));
      return failed;
    }
    Mesh mesh = tessellator.mesh(grid);
    const double error = tessellator.error(mesh);
    if (error <= tessellator.half_range() || !(s.counts == Counts{}) || i == kIterations) {
      set_error(mesh, error);
      return mesh;
    }
    target *= std::clamp(0.998 * tessellator.half_range() / error, 0.5, 0.998);
  }
}

double planned(const Ellipsoid& s, const TessellationOptions& options) {
  const Tessellator tessellator(s, options);
  if (tessellator.half_range() <= 0 && !tessellator.counted()) return kMostVertices;
  return tessellator.grid(tessellator.half_range()).triangles();
}

}  // namespace panwright::geometry::internal
