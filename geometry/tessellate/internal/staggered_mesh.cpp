#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "geometry/tessellate/internal/maximum.h"
#include "geometry/tessellate/internal/staggered.h"
#include "geometry/tessellate/internal/zipper.h"

namespace panwright::geometry::internal {

namespace {

// towards the nearest point; 3 are usual
constexpr int kNewton = 40;

class StaggeredBuilder {
 public:
  StaggeredBuilder(const Staggered& plan, const StaggeredPlace& place, const Steps& around,
                   bool texcoords)
      : place_(place), texcoords_(texcoords) {
    const Vec3& r = place.radii;
    round_ = r.x == r.y && r.y == r.z;
    unit_ = std::min({r.x, r.y, r.z});
    std::map<std::pair<std::uint32_t, bool>, std::size_t> known;
    for (const StaggeredRing& ring : plan.rings) {
      const auto [found, added] = known.try_emplace({ring.steps, ring.shifted}, columns_.size());
      if (added) columns_.push_back({ring.steps, ring.shifted, {}, {}});
      rings_.push_back({ring.latitude, found->second, {}, 0});
    }
    parallel_for(columns_.size(), [&](std::size_t i) { fill_columns(columns_[i], around); });
    // the poles first and last: with texture coordinates once for each triangle
    poles_[0] = texcoords ? segments(rings_.front()) : 1;
    poles_[1] = texcoords ? segments(rings_.back()) : 1;
    std::uint64_t vertices = poles_[0];
    triangles_ = segments(rings_.front());
    for (std::size_t i = 0; i < rings_.size(); ++i) {
      Ring& ring = rings_[i];
      const Columns& columns = columns_[ring.columns];
      ring.vertices = {vertices, columns.at.size(), columns.steps, columns.shifted, texcoords};
      ring.triangles = triangles_;
      vertices += columns.at.size();
      triangles_ +=
          ring.vertices.segments() + (i + 1 < rings_.size() ? segments(rings_[i + 1]) : 0);
    }
    vertices_ = vertices + poles_[1];
  }

  Mesh build() {
    mesh_.positions.resize(vertices_);
    mesh_.normals.resize(vertices_);
    if (texcoords_) mesh_.texcoords.resize(vertices_);
    mesh_.triangles.resize(triangles_);
    mesh_.closed = true;
    fill_pole(false);
    fill_pole(true);
    // note: small meshes stay on this thread, starting others costs more than they save
    const std::size_t rows =
        std::max<std::size_t>(1, kChunk * rings_.size() / static_cast<std::size_t>(vertices_));
    parallel_for((rings_.size() + rows - 1) / rows, [&](std::size_t task) {
      const std::size_t end = std::min(rings_.size(), (task + 1) * rows);
      for (std::size_t i = task * rows; i < end; ++i) {
        fill(rings_[i]);
        if (i + 1 < rings_.size())
          zip(rings_[i].vertices, rings_[i + 1].vertices,
              mesh_.triangles.data() + rings_[i].triangles);
      }
    });
    return std::move(mesh_);
  }

 private:
  // the longitudes of rings of one kind
  struct Columns {
    std::uint32_t steps;
    bool shifted;
    std::vector<det::SinCos> at;
    std::vector<double> u;
  };
  struct Ring {
    det::SinCos latitude;
    std::size_t columns;
    RingOfVertices vertices;
    std::uint64_t triangles;  // where those to the next ring begin
  };

  std::uint64_t segments(const Ring& ring) const {
    const Columns& columns = columns_[ring.columns];
    return columns.at.size() - (texcoords_ ? 1 : 0);
  }

  void fill_columns(Columns& columns, const Steps& around) const {
    const std::uint64_t steps = columns.steps;
    const auto add = [&](std::uint64_t half) {
      const det::SinCos at = around.at(half % (2 * steps), 2 * steps);
      columns.at.push_back(at);
      if (!texcoords_) return;
      double share = static_cast<double>(half) / (2 * static_cast<double>(steps));
      if (!around.even() && half % (2 * steps) != 0) {
        share = det::atan2(at.sin, at.cos) / (2 * kPi);
        if (share < 0) share += 1;
      }
      columns.u.push_back(share);
    };
    if (columns.shifted && texcoords_) add(0);
    for (std::uint64_t k = 0; k < steps; ++k) add(2 * k + (columns.shifted ? 1 : 0));
    if (texcoords_) add(2 * steps);
  }

  void set(std::uint64_t at, const det::SinCos& latitude, const det::SinCos& longitude) {
    const Vec3 u(latitude.cos * longitude.cos, latitude.cos * longitude.sin, latitude.sin);
    const Vec3 p = (place_.radii + Vec3(place_.out)) * u;
    mesh_.normals[at] = turned(round_ ? u : normal(p));
    mesh_.positions[at] = turned(p);
  }

  // Of the shape at its point nearest to one outside: p/(t + r²) for the t that makes that a point
  // of the shape. Newton's steps from 0 on a convex function stay below t.
  Vec3 normal(const Vec3& p) const {
    const Vec3 r = place_.radii / unit_, q = p / unit_;
    const Vec3 r2 = r * r;
    double t = 0;
    for (int i = 0; i < kNewton; ++i) {
      const Vec3 x = r * q / (t + r2);
      const Vec3 x2 = x * x;
      const double above = x2.x + x2.y + x2.z - 1;
      if (!(above > 1e-14)) break;
      t += 0.5 * above / (x2.x / (t + r2.x) + x2.y / (t + r2.y) + x2.z / (t + r2.z));
    }
    const Vec3 n = q / (t + r2);
    return n / glm::length(n);
  }

  Vec3 turned(const Vec3& p) const {
    const det::SinCos& b = place_.begin;
    const Vec3 q = b.sin == 0 && b.cos == 1
                       ? p
                       : Vec3(b.cos * p.x - b.sin * p.y, b.sin * p.x + b.cos * p.y, p.z);
    const int z = place_.polar_axis;
    Vec3 r;
    r[(z + 1) % 3] = q.x;
    r[(z + 2) % 3] = q.y;
    r[z] = q.z;
    return r;
  }

  void fill(const Ring& ring) {
    const Columns& columns = columns_[ring.columns];
    const double v = det::atan2(ring.latitude.sin, ring.latitude.cos) / kPi + 0.5;
    for (std::size_t i = 0; i < columns.at.size(); ++i) {
      const std::uint64_t at = ring.vertices.start + i;
      set(at, ring.latitude, columns.at[i]);
      if (texcoords_) mesh_.texcoords[at] = {columns.u[i], v};
    }
  }

  void fill_pole(bool north) {
    const Ring& ring = north ? rings_.back() : rings_.front();
    const std::vector<double>& u = columns_[ring.columns].u;
    const std::uint64_t start = north ? vertices_ - poles_[1] : 0;
    const std::uint64_t segments = ring.vertices.segments();
    for (std::uint64_t i = 0; i < poles_[north ? 1 : 0]; ++i) {
      set(start + i, {north ? 1.0 : -1.0, 0}, {0, 1});
      if (texcoords_) mesh_.texcoords[start + i] = {0.5 * (u[i] + u[i + 1]), north ? 1 : 0};
    }
    Triangle* out = mesh_.triangles.data() + (north ? triangles_ - segments : 0);
    for (std::uint64_t i = 0; i < segments; ++i) {
      const auto pole = static_cast<std::uint32_t>(start + (texcoords_ ? i : 0));
      const auto west = static_cast<std::uint32_t>(ring.vertices.vertex(i));
      const auto east = static_cast<std::uint32_t>(ring.vertices.vertex(i + 1));
      *out++ = north ? Triangle{west, east, pole} : Triangle{pole, east, west};
    }
  }

  const StaggeredPlace& place_;
  bool texcoords_;
  bool round_;
  double unit_;  // the smallest radius
  std::vector<Columns> columns_;
  std::vector<Ring> rings_;
  std::uint64_t poles_[2] = {1, 1};  // vertices
  std::uint64_t vertices_ = 0, triangles_ = 0;
  Mesh mesh_;
};

}  // namespace

Mesh staggered_mesh(const Staggered& plan, const StaggeredPlace& place, const Steps& around,
                    bool texcoords) {
  return StaggeredBuilder(plan, place, around, texcoords).build();
}

}  // namespace panwright::geometry::internal
