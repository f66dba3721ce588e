#include "geometry/mesh/check.h"

#include <algorithm>
#include <cmath>

#include "geometry/internal/triangle.h"
#include "geometry/internal/weld.h"

namespace panwright::geometry {

namespace {

struct EdgeCounts {
  std::uint64_t boundary = 0;
  std::uint64_t non_manifold = 0;
  std::uint64_t misoriented = 0;
  std::uint64_t all = 0;
};

bool has_bad_index(const Triangle& t, std::size_t vertices) {
  return t[0] >= vertices || t[1] >= vertices || t[2] >= vertices;
}

bool is_collapsed(const Triangle& t, const std::vector<std::uint32_t>& first) {
  const std::uint32_t a = first[t[0]];
  const std::uint32_t b = first[t[1]];
  const std::uint32_t c = first[t[2]];
  return a == b || b == c || c == a;
}

// Sorts the sides of triangles by their lower vertex, then by their upper one.
EdgeCounts count_edges(const Mesh& mesh, const std::vector<std::uint32_t>& first) {
  const std::size_t vertices = mesh.positions.size();
  const auto for_each_side = [&](const auto& body) {
    for (const Triangle& t : mesh.triangles) {
      if (has_bad_index(t, vertices) || is_collapsed(t, first)) continue;
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t from = first[t[k]];
        const std::uint32_t to = first[t[(k + 1) % 3]];
        body(std::min(from, to), std::max(from, to), from < to);
      }
    }
  };
  std::vector<std::uint64_t> start(vertices + 2, 0);
  for_each_side([&](std::uint32_t low, std::uint32_t, bool) { ++start[low + 2]; });
  for (std::size_t i = 2; i < start.size(); ++i) start[i] += start[i - 1];
  std::vector<std::uint64_t> sides(start.back());  // upper vertex · 2 + forward
  for_each_side([&](std::uint32_t low, std::uint32_t high, bool forward) {
    sides[start[low + 1]++] = 2 * std::uint64_t{high} + (forward ? 1 : 0);
  });

  EdgeCounts edges;
  for (std::size_t v = 0; v < vertices; ++v) {
    const auto begin = sides.begin() + static_cast<std::ptrdiff_t>(start[v]);
    const auto end = sides.begin() + static_cast<std::ptrdiff_t>(start[v + 1]);
    std::sort(begin, end);
    for (auto side = begin; side != end;) {
      const std::uint64_t high = *side / 2;
      std::uint64_t uses = 0;
      std::uint64_t forward = 0;
      for (; side != end && *side / 2 == high; ++side) {
        ++uses;
        forward += *side & 1;
      }
      ++edges.all;
      edges.boundary += uses == 1;
      edges.non_manifold += uses > 2;
      edges.misoriented += uses == 2 && forward != 1;
    }
  }
  return edges;
}

template <class V>
bool finite(const V& v) {
  for (typename V::length_type i = 0; i < v.length(); ++i)
    if (!std::isfinite(v[i])) return false;
  return true;
}

void check_vertices(const Mesh& mesh, MeshReport& report) {
  const std::size_t vertices = mesh.positions.size();
  for (const std::size_t length : {mesh.normals.size(), mesh.texcoords.size(), mesh.colors.size()})
    report.bad_lengths += length != 0 && length != vertices;
  const auto sound = [](const auto& list, std::size_t i) {
    return i >= list.size() || finite(list[i]);
  };
  for (std::size_t i = 0; i < vertices; ++i)
    report.non_finite += !(finite(mesh.positions[i]) && sound(mesh.normals, i) &&
                           sound(mesh.texcoords, i) && sound(mesh.colors, i));
  for (const Vec3& n : mesh.normals)
    report.bad_normals += finite(n) && std::fabs(glm::length(n) - 1) > 1e-6;
}

// Carries what addition rounds off: millions of terms cost no digits. Neumaier, 1974.
class CarefulSum {
 public:
  void add(double x) {
    const double sum = sum_ + x;
    lost_ += std::fabs(sum_) >= std::fabs(x) ? (sum_ - sum) + x : (x - sum) + sum_;
    sum_ = sum;
  }
  double total() const { return sum_ + lost_; }

 private:
  double sum_ = 0;
  double lost_ = 0;
};

Vec3 bounds_centre(const std::vector<Vec3>& positions) {
  Vec3 low(0);
  Vec3 high(0);
  bool any = false;
  for (const Vec3& p : positions) {
    if (!finite(p)) continue;
    low = any ? glm::min(low, p) : p;
    high = any ? glm::max(high, p) : p;
    any = true;
  }
  return 0.5 * low + 0.5 * high;
}

void measure_triangles(const Mesh& mesh, const std::vector<std::uint32_t>& first,
                       MeshReport& report) {
  // about the centre, or the terms of a small mesh far away cancel
  const Vec3 centre = bounds_centre(mesh.positions);
  CarefulSum six_volumes;
  CarefulSum two_areas;
  for (const Triangle& t : mesh.triangles) {
    if (has_bad_index(t, mesh.positions.size())) {
      ++report.bad_indices;
      continue;
    }
    const Vec3 a = mesh.positions[t[0]] - centre;
    const Vec3 b = mesh.positions[t[1]] - centre;
    const Vec3 c = mesh.positions[t[2]] - centre;
    if (is_collapsed(t, first)) {
      ++report.degenerate_triangles;
      continue;
    }
    if (!finite(a) || !finite(b) || !finite(c)) continue;
    const TriangleMeasure m = measure(a, b, c);
    report.degenerate_triangles += m.degenerate();
    two_areas.add(m.double_area);
    six_volumes.add(glm::dot(m.cross, a));
  }
  report.area = two_areas.total() / 2;
  report.volume = six_volumes.total() / 6;
}

}  // namespace

MeshReport check(const Mesh& mesh) {
  MeshReport report;
  check_vertices(mesh, report);
  const std::vector<std::uint32_t> first = welded(mesh.positions);
  measure_triangles(mesh, first, report);
  const EdgeCounts edges = count_edges(mesh, first);
  report.boundary_edges = edges.boundary;
  report.non_manifold_edges = edges.non_manifold;
  report.misoriented_edges = edges.misoriented;
  report.closed = edges.all > 0 && edges.boundary == 0 && edges.non_manifold == 0 &&
                  edges.misoriented == 0 && report.bad_indices == 0;
  return report;
}

void set_closed(Mesh& mesh) { mesh.closed = check(mesh).closed; }

}  // namespace panwright::geometry
