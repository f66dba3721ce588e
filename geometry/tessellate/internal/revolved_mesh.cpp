#include <fmt/core.h>

#include <algorithm>

#include "base/parallel.h"
#include "base/text.h"
#include "geometry/tessellate/internal/circle.h"
#include "geometry/tessellate/internal/revolve.h"
#include "geometry/tessellate/internal/zipper.h"

namespace panwright::geometry::internal {

namespace {

// vertices that one task makes; small meshes stay on the calling thread
constexpr std::size_t kRevolvedTask = std::size_t{1} << 15;

class RevolvedBuilder {
 public:
  RevolvedBuilder(const Revolution& shape, const Layout& layout, bool texcoords)
      : shape_(shape),
        layout_(layout),
        texcoords_(texcoords),
        directions_(directions(shape.sector, layout.segments)) {
    if (layout.narrow_segments != 0)
      narrow_directions_ = directions(shape.sector, layout.narrow_segments);
    for (std::size_t i = 0; i < shape.parts.size(); ++i) place(i);
    wall_start_ = vertices_;
    vertices_ += 2 * shape.wall.size();
    wall_triangles_ = triangles_;
    if (!shape.wall.empty()) triangles_ += 2 * (shape.wall.size() - 2);
  }

  Mesh build() {
    mesh_.positions.resize(vertices_);
    mesh_.normals.resize(vertices_);
    if (texcoords_) mesh_.texcoords.resize(vertices_);
    mesh_.triangles.resize(triangles_);
    mesh_.closed = shape_.closed;
    const std::size_t rows =
        std::max<std::size_t>(1, kRevolvedTask / (std::size_t{layout_.segments} + 1));
    const std::size_t tasks = (rings_.size() + rows - 1) / rows;
    parallel_for(tasks, [&](std::size_t task) {
      const std::size_t end = std::min(rings_.size(), (task + 1) * rows);
      for (std::size_t i = task * rows; i < end; ++i) {
        if (!rings_[i].shared) fill(rings_[i]);
        if (rings_[i].joined) join(rings_[i], rings_[i + 1]);
      }
    });
    for (std::size_t i = 0; i < shape_.parts.size(); ++i)
      if (shape_.parts[i].cap) fill_cap(i);
    if (!shape_.wall.empty()) fill_walls();
    return std::move(mesh_);
  }

 private:
  struct Ring {
    const ProfilePoint* point;
    std::uint32_t segments;
    const std::vector<det::SinCos>* directions;
    Mapping mapping;
    std::uint64_t start;      // its first vertex
    std::uint64_t count;      // vertices
    std::uint64_t triangles;  // where those to the next ring begin
    bool pole;
    bool shared;  // vertices of an earlier ring
    bool joined;  // to the next ring
  };

  const std::vector<det::SinCos>& directions_at(double radius) const {
    return layout_.is_narrow(radius) ? narrow_directions_ : directions_;
  }

  // the radius on the shape whose segments the ends of a part have: of a pole its neighbour's
  static double edge_radius(const Part& part, bool last) {
    const double radius = last ? part.to.x : part.from.x;
    return radius > 0 ? radius : std::max(part.from.x, part.to.x);
  }

  // gives the rings of a part their vertices and triangles
  void place(std::size_t index) {
    const Part& part = shape_.parts[index];
    const auto& points = layout_.parts[index];
    cap_start_.push_back(vertices_);
    cap_triangles_.push_back(triangles_);
    if (part.cap) {
      const double edge = std::max(part.from.x, part.to.x);
      vertices_ += directions_at(edge).size() + (shape_.sector.whole() ? 0 : 1);
      triangles_ += layout_.segments_at(edge) - (shape_.sector.whole() ? 2 : 0);
      return;
    }
    const bool seam = texcoords_ && part.mapping == Mapping::angle;
    const bool loop = part.curve && part.curve->loop() && !seam;
    const std::size_t first = rings_.size();
    for (std::size_t k = 0; k < points.size(); ++k) {
      const ProfilePoint& p = points[k];
      const double edge = part.curve ? 0 : edge_radius(part, k > 0);
      const std::uint32_t segments = layout_.segments_at(edge);
      const std::vector<det::SinCos>& around = directions_at(edge);
      Ring ring{&p,         segments,
                &around,    part.mapping,
                vertices_,  seam ? std::uint64_t{segments} + 1 : around.size(),
                triangles_, p.radius == 0,
                false,      k + 1 < points.size()};
      if (ring.pole) ring.count = seam || p.normal.x != 0 ? segments : 1;
      if (loop && k + 1 == points.size()) {
        ring.shared = true;
        ring.start = rings_[first].start;
      } else {
        vertices_ += ring.count;
      }
      if (ring.joined) {
        const std::uint32_t next =
            part.curve ? segments : layout_.segments_at(edge_radius(part, true));
        triangles_ += (ring.pole ? 0 : segments) + (points[k + 1].radius == 0 ? 0 : next);
      }
      rings_.push_back(ring);
    }
  }

  Vec2 plane_texcoord(Mapping mapping, double v, const det::SinCos& angle) const {
    const double x = mapping == Mapping::above ? angle.cos : -angle.cos;
    return {0.5 + 0.5 * v * x, 0.5 + 0.5 * v * angle.sin};
  }

  void fill(const Ring& ring) {
    const ProfilePoint& p = *ring.point;
    const std::vector<det::SinCos>& around = *ring.directions;
    const double share = 1 / static_cast<double>(ring.segments);
    for (std::uint64_t i = 0; i < ring.count; ++i) {
      const std::uint64_t at = ring.start + i;
      const auto column = static_cast<std::uint32_t>(i);
      const det::SinCos angle = ring.pole && p.normal.x != 0
                                    ? middle_direction(shape_.sector, ring.segments, column)
                                    : around[i < around.size() ? i : 0];
      mesh_.positions[at] = {p.radius * angle.cos, p.radius * angle.sin, p.z};
      mesh_.normals[at] = {p.normal.x * angle.cos, p.normal.x * angle.sin, p.normal.y};
      if (!texcoords_) continue;
      if (ring.mapping == Mapping::angle)
        mesh_.texcoords[at] = {(static_cast<double>(i) + (ring.pole ? 0.5 : 0.0)) * share, p.v};
      else
        mesh_.texcoords[at] = plane_texcoord(ring.mapping, p.v, angle);
    }
  }

  static Triangle triangle(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    return {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
            static_cast<std::uint32_t>(c)};
  }

  void join(const Ring& low, const Ring& high) {
    Triangle* out = mesh_.triangles.data() + low.triangles;
    if (low.segments != high.segments) {
      const auto vertices = [](const Ring& ring) {
        return RingOfVertices{ring.start, ring.count, ring.segments, false,
                              ring.count > ring.segments};
      };
      zip(vertices(low), vertices(high), out);
      return;
    }
    const std::uint64_t columns = low.pole ? high.count : low.count;
    for (std::uint64_t i = 0; i < low.segments; ++i) {
      const std::uint64_t next = i + 1 < columns ? i + 1 : 0;
      if (low.pole) {
        const std::uint64_t pole = low.start + (low.count > 1 ? i : 0);
        *out++ = triangle(pole, high.start + next, high.start + i);
      } else if (high.pole) {
        const std::uint64_t pole = high.start + (high.count > 1 ? i : 0);
        *out++ = triangle(low.start + i, low.start + next, pole);
      } else {
        *out++ = triangle(low.start + i, low.start + next, high.start + next);
        *out++ = triangle(low.start + i, high.start + next, high.start + i);
      }
    }
  }

  // A flat face: corners cut off a polygon, then of what is left, and so on, so that no triangle is
  // thinner than its outline asks for; a sector is a fan about the axis.
  void fill_cap(std::size_t index) {
    const auto& points = layout_.parts[index];
    const ProfilePoint& edge = points.front().radius > 0 ? points.front() : points.back();
    const Mapping mapping = shape_.parts[index].mapping;
    const bool up = mapping == Mapping::above;
    const std::uint64_t start = cap_start_[index];
    const Part& part = shape_.parts[index];
    const std::vector<det::SinCos>& around = directions_at(std::max(part.from.x, part.to.x));
    const std::uint64_t count = around.size();
    for (std::uint64_t i = 0; i < count; ++i) {
      const det::SinCos angle = around[i];
      set(start + i, {edge.radius * angle.cos, edge.radius * angle.sin, edge.z},
          {0, 0, up ? 1 : -1}, plane_texcoord(mapping, edge.v, angle));
    }
    Triangle* out = mesh_.triangles.data() + cap_triangles_[index];
    const auto emit = [&](std::uint64_t a, std::uint64_t b, std::uint64_t c) {
      *out++ = up ? triangle(a, b, c) : triangle(a, c, b);
    };
    if (!shape_.sector.whole()) {
      set(start + count, {0, 0, edge.z}, {0, 0, up ? 1 : -1}, {0.5, 0.5});
      for (std::uint64_t i = 0; i + 1 < count; ++i) emit(start + count, start + i, start + i + 1);
      return;
    }
    std::vector<std::uint64_t> left(count);
    for (std::uint64_t i = 0; i < count; ++i) left[i] = start + i;
    while (left.size() > 3) {
      std::size_t kept = 0;
      const std::size_t size = left.size();
      for (std::size_t i = 0; i < size; i += 2) {
        if (i + 1 < size) emit(left[i], left[i + 1], left[i + 2 < size ? i + 2 : 0]);
        left[kept++] = left[i];
      }
      left.resize(kept);
    }
    if (left.size() == 3) emit(left[0], left[1], left[2]);
  }

  void fill_walls() {
    const std::size_t count = shape_.wall.size();
    Vec2 low = shape_.wall[0], high = low;
    for (const Vec2& p : shape_.wall) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    Triangle* out = mesh_.triangles.data() + wall_triangles_;
    for (const bool last : {false, true}) {
      const det::SinCos angle = last ? directions_.back() : directions_.front();
      const std::uint64_t start = wall_start_ + (last ? count : 0);
      const double side = last ? -1 : 1;
      const Vec3 normal(side * angle.sin, -side * angle.cos, 0);
      for (std::size_t i = 0; i < count; ++i) {
        const double radius = layout_.factor_at(shape_.wall[i].x) * shape_.wall[i].x;
        const double u = shape_.wall[i].x / high.x;
        const double v = (shape_.wall[i].y - low.y) / (high.y - low.y);
        set(start + i, {radius * angle.cos, radius * angle.sin, shape_.wall[i].y}, normal,
            {last ? 1 - u : u, v});
      }
      for (std::size_t i = 1; i + 1 < count; ++i)
        *out++ = last ? triangle(start, start + i + 1, start + i)
                      : triangle(start, start + i, start + i + 1);
    }
  }

  void set(std::uint64_t at, const Vec3& position, const Vec3& normal, const Vec2& texcoord) {
    mesh_.positions[at] = position;
    mesh_.normals[at] = normal;
    if (texcoords_) mesh_.texcoords[at] = texcoord;
  }

  const Revolution& shape_;
  const Layout& layout_;
  bool texcoords_;
  std::vector<det::SinCos> directions_, narrow_directions_;
  std::vector<Ring> rings_;
  std::vector<std::uint64_t> cap_start_, cap_triangles_;  // by part
  std::uint64_t vertices_ = 0, triangles_ = 0;
  std::uint64_t wall_start_ = 0, wall_triangles_ = 0;
  Mesh mesh_;
};

}  // namespace

Result<Mesh> revolved(const Revolution& revolution, const TessellationOptions& options,
                      SourceSpan where, DiagnosticLog& log) {
  const Layout layout = laid_out(revolution, options);
  if (layout.state == Layout::State::too_fine) {
    log.report(
        Code("E2003"), where,
        fmt::format("an error of {} m cannot be achieved with single-precision vertices on a {} of "
                    "this size, expected at least {} m",
                    format_double(options.max_error), revolution.kind,
                    format_double(layout.least_error)));
    return failed;
  }
  if (layout.state == Layout::State::too_many) {
    log.report(
        Code("E2003"), where,
        fmt::format("a {} with an error of {} m needs more than {} triangles", revolution.kind,
                    format_double(options.max_error), options.max_triangles));
    return failed;
  }
  Mesh mesh = RevolvedBuilder(revolution, layout, options.texcoords).build();
  set_error(mesh, layout.error);
  return mesh;
}

double rounding_bound(double reach) {
  // half the spacing of single precision, relative to the number
  return 0x1.02p-24 * reach;
}

void set_error(Mesh& mesh, double shape_error) {
  Vec3 low = mesh.positions.front(), high = low;
  for (const Vec3& p : mesh.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  mesh.error = shape_error + rounding_error(mesh.positions, 0.5 * low + 0.5 * high);
}

}  // namespace panwright::geometry::internal
