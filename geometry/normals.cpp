#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "geometry/internal/triangle.h"
#include "geometry/internal/weld.h"
#include "geometry/strip.h"

namespace panwright::geometry {

namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
// radians: what rounding may do to the angle of a right-angled crease
constexpr double kAngleSlack = 1e-9;

// A corner is 3·triangle + place.
struct Corners {
  std::vector<std::uint32_t> start;  // V + 1, of the corners at each welded vertex
  std::vector<std::uint32_t> list;   // corners of triangles with area, in triangle order
};

class NormalBuilder {
 public:
  NormalBuilder(Mesh& mesh, double crease_angle)
      : mesh_(mesh),
        crease_(std::clamp(crease_angle, 0.0, kPi)),
        cos_crease_(det::cos(std::min(kPi, crease_ + kAngleSlack))) {}

  void run() {
    first_ = welded(mesh_.positions);
    measure_facets();
    list_corners();
    group_of_.assign(3 * mesh_.triangles.size(), kNone);
    for (std::size_t v = 0; v < mesh_.positions.size(); ++v) group_vertex(v);
    emit();
  }

 private:
  void measure_facets() {
    facet_normals_.assign(mesh_.triangles.size(), Vec3(0));
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      const Triangle& t = mesh_.triangles[i];
      const TriangleMeasure m =
          measure(mesh_.positions[t[0]], mesh_.positions[t[1]], mesh_.positions[t[2]]);
      if (!m.degenerate()) facet_normals_[i] = m.cross / m.double_area;
    }
  }

  bool has_area(std::size_t triangle) const { return facet_normals_[triangle] != Vec3(0); }
  std::uint32_t place(std::uint32_t corner, std::uint32_t step) const {
    return first_[mesh_.triangles[corner / 3][(corner + step) % 3]];
  }

  void list_corners() {
    const auto for_each_corner = [&](const auto& body) {
      for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
        if (!has_area(i)) continue;
        for (std::uint32_t k = 0; k < 3; ++k) body(first_[mesh_.triangles[i][k]], 3 * i + k);
      }
    };
    std::vector<std::uint32_t>& start = corners_.start;
    start.assign(mesh_.positions.size() + 2, 0);
    for_each_corner([&](std::uint32_t v, std::uint32_t) { ++start[v + 2]; });
    std::partial_sum(start.begin(), start.end(), start.begin());
    corners_.list.resize(start.back());
    for_each_corner(
        [&](std::uint32_t v, std::uint32_t corner) { corners_.list[start[v + 1]++] = corner; });
  }

  bool is_smooth(const Vec3& a, const Vec3& b) const {
    const double cos_angle = glm::dot(a, b);
    if (cos_angle > cos_crease_ + 1e-6) return true;
    if (cos_angle < cos_crease_ - 1e-6) return false;
    return angle_between(a, b) <= crease_ + kAngleSlack;
  }

  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  // note: the smaller root wins, so that a group is named by its first corner
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  // Facets that share an edge at this vertex are joined across it where it is smooth.
  void group_vertex(std::size_t v) {
    const std::uint32_t begin = corners_.start[v];
    const std::uint32_t count = corners_.start[v + 1] - begin;
    if (count == 0) return;
    const std::uint32_t* corners = corners_.list.data() + begin;
    parent_.resize(count);
    std::iota(parent_.begin(), parent_.end(), 0u);
    sides_.clear();
    for (std::uint32_t i = 0; i < count; ++i) {
      sides_.push_back({place(corners[i], 1), i});
      sides_.push_back({place(corners[i], 2), i});
    }
    std::sort(sides_.begin(), sides_.end());
    for (std::size_t i = 0; i < sides_.size();) {
      std::size_t end = i + 1;
      while (end < sides_.size() && sides_[end].first == sides_[i].first) ++end;
      if (end - i == 2) {
        const std::uint32_t a = sides_[i].second;
        const std::uint32_t b = sides_[i + 1].second;
        if (is_smooth(facet_normals_[corners[a] / 3], facet_normals_[corners[b] / 3])) join(a, b);
      } else if (end - i > 2) {
        join_fan(corners, v, i, end);
      }
      i = end;
    }
    make_groups(corners, count);
  }

  // Many facets on one edge: their normals lie on a circle about it, and neighbours on the circle
  // decide for all pairs.
  void join_fan(const std::uint32_t* corners, std::size_t v, std::size_t begin, std::size_t end) {
    const Vec3 axis = glm::normalize(mesh_.positions[sides_[begin].first] - mesh_.positions[v]);
    const Vec3 zero = facet_normals_[corners[sides_[begin].second] / 3];
    const Vec3 right = glm::cross(axis, zero);
    fan_.clear();
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& n = facet_normals_[corners[sides_[i].second] / 3];
      fan_.push_back({det::atan2(glm::dot(n, right), glm::dot(n, zero)), sides_[i].second});
    }
    std::sort(fan_.begin(), fan_.end());
    for (std::size_t i = 0; i < fan_.size(); ++i) {
      const std::uint32_t a = fan_[i].second;
      const std::uint32_t b = fan_[(i + 1) % fan_.size()].second;
      if (is_smooth(facet_normals_[corners[a] / 3], facet_normals_[corners[b] / 3])) join(a, b);
    }
  }

  void make_groups(const std::uint32_t* corners, std::uint32_t count) {
    group_name_.assign(count, kNone);
    const std::size_t first_group = group_normals_.size();
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t r = root(i);
      if (group_name_[r] == kNone) {
        group_name_[r] = static_cast<std::uint32_t>(group_normals_.size());
        group_normals_.push_back(Vec3(0));
        group_weight_.push_back(0);
        group_first_.push_back(facet_normals_[corners[i] / 3]);
      }
      const std::uint32_t group = group_name_[r];
      const double angle = corner_angle(corners[i]);
      group_normals_[group] += angle * facet_normals_[corners[i] / 3];
      group_weight_[group] += angle;
      group_of_[corners[i]] = group;
    }
    for (std::size_t g = first_group; g < group_normals_.size(); ++g) {
      const double length = glm::length(group_normals_[g]);
      // facets back to back cancel, and what is left has no direction
      const bool cancelled = !(length > 1e-9 * group_weight_[g]);
      group_normals_[g] = cancelled ? group_first_[g] : group_normals_[g] / length;
    }
  }

  double corner_angle(std::uint32_t corner) const {
    const Triangle& t = mesh_.triangles[corner / 3];
    const Vec3& p = mesh_.positions[t[corner % 3]];
    return angle_between(mesh_.positions[t[(corner + 1) % 3]] - p,
                         mesh_.positions[t[(corner + 2) % 3]] - p);
  }

  // The group that a corner of a triangle without area takes: the first one at its place.
  std::uint32_t any_group(std::uint32_t v) const {
    const std::uint32_t begin = corners_.start[first_[v]];
    return begin == corners_.start[first_[v] + 1] ? kNone : group_of_[corners_.list[begin]];
  }

  // For each corner the first corner that can share its vertex: same vertex, same group.
  std::vector<std::uint32_t> leaders() {
    std::vector<std::uint32_t> start(mesh_.positions.size() + 2, 0);
    for (const Triangle& t : mesh_.triangles)
      for (const std::uint32_t v : t) ++start[v + 2];
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<std::uint32_t> list(start.back());
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t v = mesh_.triangles[i][k];
        list[start[v + 1]++] = 3 * i + k;
        if (group_of_[3 * i + k] == kNone) group_of_[3 * i + k] = any_group(v);
      }
    }
    std::vector<std::uint32_t> leader(list.size());
    for (std::size_t v = 0; v < mesh_.positions.size(); ++v) {
      const auto begin = list.begin() + start[v];
      const auto end = list.begin() + start[v + 1];
      std::sort(begin, end, [&](std::uint32_t a, std::uint32_t b) {
        return group_of_[a] != group_of_[b] ? group_of_[a] < group_of_[b] : a < b;
      });
      for (auto i = begin; i != end; ++i)
        leader[*i] = i != begin && group_of_[*i] == group_of_[i[-1]] ? leader[i[-1]] : *i;
    }
    return leader;
  }

  void emit() {
    const std::size_t originals = mesh_.positions.size();
    const std::vector<std::uint32_t> leader = leaders();
    std::vector<bool> used(originals, false);
    std::vector<std::uint32_t> group_at(originals, kNone);  // of each vertex, grows with them
    for (std::uint32_t corner = 0; corner < leader.size(); ++corner) {
      std::uint32_t& index = mesh_.triangles[corner / 3][corner % 3];
      const std::uint32_t first = leader[corner];
      if (first != corner) {
        // note: the leader has its final index already
        index = mesh_.triangles[first / 3][first % 3];
      } else if (!used[index]) {
        used[index] = true;
        group_at[index] = group_of_[corner];
      } else {
        index = copy_vertex(index);
        group_at.push_back(group_of_[corner]);
      }
    }
    mesh_.normals.resize(mesh_.positions.size());
    for (std::size_t v = 0; v < mesh_.normals.size(); ++v)
      mesh_.normals[v] = group_at[v] == kNone ? Vec3(0, 0, 1) : group_normals_[group_at[v]];
  }

  std::uint32_t copy_vertex(std::uint32_t v) {
    const auto copy = [v](auto& list) {
      if (list.empty()) return;
      const auto value = list[v];
      list.push_back(value);
    };
    copy(mesh_.positions);
    copy(mesh_.texcoords);
    copy(mesh_.colours);
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
  }

  Mesh& mesh_;
  double crease_;
  double cos_crease_;
  std::vector<std::uint32_t> first_;  // V
  std::vector<Vec3> facet_normals_;   // T, zero: no area
  Corners corners_;
  std::vector<std::uint32_t> group_of_;  // 3*T
  std::vector<Vec3> group_normals_;      // one for each group
  std::vector<double> group_weight_;
  std::vector<Vec3> group_first_;
  // scratch of one vertex
  std::vector<std::uint32_t> parent_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sides_;  // neighbour, corner at the vertex
  std::vector<std::pair<double, std::uint32_t>> fan_;
  std::vector<std::uint32_t> group_name_;
};

}  // namespace

void compute_normals(Mesh& mesh, double crease_angle) {
  assert(mesh.positions.size() + 3 * mesh.triangles.size() < 0xffffffffull);
  mesh.normals.clear();
  NormalBuilder(mesh, crease_angle).run();
}

}  // namespace panwright::geometry
