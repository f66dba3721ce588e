#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "base/parallel.h"
#include "geometry/internal/compressed_rows.h"
#include "geometry/internal/limits.h"
#include "geometry/internal/triangle.h"
#include "geometry/internal/weld.h"
#include "geometry/mesh/internal/normals.h"
#include "geometry/mesh/strip.h"

namespace panwright::geometry {

namespace {

constexpr int kChainLimit = 16;
constexpr std::size_t kNormalChunk = 1u << 13;  // triangles or vertices that a thread takes at once
constexpr std::size_t kParts = 8;               // of the vertices
constexpr std::size_t kRecent = 1u << 12;       // facets that a thread keeps

// What a corner adds to the normal of its vertex.
struct Corner {
  Vec3 normal;   // of its facet
  double angle;  // radians
};

// Facets that have area, with their angles. Neighbours in the mesh use the same ones within
// short time: the last ones used are cached, so that no list of all is needed.
class Facets {
 public:
  explicit Facets(const Mesh& mesh)
      : mesh_(mesh), recent_(std::bit_ceil(std::min(kRecent, mesh.triangles.size()))) {}

  Corner corner(std::uint32_t corner) {
    const std::uint32_t triangle = corner / 3;
    Facet& facet = recent_[triangle & (recent_.size() - 1)];
    if (facet.triangle != triangle) measure_microfacets(triangle, facet);
    return {facet.normal, facet.angles[corner % 3]};
  }

 private:
  struct Facet {
    std::uint32_t triangle = kNone;
    Vec3 normal;
    std::array<double, 3> angles;
  };

  void measure_microfacets(std::uint32_t i, Facet& facet) const {
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
//   Number  of a group at its vertex; the largest one means none
template <class Number>
class Fans {
 public:
  Fans(const Mesh& mesh, std::span<const std::uint32_t> position_of, double crease,
       std::vector<Number>& number_of)
      : mesh_(mesh),
        position_of_(position_of),
        microfacets_(mesh),
        crease_(crease),
        cos_crease_(det::cos(std::min(kPi, crease + kAngleSlack))),
        number_of_(number_of) {}

  std::vector<Vec3> normals;  // one per group

  // Facets that share an edge at this vertex are joined across it where it is smooth.
  void group_vertex(std::uint32_t v, std::span<const std::uint32_t> corners) {
    const auto count = static_cast<std::uint32_t>(corners.size());
    if (count == 0) return;
    here_.clear();
    for (const std::uint32_t corner : corners) here_.push_back(microfacets_.corner(corner));
    parent_.resize(count);
    std::iota(parent_.begin(), parent_.end(), 0u);
    if (count > 1) join_all(corners, v);
    make_groups(corners);
  }

 private:
  std::uint32_t position(std::uint32_t corner, std::uint32_t step) const {
    const std::uint32_t k = corner % 3 + step;
    return position_of_[mesh_.triangles[corner / 3][k < 3 ? k : k - 3]];
  }

  void join_all(std::span<const std::uint32_t> corners, std::uint32_t v) {
    sides_.clear();
    for (std::uint32_t i = 0; i < corners.size(); ++i)
      for (const std::uint32_t step : {1u, 2u})
        sides_.push_back(std::uint64_t{position(corners[i], step)} << 32 | i);
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
  std::span<const std::uint32_t> position_of_;
  Facets microfacets_;
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
void for_ranges(std::size_t count, const Body& body) {
  parallel_for((count + kNormalChunk - 1) / kNormalChunk, [&](std::size_t chunk) {
    body(chunk, chunk * kNormalChunk, std::min(count, (chunk + 1) * kNormalChunk));
  });
}

// note: lists go as soon as they have served, as they are larger than the mesh.
template <class Number>
class NormalBuilder {
 public:
  NormalBuilder(Mesh& mesh, double crease, std::span<const std::uint32_t> position_of)
      : mesh_(mesh), crease_(crease), position_of_(position_of) {}

  // False, and nothing is done: there are more facets at a position than numbers.
  bool run() {
    find_areas();
    if (!group()) return false;
    emit();
    write_normals();
    return true;
  }

 private:
  static constexpr Number kNoNumber = std::numeric_limits<Number>::max();

  // The unique positions at which a chunk of triangles has corners.
  struct Reach {
    std::uint32_t low = kNone;
    std::uint32_t high = 0;
  };

  // Marks the corners of facets that have area.
  void find_areas() {
    const std::size_t count = mesh_.triangles.size();
    number_of_.assign(3 * count, kNoNumber);
    reach_.resize((count + kNormalChunk - 1) / kNormalChunk);
    for_ranges(count, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
      Reach reach;
      for (std::size_t i = begin; i < end; ++i) {
        const Triangle& t = mesh_.triangles[i];
        const std::vector<Vec3>& p = mesh_.positions;
        if (measure(p[t[0]], p[t[1]], p[t[2]]).degenerate()) continue;
        for (std::size_t k = 0; k < 3; ++k) {
          number_of_[3 * i + k] = 0;
          reach.low = std::min(reach.low, position_of_[t[k]]);
          reach.high = std::max(reach.high, position_of_[t[k]]);
        }
      }
      reach_[chunk] = reach;
    });
  }

  // Calls body(position, corner) for those at positions [begin, end), in ascending order.
  template <class Body>
  void for_corners(std::uint32_t begin, std::uint32_t end, const Body& body) const {
    for (std::size_t chunk = 0; chunk < reach_.size(); ++chunk) {
      // mostly, neighbours in the list of triangles are neighbours in that of vertices
      if (reach_[chunk].high < begin || reach_[chunk].low >= end) continue;
      const std::size_t last = std::min(mesh_.triangles.size(), (chunk + 1) * kNormalChunk);
      for (std::size_t i = chunk * kNormalChunk; i < last; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t position = position_of_[mesh_.triangles[i][k]];
          if (position - begin < end - begin && number_of_[3 * i + k] != kNoNumber)
            body(position, static_cast<std::uint32_t>(3 * i + k));
        }
      }
    }
  }

  CompressedRows corners_at(std::uint32_t begin, std::uint32_t end) const {
    CompressedRows rows;
    std::vector<std::uint32_t>& start = rows.start;
    start.assign(end - begin + 2, 0);
    for_corners(begin, end,
                [&](std::uint32_t position, std::uint32_t) { ++start[position - begin + 2]; });
    for (std::size_t i = 2; i < start.size(); ++i) start[i] += start[i - 1];
    rows.items.resize(start.back());
    for_corners(begin, end, [&](std::uint32_t position, std::uint32_t corner) {
      rows.items[start[position - begin + 1]++] = corner;
    });
    start.pop_back();
    return rows;
  }

  // Groups are numbered in order of their vertices, whichever thread finds them. A part of the
  // vertices after the other, so that there is no list of all corners.
  bool group() {
    const std::size_t tasks = mesh_.triangles.size() < kNormalChunk ? 1 : kParts;
    first_group_.assign(mesh_.positions.size(), kNone);
    group_normals_.resize(mesh_.positions.size());
    std::vector<std::size_t> base(tasks + 1, 0);  // of each part, the groups before it
    std::vector<std::vector<Vec3>> parts(tasks);  // those of more groups than positions
    std::atomic<bool> fits = true;
    parallel_for(tasks, [&](std::size_t i) {
      const std::uint32_t begin = bound(i, tasks);
      const std::uint32_t end = bound(i + 1, tasks);
      const CompressedRows corners = corners_at(begin, end);
      for (std::uint32_t v = begin; v < end; ++v)
        if (corners[v - begin].size() > kNoNumber) fits = false;
      if (!fits) return;
      Fans<Number> fans(mesh_, position_of_, crease_, number_of_);
      fans.normals.reserve(end - begin);
      for (std::uint32_t v = begin; v < end; ++v) {
        if (corners[v - begin].empty()) continue;
        first_group_[v] = static_cast<std::uint32_t>(fans.normals.size());
        fans.group_vertex(v, corners[v - begin]);
      }
      base[i + 1] = fans.normals.size();
      if (fans.normals.size() > end - begin)
        parts[i] = std::move(fans.normals);
      else
        std::copy(fans.normals.begin(), fans.normals.end(), group_normals_.begin() + begin);
    });
    if (!fits) return false;
    for (std::size_t i = 0; i < tasks; ++i) base[i + 1] += base[i];
    join(base, parts);
    return true;
  }

  // The first vertex of a part.
  std::uint32_t bound(std::size_t i, std::size_t tasks) const {
    return static_cast<std::uint32_t>(mesh_.positions.size() * i / tasks);
  }

  // Puts the groups of all parts behind one another.
  void join(const std::vector<std::size_t>& base, std::vector<std::vector<Vec3>>& parts) {
    const bool more = std::ranges::any_of(parts, [](const auto& part) { return !part.empty(); });
    std::vector<Vec3> joined(more ? base.back() : 0);
    Vec3* const to = more ? joined.data() : group_normals_.data();
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::uint32_t begin = bound(i, parts.size());
      const Vec3* const from = parts[i].empty() ? group_normals_.data() + begin : parts[i].data();
      if (from != to + base[i]) std::copy(from, from + (base[i + 1] - base[i]), to + base[i]);
      free_list(parts[i]);
      for (std::uint32_t v = begin; v < bound(i + 1, parts.size()); ++v)
        if (first_group_[v] != kNone) first_group_[v] += static_cast<std::uint32_t>(base[i]);
    }
    if (more) group_normals_ = std::move(joined);
    group_normals_.resize(base.back());
  }

  // Corners of triangles without area take the first group at their position.
  std::uint32_t group_of(std::uint32_t v, std::size_t corner) const {
    const std::uint32_t first = first_group_[position_of_[v]];
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
    // so many groups at one position are found by their number
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
    for_ranges(count, [&](std::size_t, std::size_t begin, std::size_t end) {
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
    copy(mesh_.colors);
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
  }

  Mesh& mesh_;
  double crease_;
  std::span<const std::uint32_t> position_of_;  // V
  std::vector<Number> number_of_;           // 3*T, of the groups at a position; kNoNumber: no area
  std::vector<Reach> reach_;                // of each chunk of triangles
  std::vector<std::uint32_t> first_group_;  // of each position, kNone: no facet with area
  std::vector<Vec3> group_normals_;         // one per group
  std::vector<char> used_;                  // of each vertex that was there
  std::vector<std::uint32_t> group_at_;     // of each vertex, grows with them
  std::vector<std::uint32_t> next_;         // copy of the same vertex
  std::unordered_map<std::uint64_t, std::uint32_t> copies_;
};

}  // namespace

void compute_normals(Mesh& mesh, double crease_angle) {
  compute_normals(mesh, crease_angle, welded(mesh.positions));
}

void compute_normals(Mesh& mesh, double crease_angle, std::span<const std::uint32_t> position_of) {
  assert(mesh.positions.size() + 3 * mesh.triangles.size() < 0xffffffffull);
  free_list(mesh.normals);
  const double crease = std::clamp(crease_angle, 0.0, kPi);
  if (!NormalBuilder<std::uint8_t>(mesh, crease, position_of).run())
    NormalBuilder<std::uint32_t>(mesh, crease, position_of).run();
}

}  // namespace panwright::geometry
