#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "base/parallel.h"
#include "geometry/internal/lists.h"
#include "geometry/internal/normals.h"
#include "geometry/internal/triangle.h"
#include "geometry/internal/weld.h"
#include "geometry/strip.h"

namespace panwright::geometry {

namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
// radians: what rounding may do to the angle of a right-angled crease
constexpr double kAngleSlack = 1e-9;
constexpr int kChainLimit = 16;
constexpr std::size_t kChunk = 1u << 13;   // triangles or vertices that a thread takes at once
constexpr std::size_t kRecent = 1u << 12;  // facets that a thread keeps

// What a corner adds to the normal of its vertex.
struct Corner {
  Vec3 normal;   // of its facet
  double angle;  // radians
};

// Facets that have area, with their angles. Neighbours in the mesh ask for the same ones within
// short time: those asked for last are kept, so that no list of all is needed.
class Facets {
 public:
  explicit Facets(const Mesh& mesh)
      : mesh_(mesh), recent_(std::bit_ceil(std::min(kRecent, mesh.triangles.size()))) {}

  Corner corner(std::uint32_t corner) {
    const std::uint32_t triangle = corner / 3;
    Facet& facet = recent_[triangle & (recent_.size() - 1)];
    if (facet.triangle != triangle) measure_facet(triangle, facet);
    return {facet.normal, facet.angles[corner % 3]};
  }

 private:
  struct Facet {
    std::uint32_t triangle = kNone;
    Vec3 normal;
    std::array<double, 3> angles;
  };

  void measure_facet(std::uint32_t i, Facet& facet) const {
    const Triangle& t = mesh_.triangles[i];
    const Vec3& a = mesh_.positions[t[0]];
    const Vec3& b = mesh_.positions[t[1]];
    const Vec3& c = mesh_.positions[t[2]];
    const TriangleMeasure m = measure(a, b, c);
    facet.triangle = i;
    facet.normal = m.cross / m.double_area;
    const std::array<Vec3, 3> side = {b - a, c - b, a - c};
    std::array<double, 3> cosine;  // · lengths of the sides
    for (std::size_t k = 0; k < 3; ++k) cosine[k] = -glm::dot(side[k], side[(k + 2) % 3]);
    // the largest angle is what the others leave
    std::size_t largest = 0;
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double squared = glm::dot(side[(k + 1) % 3], side[(k + 1) % 3]);
      if (squared > longest) largest = k;
      longest = std::max(longest, squared);
    }
    double rest = kPi;
    for (std::size_t k = 0; k < 3; ++k) {
      if (k == largest) continue;
      facet.angles[k] = det::atan2(m.double_area, cosine[k]);
      rest -= facet.angles[k];
    }
    facet.angles[largest] = rest;
  }

  const Mesh& mesh_;
  std::vector<Facet> recent_;
};

// The facets around the vertices of one chunk, joined where they are smooth.
//
//   Number  of a group at its vertex; the largest one stands for none
template <class Number>
class Fans {
 public:
  Fans(const Mesh& mesh, std::span<const std::uint32_t> place, const Lists& corners, double crease,
       std::vector<Number>& number_of)
      : mesh_(mesh),
        place_(place),
        corners_(corners),
        facets_(mesh),
        crease_(crease),
        cos_crease_(det::cos(std::min(kPi, crease + kAngleSlack))),
        number_of_(number_of) {}

  std::vector<Vec3> normals;  // one for each group

  // Facets that share an edge at this vertex are joined across it where it is smooth.
  void group_vertex(std::uint32_t v) {
    const std::span<const std::uint32_t> corners = corners_[v];
    const auto count = static_cast<std::uint32_t>(corners.size());
    if (count == 0) return;
    here_.clear();
    for (const std::uint32_t corner : corners) here_.push_back(facets_.corner(corner));
    parent_.resize(count);
    std::iota(parent_.begin(), parent_.end(), 0u);
    if (count > 1) join_all(corners, v);
    make_groups(corners);
  }

 private:
  std::uint32_t place(std::uint32_t corner, std::uint32_t step) const {
    const std::uint32_t k = corner % 3 + step;
    return place_[mesh_.triangles[corner / 3][k < 3 ? k : k - 3]];
  }

  void join_all(std::span<const std::uint32_t> corners, std::uint32_t v) {
    sides_.clear();
    for (std::uint32_t i = 0; i < corners.size(); ++i)
      for (const std::uint32_t step : {1u, 2u})
        sides_.push_back(std::uint64_t{place(corners[i], step)} << 32 | i);
    std::sort(sides_.begin(), sides_.end());
    for (std::size_t i = 0; i < sides_.size();) {
      std::size_t end = i + 1;
      while (end < sides_.size() && sides_[end] >> 32 == sides_[i] >> 32) ++end;
      if (end - i == 2)
        join_if_smooth(corner_of(i), corner_of(i + 1));
      else if (end - i > 2)
        join_fan(v, i, end);
      i = end;
    }
  }

  std::uint32_t corner_of(std::size_t side) const {
    return static_cast<std::uint32_t>(sides_[side]);
  }

  void join_if_smooth(std::uint32_t a, std::uint32_t b) {
    if (is_smooth(here_[a].normal, here_[b].normal)) join(a, b);
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

  // Many facets on one edge: their normals lie on a circle about it, and neighbours on the circle
  // decide for all pairs.
  void join_fan(std::uint32_t v, std::size_t begin, std::size_t end) {
    const Vec3 axis = glm::normalize(mesh_.positions[sides_[begin] >> 32] - mesh_.positions[v]);
    const Vec3 zero = here_[corner_of(begin)].normal;
    const Vec3 right = glm::cross(axis, zero);
    fan_.clear();
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& n = here_[corner_of(i)].normal;
      fan_.push_back({det::atan2(glm::dot(n, right), glm::dot(n, zero)), corner_of(i)});
    }
    std::sort(fan_.begin(), fan_.end());
    for (std::size_t i = 0; i < fan_.size(); ++i)
      join_if_smooth(fan_[i].second, fan_[(i + 1) % fan_.size()].second);
  }

  void make_groups(std::span<const std::uint32_t> corners) {
    name_.assign(corners.size(), kNone);
    const std::size_t before = normals.size();
    weight_.clear();
    first_.clear();
    for (std::uint32_t i = 0; i < corners.size(); ++i) {
      const std::uint32_t r = root(i);
      const auto& [facet, angle] = here_[i];
      if (name_[r] == kNone) {
        name_[r] = static_cast<std::uint32_t>(normals.size() - before);
        normals.push_back(Vec3(0));
        weight_.push_back(0);
        first_.push_back(i);
      }
      normals[before + name_[r]] += angle * facet;
      weight_[name_[r]] += angle;
      number_of_[corners[i]] = static_cast<Number>(name_[r]);
    }
    for (std::size_t g = before; g < normals.size(); ++g) {
      const double length = glm::length(normals[g]);
      // facets back to back cancel, and what is left has no direction
      const bool cancelled = !(length > 1e-9 * weight_[g - before]);
      normals[g] = cancelled ? here_[first_[g - before]].normal : normals[g] / length;
    }
  }

  const Mesh& mesh_;
  std::span<const std::uint32_t> place_;
  const Lists& corners_;
  Facets facets_;
  double crease_;
  double cos_crease_;
  std::vector<Number>& number_of_;
  // scratch of one vertex
  std::vector<Corner> here_;
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint64_t> sides_;  // neighbour · 2³² + corner at the vertex
  std::vector<std::pair<double, std::uint32_t>> fan_;
  std::vector<std::uint32_t> name_;
  std::vector<double> weight_;
  std::vector<std::uint32_t> first_;
};

template <class T>
void free_list(std::vector<T>& list) {
  list = std::vector<T>();
}

template <class Body>
void for_chunks(std::size_t count, const Body& body) {
  parallel_for((count + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    body(chunk, chunk * kChunk, std::min(count, (chunk + 1) * kChunk));
  });
}

// Of each place the corners of facets with area that stand there: 3·triangle + number.
Lists corners_by_place(const Mesh& mesh, std::span<const std::uint32_t> place) {
  std::vector<std::uint32_t> keys(3 * mesh.triangles.size());
  for_chunks(mesh.triangles.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Triangle& t = mesh.triangles[i];
      const bool has_area =
          !measure(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]).degenerate();
      for (std::size_t k = 0; k < 3; ++k) keys[3 * i + k] = has_area ? place[t[k]] : kNoKey;
    }
  });
  return lists_by(keys, mesh.positions.size());
}

// note: lists go as soon as they have served, as they are larger than the mesh.
template <class Number>
class NormalBuilder {
 public:
  NormalBuilder(Mesh& mesh, double crease, std::span<const std::uint32_t> place)
      : mesh_(mesh), crease_(crease), place_(place) {}

  void run(Lists corners) {
    group(std::move(corners));
    emit();
    write_normals();
  }

 private:
  static constexpr Number kNoNumber = std::numeric_limits<Number>::max();

  // Groups are numbered in order of their vertices, whichever thread finds them.
  void group(Lists corners) {
    number_of_.assign(3 * mesh_.triangles.size(), kNoNumber);
    const std::size_t count = mesh_.positions.size();
    first_group_.assign(count, kNone);
    std::vector<std::vector<Vec3>> parts((count + kChunk - 1) / kChunk);
    for_chunks(count, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
      Fans<Number> fans(mesh_, place_, corners, crease_, number_of_);
      fans.normals.reserve(end - begin);
      for (std::size_t v = begin; v < end; ++v) {
        if (!corners[v].empty()) first_group_[v] = static_cast<std::uint32_t>(fans.normals.size());
        fans.group_vertex(static_cast<std::uint32_t>(v));
      }
      parts[chunk] = std::move(fans.normals);
    });
    corners = {};
    if (parts.size() == 1) {
      group_normals_ = std::move(parts[0]);
      return;
    }
    std::vector<std::size_t> base(parts.size() + 1, 0);
    for (std::size_t i = 0; i < parts.size(); ++i) base[i + 1] = base[i] + parts[i].size();
    group_normals_.resize(base.back());
    for_chunks(count, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
      std::copy(parts[chunk].begin(), parts[chunk].end(),
                group_normals_.begin() + static_cast<std::ptrdiff_t>(base[chunk]));
      free_list(parts[chunk]);
      for (std::size_t v = begin; v < end; ++v)
        if (first_group_[v] != kNone) first_group_[v] += static_cast<std::uint32_t>(base[chunk]);
    });
  }

  // Corners of triangles without area take the first group at their place.
  std::uint32_t group_of(std::uint32_t v, std::size_t corner) const {
    const std::uint32_t first = first_group_[place_[v]];
    const Number number = number_of_[corner];
    return number == kNoNumber ? first : first + number;
  }

  // The vertex that corners of vertex v with this group share: v itself for the first group that
  // uses it, then copies.
  std::uint32_t vertex_for(std::uint32_t v, std::uint32_t group) {
    if (!used_[v]) {
      used_[v] = true;
      group_at_[v] = group;
      return v;
    }
    std::uint32_t last = v;
    for (int steps = 0; steps < kChainLimit; ++steps) {
      if (group_at_[last] == group) return last;
      if (next_[last] == kNone) return next_[last] = make_copy(v, group);
      last = next_[last];
    }
    // so many groups at one place are found by their number
    const auto [found, added] = copies_.emplace(std::uint64_t{v} << 32 | group, kNone);
    if (added) found->second = make_copy(v, group);
    return found->second;
  }

  std::uint32_t make_copy(std::uint32_t v, std::uint32_t group) {
    group_at_.push_back(group);
    next_.push_back(kNone);
    return copy_vertex(v);
  }

  void emit() {
    const std::size_t originals = mesh_.positions.size();
    used_.assign(originals, false);
    group_at_.assign(originals, kNone);
    next_.assign(originals, kNone);
    std::size_t corner = 0;
    for (Triangle& t : mesh_.triangles)
      for (std::uint32_t& v : t) v = vertex_for(v, group_of(v, corner++));
    free_list(number_of_);
    free_list(first_group_);
    free_list(used_);
    free_list(next_);
    copies_.clear();
  }

  void write_normals() {
    const std::size_t count = mesh_.positions.size();
    bool in_place = group_normals_.size() == count;
    for (std::size_t v = 0; v < count && in_place; ++v) in_place = group_at_[v] == v;
    if (in_place) {
      mesh_.normals = std::move(group_normals_);
      return;
    }
    mesh_.normals.resize(count);
    for_chunks(count, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v)
        mesh_.normals[v] = group_at_[v] == kNone ? Vec3(0, 0, 1) : group_normals_[group_at_[v]];
    });
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
  std::span<const std::uint32_t> place_;    // V
  std::vector<Number> number_of_;           // 3*T, of the groups at a place; kNoNumber: no area
  std::vector<std::uint32_t> first_group_;  // of each place, kNone: no facet with area
  std::vector<Vec3> group_normals_;         // one for each group
  std::vector<char> used_;                  // of each vertex that was there
  std::vector<std::uint32_t> group_at_;     // of each vertex, grows with them
  std::vector<std::uint32_t> next_;         // copy of the same vertex
  std::unordered_map<std::uint64_t, std::uint32_t> copies_;
};

}  // namespace

void compute_normals(Mesh& mesh, double crease_angle) {
  compute_normals(mesh, crease_angle, welded(mesh.positions));
}

void compute_normals(Mesh& mesh, double crease_angle, std::span<const std::uint32_t> place) {
  assert(mesh.positions.size() + 3 * mesh.triangles.size() < 0xffffffffull);
  free_list(mesh.normals);
  const double crease = std::clamp(crease_angle, 0.0, kPi);
  Lists corners = corners_by_place(mesh, place);
  std::uint32_t most = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    most = std::max(most, corners.start[v + 1] - corners.start[v]);
  if (most <= std::numeric_limits<std::uint8_t>::max())
    NormalBuilder<std::uint8_t>(mesh, crease, place).run(std::move(corners));
  else
    NormalBuilder<std::uint32_t>(mesh, crease, place).run(std::move(corners));
}

}  // namespace panwright::geometry
