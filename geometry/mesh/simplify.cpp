#include "geometry/mesh/simplify.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <vector>

#include "base/axis_box.h"
#include "geometry/internal/triangle.h"
#include "geometry/internal/weld.h"
#include "geometry/mesh/check.h"
#include "geometry/ray/box_tree.h"

namespace panwright::geometry {
namespace {

// Where a closed mesh was thin, two triangles may lie back to back: they show nothing, and leave
// an edge of four.
void drop_folds(std::vector<unsigned>& indices) {
  std::map<Triangle, std::size_t> seen;
  std::vector<char> gone(indices.size() / 3);
  for (std::size_t i = 0; i < gone.size(); ++i) {
    Triangle t{indices[3 * i], indices[3 * i + 1], indices[3 * i + 2]};
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    const auto other = seen.find({t[0], t[2], t[1]});
    if (other == seen.end()) {
      seen.emplace(t, i);
      continue;
    }
    gone[i] = gone[other->second] = 1;
    seen.erase(other);
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < gone.size(); ++i) {
    if (gone[i]) continue;
    for (std::size_t k = 0; k < 3; ++k) indices[3 * kept + k] = indices[3 * i + k];
    ++kept;
  }
  indices.resize(3 * kept);
}

}  // namespace

struct Simplifier::Impl {
  const Mesh& full;
  unsigned options = 0;
  std::vector<float> positions;         // 3 for each corner point, about the centre
  std::vector<std::uint32_t> first;     // of a corner point's vertices in `vertices`; one more
  std::vector<std::uint32_t> vertices;  // by corner point
  std::vector<unsigned> indices;        // of corner points
  double size = 0;

  explicit Impl(const Mesh& mesh) : full(mesh) {}

  // Vertices that differ in nothing but their normals are one corner point.
  std::vector<std::uint32_t> find_points() {
    const std::vector<std::uint32_t> place = welded(full.positions);
    vertices.resize(place.size());
    std::iota(vertices.begin(), vertices.end(), 0u);
    const auto key = [&](std::uint32_t v) {
      const Vec2 uv = full.texcoords.empty() ? Vec2(0) : full.texcoords[v];
      const Vec3 color = full.colors.empty() ? Vec3(0) : full.colors[v];
      return std::make_tuple(place[v], uv.x, uv.y, color.x, color.y, color.z);
    };
    std::sort(vertices.begin(), vertices.end(), [&](std::uint32_t a, std::uint32_t b) {
      if (place[a] != place[b]) return place[a] < place[b];
      const auto x = key(a), y = key(b);
      return x != y ? x < y : a < b;
    });
    std::vector<std::uint32_t> point(place.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      if (i == 0 || key(vertices[i]) != key(vertices[i - 1]))
        first.push_back(static_cast<std::uint32_t>(i));
      point[vertices[i]] = static_cast<std::uint32_t>(first.size() - 1);
    }
    first.push_back(static_cast<std::uint32_t>(vertices.size()));
    return point;
  }

  std::uint32_t vertex(std::size_t point) const { return vertices[first[point]]; }

  void prepare(bool lock_border) {
    options = lock_border ? static_cast<unsigned>(meshopt_SimplifyLockBorder) : 0u;
    AxisBox box;
    for (const Triangle& t : full.triangles)
      for (const std::uint32_t corner : t) box.add(full.positions[corner]);
    if (box.empty()) {
      first.push_back(0);
      return;
    }
    size = box.longest();
    const std::vector<std::uint32_t> point = find_points();
    const Vec3 centre = box.centre();
    for (std::size_t i = 0; i + 1 < first.size(); ++i) {
      // note: a vertex that no triangle uses may lie anywhere
      const Vec3 at = glm::clamp(full.positions[vertex(i)], box.low, box.high) - centre;
      for (int k = 0; k < 3; ++k)
        positions.push_back(size > 0 ? static_cast<float>(at[k] / size) : 0.0f);
    }
    for (const Triangle& t : full.triangles) {
      const auto is_same = [&](std::uint32_t a, std::uint32_t b) {
        return full.positions[a] == full.positions[b];
      };
      if (is_same(t[0], t[1]) || is_same(t[1], t[2]) || is_same(t[2], t[0])) continue;
      for (const std::uint32_t corner : t) indices.push_back(point[corner]);
    }
  }

  // The vertex of a corner point whose normal is nearest to a facet's.
  std::uint32_t vertex_for(std::size_t point, const Vec3& facet) const {
    std::uint32_t best = vertex(point);
    if (full.normals.empty()) return best;
    double cosine = -2;
    for (std::uint32_t i = first[point]; i < first[point + 1]; ++i) {
      const double c = glm::dot(full.normals[vertices[i]], facet);
      if (c > cosine) best = vertices[i];
      cosine = std::max(cosine, c);
    }
    return best;
  }
};

Simplifier::Simplifier(const Mesh& mesh, bool lock_border) : impl_(std::make_unique<Impl>(mesh)) {
  impl_->prepare(lock_border);
}
Simplifier::~Simplifier() = default;
Simplifier::Simplifier(Simplifier&&) noexcept = default;
Simplifier& Simplifier::operator=(Simplifier&&) noexcept = default;

std::size_t Simplifier::triangles() const { return impl_->indices.size() / 3; }
double Simplifier::size() const { return impl_->size; }

double Simplifier::step(std::size_t target, double error) {
  Impl& s = *impl_;
  if (s.indices.empty() || !(s.size > 0)) return 0;
  std::vector<unsigned> out(s.indices.size());
  float cost = 0;
  const double relative = std::min(error / s.size, 1.0);
  const std::size_t count = meshopt_simplify(
      out.data(), s.indices.data(), s.indices.size(), s.positions.data(), s.positions.size() / 3,
      3 * sizeof(float), std::min(3 * target, s.indices.size()), static_cast<float>(relative),
      s.options, &cost);
  out.resize(count);
  if (s.full.closed) drop_folds(out);
  s.indices = std::move(out);
  return static_cast<double>(cost) * s.size;
}

Mesh Simplifier::mesh() const {
  const Impl& s = *impl_;
  Mesh out;
  std::vector<std::uint32_t> index(s.full.positions.size(), 0xffffffffu);
  const auto add = [&](std::uint32_t from) {
    out.positions.push_back(s.full.positions[from]);
    if (!s.full.normals.empty()) out.normals.push_back(s.full.normals[from]);
    if (!s.full.texcoords.empty()) out.texcoords.push_back(s.full.texcoords[from]);
    if (!s.full.colors.empty()) out.colors.push_back(s.full.colors[from]);
    return static_cast<std::uint32_t>(out.positions.size() - 1);
  };
  for (std::size_t i = 0; i < s.indices.size(); i += 3) {
    const TriangleMeasure m = measure(s.full.positions[s.vertex(s.indices[i])],
                                      s.full.positions[s.vertex(s.indices[i + 1])],
                                      s.full.positions[s.vertex(s.indices[i + 2])]);
    const Vec3 facet = m.double_area > 0 ? m.cross / m.double_area : Vec3(0);
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = s.vertex_for(s.indices[i + k], facet);
      if (index[from] == 0xffffffffu) index[from] = add(from);
      t[k] = index[from];
    }
    out.triangles.push_back(t);
  }
  set_closed(out);
  return out;
}

}  // namespace panwright::geometry
