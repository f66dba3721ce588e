#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/text.h"
#include "geometry/internal/triangle.h"
#include "geometry/internal/weld.h"
#include "geometry/tessellate/internal/flat.h"
#include "geometry/tessellate/internal/revolution_problem.h"
#include "geometry/tessellate/internal/revolve.h"

namespace panwright::geometry::internal {

namespace {

// a bevel may be more than half a side by what rounding does to both numbers
constexpr double kSlack = 1e-12;
// From this many steps on the error of a corner is that of so many, times the square of the ratio.
constexpr std::uint32_t kMeasuredSteps = 128;
// The product with the square of the steps still grows, from 0.4101 to π²/24.
constexpr double kScalingSlack = 1.003;
constexpr double kMostSteps = 1e8;

// The vertices of a rounded corner: the eighth of a sphere of radius 1 with x, y, z ≥ 0, in rings
// about z. Its corners lie on the flat faces; the other vertices stand out so far that facets dip
// inside as much.
class Corner {
 public:
  explicit Corner(std::uint32_t steps) : steps_(steps), sine_(steps + 1) {
    // The first chord spans this much more than the others: the error is then the same in the
    // middle of a corner as next to its exact vertices, to 5 % from 5 steps on.
    const double first = 1.1;
    const double step = 0.5 * kPi / (steps - 2 + 2 * first);
    sine_.front() = 0;
    sine_.back() = 1;
    for (std::uint32_t i = 1; 2 * i <= steps; ++i) {
      const det::SinCos angle = 2 * i == steps ? det::SinCos{std::sqrt(0.5), std::sqrt(0.5)}
                                               : det::sincos((first + (i - 1)) * step);
      sine_[i] = angle.sin;
      sine_[steps - i] = angle.cos;
    }
  }

  static std::size_t index(std::uint32_t ring, std::uint32_t i) {
    return std::size_t{ring} * (ring + 1) / 2 + i;
  }
  std::size_t size() const { return index(steps_ + 1, 0); }
  std::size_t axis_index(int axis) const {
    return axis == 2 ? 0 : index(steps_, axis == 0 ? 0 : steps_);
  }
  // step i of the arc about an axis, from the next axis to the one after
  std::size_t arc_index(int axis, std::uint32_t i) const {
    if (axis == 2) return index(steps_, i);
    return axis == 0 ? index(steps_ - i, steps_ - i) : index(i, 0);
  }

  // The arcs at the sides go on inside: each direction has one of their sines for each axis.
  std::vector<Vec3> directions() const {
    std::vector<Vec3> list;
    list.reserve(size());
    for (std::uint32_t ring = 0; ring <= steps_; ++ring) {
      for (std::uint32_t i = 0; i <= ring; ++i) {
        const Vec3 d(sine_[ring - i], sine_[i], sine_[steps_ - ring]);
        list.push_back(d / glm::length(d));
      }
    }
    return list;
  }

  // body(a, b, c) for each triangle, counter-clockwise seen from outside
  template <class Body>
  void for_each_triangle(const Body& body) const {
    for (std::uint32_t ring = 0; ring < steps_; ++ring) {
      for (std::uint32_t i = 0; i <= ring; ++i) {
        body(index(ring, i), index(ring + 1, i), index(ring + 1, i + 1));
        if (i < ring) body(index(ring, i), index(ring + 1, i + 1), index(ring, i + 1));
      }
    }
  }

 private:
  std::uint32_t steps_;
  std::vector<double> sine_;  // of the angles of the arcs
};

struct Roundness {
  double factor;  // on the radius, for vertices that are not on a flat face
  double error;   // of the surface, for radius 1
};

Roundness measured_roundness(std::uint32_t steps) {
  const Corner corner(steps);
  std::vector<Vec3> p = corner.directions();
  const auto exact = [&](std::size_t i) {
    return i == corner.axis_index(0) || i == corner.axis_index(1) || i == corner.axis_index(2);
  };
  double nearest = 1;
  double nearest_moved = 1;  // of triangles of which no corner is exact
  const auto measure_all = [&] {
    nearest = nearest_moved = 1;
    corner.for_each_triangle([&](std::size_t a, std::size_t b, std::size_t c) {
      const double d = glm::length(nearest_to_origin(p[a], p[b], p[c]));
      nearest = std::min(nearest, d);
      if (!exact(a) && !exact(b) && !exact(c)) nearest_moved = std::min(nearest_moved, d);
    });
  };
  measure_all();
  if (steps == 1) return {1, 1 - nearest};
  // two steps have one triangle without an exact corner; it decides nothing there
  const double factor = 2 / (1 + nearest_moved);
  for (std::size_t i = 0; i < p.size(); ++i)
    if (!exact(i)) p[i] *= factor;
  measure_all();
  return {factor, std::max(factor - 1, 1 - nearest)};
}

// that of kMeasuredSteps
const Roundness& known_roundness() {
  static const Roundness known = measured_roundness(kMeasuredSteps);
  return known;
}

Roundness roundness(std::uint32_t steps) {
  if (steps <= kMeasuredSteps) return measured_roundness(steps);
  const Roundness& known = known_roundness();
  const double ratio = static_cast<double>(kMeasuredSteps) / steps;
  const double scale = ratio * ratio * kScalingSlack;
  return {1 + (known.factor - 1) * scale, known.error * scale};
}

struct Plan {
  double steps = 0;  // of an arc; 0: sharp, and kMostSteps: more than can be made
  Roundness round{1, 0};
  bool too_fine = false;
};

double bevel_of(const Box& box) {
  return std::min(box.bevel, 0.5 * std::min({box.size.x, box.size.y, box.size.z}));
}

Plan box_plan(const Box& box, const TessellationOptions& options) {
  if (bevel_of(box) == 0) return {};
  if (!box.round) return {1, {1, 0}};
  const double reach = 0.5 * glm::length(box.size) + std::min(options.max_error, bevel_of(box));
  const double allowed = (options.max_error - rounding_bound(reach)) / bevel_of(box);
  if (!(allowed > 0)) return {kMostSteps, {}, true};
  const double guess = kMeasuredSteps * std::sqrt(known_roundness().error / allowed);
  if (!(guess < kMostSteps)) return {kMostSteps, {}};
  auto steps = std::max(1u, static_cast<std::uint32_t>(guess));
  while (roundness(steps).error > allowed) ++steps;
  while (steps > 1 && roundness(steps - 1).error <= allowed) --steps;
  return {static_cast<double>(steps), roundness(steps)};
}

// half sides without the bevel
Vec3 inner_of(const Box& box) {
  const double bevel = bevel_of(box);
  const auto inner = [&](double size) {
    const double rest = 0.5 * size - bevel;
    return rest > kSlack * size ? rest : 0.0;
  };
  return {inner(box.size.x), inner(box.size.y), inner(box.size.z)};
}

double triangle_count(const Box& box, double steps) {
  const Vec3 inner = inner_of(box);
  double count = 8 * steps * steps;
  for (int axis = 0; axis < 3; ++axis) {
    if (steps > 0 && inner[axis] > 0) count += 8 * steps;
    if (inner[(axis + 1) % 3] > 0 && inner[(axis + 2) % 3] > 0) count += 4;
  }
  return count;
}

class BoxBuilder {
 public:
  BoxBuilder(const Box& box, const Plan& plan, bool texcoords)
      : half_(0.5 * box.size),
        inner_(inner_of(box)),
        steps_(static_cast<std::uint32_t>(plan.steps)),
        corner_(std::max(1u, steps_)),
        directions_(corner_.directions()),
        radius_(bevel_of(box) * plan.round.factor),
        smooth_(box.round && steps_ > 0),
        texcoords_(texcoords) {
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 size = box.size;
      area_[axis] = size[(axis + 1) % 3] * size[(axis + 2) % 3];
    }
  }

  Mesh build() {
    if (shared())
      for (int octant = 0; octant < 8; ++octant)
        for (std::size_t i = 0; i < directions_.size(); ++i) add(octant, i, 0, Vec3(0));
    for (int axis = 0; axis < 3; ++axis) {
      face(axis, 1);
      face(axis, -1);
    }
    if (steps_ > 0) {
      for (int axis = 0; axis < 3; ++axis)
        for (const int sides : {0, 1, 2, 3}) edge(axis, sides & 1 ? -1 : 1, sides & 2 ? -1 : 1);
      for (int octant = 0; octant < 8; ++octant) corner(octant);
    }
    if (shared() && (inner_.x == 0 || inner_.y == 0 || inner_.z == 0)) weld();
    mesh_.closed = true;
    return std::move(mesh_);
  }

 private:
  // one vertex for each place: nothing tells the faces apart that meet there
  bool shared() const { return smooth_ && !texcoords_; }
  static double sign(int octant, int axis) { return octant >> axis & 1 ? -1 : 1; }

  Vec3 position(int octant, std::size_t i) const {
    const Vec3& d = directions_[i];
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) {
      const double out = d[axis] == 1 ? half_[axis] : inner_[axis] + radius_ * d[axis];
      p[axis] = sign(octant, axis) * out;
    }
    return p;
  }

  std::uint32_t add(int octant, std::size_t i, int face, const Vec3& flat_normal) {
    const Vec3 p = position(octant, i);
    const Vec3& d = directions_[i];
    const Vec3 round_normal(sign(octant, 0) * d.x, sign(octant, 1) * d.y, sign(octant, 2) * d.z);
    mesh_.positions.push_back(p);
    mesh_.normals.push_back(smooth_ ? round_normal : flat_normal);
    if (texcoords_) {
      Vec3 outward(0);
      outward[face] = sign(octant, face);
      const Upright axes = upright(outward);
      const Vec3 size = 2.0 * half_;
      const auto along = [&](const Vec3& axis) {
        return 0.5 + glm::dot(p, axis) / std::fabs(glm::dot(size, axis));
      };
      mesh_.texcoords.push_back({along(axes.right), along(axes.up)});
    }
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
  }
  std::uint32_t use(int octant, std::size_t i, int face, const Vec3& flat_normal) {
    if (shared()) return static_cast<std::uint32_t>(octant * directions_.size() + i);
    return add(octant, i, face, flat_normal);
  }

  void emit(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool mirrored) {
    mesh_.triangles.push_back(mirrored ? Triangle{a, c, b} : Triangle{a, b, c});
  }

  int larger(int a, int b) const {
    return area_[a] == area_[b] ? std::min(a, b) : area_[a] > area_[b] ? a : b;
  }
  static int octant_of(int a, double sa, int b, double sb, int c, double sc) {
    return (sa < 0) << a | (sb < 0) << b | (sc < 0) << c;
  }

  void face(int axis, double side) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    if (inner_[u] == 0 || inner_[v] == 0) return;
    Vec3 normal(0);
    normal[axis] = side;
    std::uint32_t corner[4];
    const double sides[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (int k = 0; k < 4; ++k)
      corner[k] = use(octant_of(axis, side, u, sides[k][0], v, sides[k][1]),
                      corner_.axis_index(axis), axis, normal);
    emit(corner[0], corner[1], corner[2], side < 0);
    emit(corner[0], corner[2], corner[3], side < 0);
  }

  void edge(int axis, double side_a, double side_b) {
    if (inner_[axis] == 0) return;
    const int a = (axis + 1) % 3;
    const int b = (axis + 2) % 3;
    Vec3 normal(0);
    normal[a] = side_a * std::sqrt(0.5);
    normal[b] = side_b * std::sqrt(0.5);
    const int low = octant_of(a, side_a, b, side_b, axis, -1);
    const int high = octant_of(a, side_a, b, side_b, axis, 1);
    const int face = larger(a, b);
    std::uint32_t before[2] = {};
    for (std::uint32_t i = 0; i <= steps_; ++i) {
      const std::size_t k = corner_.arc_index(axis, i);
      const std::uint32_t now[2] = {use(low, k, face, normal), use(high, k, face, normal)};
      if (i > 0) {
        emit(before[0], now[0], now[1], side_a * side_b < 0);
        emit(before[0], now[1], before[1], side_a * side_b < 0);
      }
      std::copy(now, now + 2, before);
    }
  }

  void corner(int octant) {
    const Vec3 normal =
        std::sqrt(1.0 / 3) * Vec3(sign(octant, 0), sign(octant, 1), sign(octant, 2));
    const int face = larger(larger(0, 1), 2);
    const auto first =
        static_cast<std::uint32_t>(shared() ? octant * directions_.size() : mesh_.positions.size());
    if (!shared())
      for (std::size_t i = 0; i < directions_.size(); ++i) add(octant, i, face, normal);
    const bool mirrored = normal.x * normal.y * normal.z < 0;
    corner_.for_each_triangle([&](std::size_t a, std::size_t b, std::size_t c) {
      emit(first + static_cast<std::uint32_t>(a), first + static_cast<std::uint32_t>(b),
           first + static_cast<std::uint32_t>(c), mirrored);
    });
  }

  // Corners whose edge has no length meet.
  void weld() {
    const std::vector<std::uint32_t> first = welded(mesh_.positions);
    std::vector<std::uint32_t> place(first.size());
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < first.size(); ++i) {
      if (first[i] != i) {
        place[i] = place[first[i]];
        continue;
      }
      mesh_.positions[kept] = mesh_.positions[i];
      mesh_.normals[kept] = mesh_.normals[i];
      place[i] = kept++;
    }
    mesh_.positions.resize(kept);
    mesh_.normals.resize(kept);
    for (Triangle& t : mesh_.triangles)
      for (std::uint32_t& v : t) v = place[v];
  }

  Vec3 half_;
  Vec3 inner_;
  std::uint32_t steps_;
  Corner corner_;
  std::vector<Vec3> directions_;
  double radius_;
  bool smooth_;
  bool texcoords_;
  double area_[3];  // of the faces across each axis
  Mesh mesh_;
};

}  // namespace

Problem problem(const Box& shape) {
  for (int axis = 0; axis < 3; ++axis)
    if (auto bad = size_problem(shape.size[axis], "size", "a side")) {
      bad->item = static_cast<std::size_t>(axis);
      return bad;
    }
  if (auto bad = zero_or_size_problem(shape.bevel, "bevel", "a bevel")) return bad;
  const double most = 0.5 * std::min({shape.size.x, shape.size.y, shape.size.z});
  if (shape.bevel > most * (1 + kSlack))
    return ShapeProblem{
        Code("E2011"),
        fmt::format("a bevel of {} m, expected at most half of the smallest side, {} m",
                    format_double(shape.bevel), format_double(most)),
        "bevel"};
  return std::nullopt;
}

Result<Mesh> make(const Box& shape, const TessellationOptions& options, SourceSpan where,
                  DiagnosticLog& log) {
  const Plan plan = box_plan(shape, options);
  if (plan.too_fine) {
    log.report(
        Code("E2003"), where,
        fmt::format("an error of {} m cannot be achieved with single-precision vertices on a box "
                    "of {} by {} by {} m",
                    format_double(options.max_error), format_double(shape.size.x),
                    format_double(shape.size.y), format_double(shape.size.z)));
    return failed;
  }
  // with texture coordinates edges have vertices of their own
  const double vertices = 4 * (plan.steps + 1) * (plan.steps + 2) + 24 * (plan.steps + 2);
  if (!within_counts(triangle_count(shape, plan.steps), vertices, "a box", options, where, log))
    return failed;
  Mesh mesh = BoxBuilder(shape, plan, options.texcoords).build();
  set_error(mesh, bevel_of(shape) * plan.round.error);
  return mesh;
}

double planned(const Box& shape, const TessellationOptions& options) {
  return triangle_count(shape, box_plan(shape, options).steps);
}

Problem problem(const Plane& shape) {
  if (auto bad = size_problem(shape.width, "width", "a width")) return bad;
  return size_problem(shape.height, "height", "a height");
}

Result<Mesh> make(const Plane& shape, const TessellationOptions& options, SourceSpan where,
                  DiagnosticLog& log) {
  if (!within_counts(2, 4, "a plane", options, where, log)) return failed;
  const double x = 0.5 * shape.width;
  const double y = 0.5 * shape.height;
  Mesh mesh;
  mesh.positions = {{-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0}};
  mesh.normals.assign(4, Vec3(0, 0, 1));
  if (options.texcoords) mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  set_error(mesh, 0);
  return mesh;
}

double planned(const Plane&, const TessellationOptions&) { return 2; }

}  // namespace panwright::geometry::internal
