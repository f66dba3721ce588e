// Catmull-Clark subdivision by its published rules, one level after another, with limits by masks:
// shares nothing with geometry/. For tests and benches.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/tessellate/shape.h"

namespace panwright::oracles {

// Cage at some level. Vertices keep their numbers from level to level.
class CatmullClark {
 public:
  static constexpr double kInfinite = std::numeric_limits<double>::infinity();

  explicit CatmullClark(const geometry::Subdiv& shape) : positions_(shape.positions) {
    for (const auto& face : shape.faces) faces_.push_back(face.outline);
    const auto sharpness = [](double s) {
      // kept in single precision
      return s >= geometry::kInfinitelySharp ? kInfinite
                                             : static_cast<double>(static_cast<float>(s));
    };
    for (const auto& crease : shape.creases)
      for (std::size_t i = 0; i + 1 < crease.path.size(); ++i) {
        double& s = sharp_edges_[key(crease.path[i], crease.path[i + 1])];
        s = std::max(s, sharpness(crease.sharpness));
      }
    sharp_vertices_.resize(positions_.size(), 0);
    for (const auto& corner : shape.corners)
      for (const std::uint32_t v : corner.vertices)
        sharp_vertices_[v] = std::max(sharp_vertices_[v], sharpness(corner.sharpness));
    connect();
    for (auto& [edge, about] : edges_)
      if (about.faces.size() == 1) sharp_edges_[edge] = kInfinite;
    if (shape.smooth_border) return;
    for (std::size_t v = 0; v < positions_.size(); ++v)
      if (vertex_faces_[v].size() == 1) sharp_vertices_[v] = kInfinite;
  }

  const std::vector<Vec3>& positions() const { return positions_; }
  const std::vector<std::vector<std::uint32_t>>& faces() const { return faces_; }

  // One level: face points, edge points, vertex points.
  CatmullClark refined() const {
    CatmullClark out(*this);
    const auto v_count = static_cast<std::uint32_t>(positions_.size());
    std::vector<Vec3> centres;
    for (const auto& face : faces_) {
      Vec3 sum(0);
      for (const std::uint32_t v : face) sum += positions_[v];
      centres.push_back(sum / static_cast<double>(face.size()));
    }
    std::map<Key, std::uint32_t> edge_number;
    out.positions_.assign(v_count, Vec3(0));
    out.sharp_edges_.clear();
    for (const auto& [edge, about] : edges_) {
      const double s = edge_sharpness(edge);
      const Vec3 middle = 0.5 * (positions_[edge.first] + positions_[edge.second]);
      Vec3 smooth = middle;
      if (about.faces.size() == 2)
        smooth = 0.5 * middle + 0.25 * (centres[about.faces[0]] + centres[about.faces[1]]);
      const double share = std::min(s, 1.0);
      edge_number[edge] = static_cast<std::uint32_t>(out.positions_.size());
      out.positions_.push_back(share * middle + (1 - share) * smooth);
    }
    const auto first_centre = static_cast<std::uint32_t>(out.positions_.size());
    out.positions_.insert(out.positions_.end(), centres.begin(), centres.end());
    for (std::uint32_t v = 0; v < v_count; ++v) out.positions_[v] = vertex_point(v, centres);
    out.sharp_vertices_.assign(out.positions_.size(), 0);
    for (std::uint32_t v = 0; v < v_count; ++v) out.sharp_vertices_[v] = less(sharp_vertices_[v]);
    for (const auto& [edge, about] : edges_) {
      const double s = less(edge_sharpness(edge));
      if (!(s > 0)) continue;
      out.sharp_edges_[key(edge.first, edge_number[edge])] = s;
      out.sharp_edges_[key(edge.second, edge_number[edge])] = s;
    }
    out.faces_.clear();
    for (std::uint32_t f = 0; f < faces_.size(); ++f) {
      const auto& face = faces_[f];
      const std::size_t n = face.size();
      for (std::size_t i = 0; i < n; ++i)
        out.faces_.push_back({face[i], edge_number[key(face[i], face[(i + 1) % n])],
                              first_centre + f, edge_number[key(face[(i + n - 1) % n], face[i])]});
    }
    out.connect();
    return out;
  }

  CatmullClark refined(int levels) const {
    CatmullClark out(*this);
    for (int i = 0; i < levels; ++i) out = out.refined();
    return out;
  }

  // Limits of the vertices, for which all faces have four sides and sharpness is 0 or infinite.
  std::vector<Vec3> limits() const {
    std::vector<Vec3> out(positions_);
    for (std::uint32_t v = 0; v < positions_.size(); ++v) {
      if (vertex_faces_[v].empty()) continue;
      const Rule rule = rule_of(v, false);
      if (rule == Rule::corner) continue;
      if (rule == Rule::crease) {
        Vec3 ends(0);
        for (const std::uint32_t other : sharp_neighbours(v, false)) ends += positions_[other];
        out[v] = (4.0 * positions_[v] + ends) / 6.0;
        continue;
      }
      if (!sharp_neighbours(v, false).empty()) {
        out[v] = ring_of(v).limit;  // a dart, which has no mask
        continue;
      }
      const auto n = static_cast<double>(vertex_faces_[v].size());
      Vec3 edges(0), corners(0);
      for (const std::uint32_t other : neighbours_[v]) edges += positions_[other];
      for (const std::uint32_t f : vertex_faces_[v]) {
        const auto& face = faces_[f];
        const auto at = std::find(face.begin(), face.end(), v) - face.begin();
        corners += positions_[face[static_cast<std::size_t>(at + 2) % 4]];
      }
      out[v] = (n * n * positions_[v] + 4.0 * edges + corners) / (n * (n + 5));
    }
    return out;
  }

  bool is_decayed() const {
    const auto finite = [](double s) { return s > 0 && s < kInfinite; };
    for (const auto& [edge, s] : sharp_edges_)
      if (finite(s)) return false;
    return std::none_of(sharp_vertices_.begin(), sharp_vertices_.end(), finite);
  }

  // The limits of the vertices of this level.
  std::vector<Vec3> pushed() const {
    CatmullClark fine = refined();
    while (!fine.is_decayed()) fine = fine.refined();
    std::vector<Vec3> out = fine.limits();
    out.resize(positions_.size());
    return out;
  }

  // Returns those of used vertices.
  std::vector<Vec3> pushed_used() const {
    const std::vector<Vec3> all = pushed();
    std::vector<Vec3> out;
    for (std::size_t v = 0; v < all.size(); ++v)
      if (!vertex_faces_[v].empty()) out.push_back(all[v]);
    return out;
  }

  // Triangles over the limits of the vertices.
  geometry::Mesh limit_mesh() const {
    geometry::Mesh mesh;
    mesh.positions = pushed();
    for (const auto& face : faces_) {
      mesh.triangles.push_back({face[0], face[1], face[2]});
      mesh.triangles.push_back({face[0], face[2], face[3]});
    }
    return mesh;
  }

  // Result about a vertex of repeatedly refining only its faces, for which no mask is needed.
  // Expects: sharpness 0 or infinite.
  struct Ring {
    Vec3 limit{0};
    std::vector<Vec3> normals;  // of the faces, those between two sharp edges as one
    bool corner = false;        // tangents need not span a plane
  };
  Ring ring_of(std::uint32_t v, int levels = 120) const {
    Ring out;
    out.corner = rule_of(v, false) == Rule::corner;
    CatmullClark ring(*this);
    double scale = 1;
    for (int level = 0; level < levels; ++level) {
      CatmullClark some = ring.faces_about(level == 0 ? v : 0);
      double size = 0;
      const Vec3 centre = some.positions_[0];
      for (Vec3& p : some.positions_) {
        p -= centre;
        size = std::max(size, glm::length(p));
      }
      for (Vec3& p : some.positions_) p /= size;
      out.limit += scale * centre;
      scale *= size;
      ring = some.refined();
    }
    out.limit += scale * ring.positions_[0];
    std::map<std::uint32_t, std::uint32_t> group;  // by face, the least face of its sector
    for (const std::uint32_t f : ring.vertex_faces_[0]) group[f] = f;
    for (std::size_t round = 0; round < group.size(); ++round)
      for (const auto& [edge, about] : ring.edges_) {
        if (edge.first != 0 || about.faces.size() != 2 || ring.edge_sharpness(edge) > 0) continue;
        const std::uint32_t least = std::min(group[about.faces[0]], group[about.faces[1]]);
        group[about.faces[0]] = group[about.faces[1]] = least;
      }
    std::map<std::uint32_t, Vec3> sums;
    for (const auto& [f, least] : group) {
      const auto& face = ring.faces_[f];
      const auto at =
          static_cast<std::size_t>(std::find(face.begin(), face.end(), 0u) - face.begin());
      const Vec3& p = ring.positions_[0];
      sums[least] += glm::cross(ring.positions_[face[(at + 1) % 4]] - p,
                                ring.positions_[face[(at + 3) % 4]] - p);
    }
    for (const auto& [f, sum] : sums) out.normals.push_back(glm::normalize(sum));
    // the two sides of a single face between creases turn in a plane, from the first level on
    if (levels > 2 && vertex_faces_[v].size() > 0) {
      const Ring first = ring_of(v, 1);
      std::map<std::uint32_t, int> faces;
      for (const auto& [f, least] : group) ++faces[least];
      std::size_t number = 0;
      for (const auto& [least, count] : faces) {
        if (count == 1) out.normals[number] = first.normals[number];
        ++number;
      }
    }
    return out;
  }

 private:
  using Key = std::pair<std::uint32_t, std::uint32_t>;
  enum class Rule { smooth, crease, corner };
  struct Edge {
    std::vector<std::uint32_t> faces;
  };

  static Key key(std::uint32_t a, std::uint32_t b) { return std::minmax(a, b); }
  static double less(double s) { return s == kInfinite ? s : std::max(0.0, s - 1); }

  double edge_sharpness(const Key& edge) const {
    const auto found = sharp_edges_.find(edge);
    return found == sharp_edges_.end() ? 0 : found->second;
  }

  void connect() {
    edges_.clear();
    vertex_faces_.assign(positions_.size(), {});
    neighbours_.assign(positions_.size(), {});
    for (std::uint32_t f = 0; f < faces_.size(); ++f) {
      const auto& face = faces_[f];
      for (std::size_t i = 0; i < face.size(); ++i) {
        edges_[key(face[i], face[(i + 1) % face.size()])].faces.push_back(f);
        vertex_faces_[face[i]].push_back(f);
      }
    }
    for (const auto& [edge, about] : edges_) {
      neighbours_[edge.first].push_back(edge.second);
      neighbours_[edge.second].push_back(edge.first);
    }
  }

  // Returns only the faces about a vertex, which becomes vertex 0.
  CatmullClark faces_about(std::uint32_t v) const {
    CatmullClark some(*this);
    some.positions_.clear();
    some.faces_.clear();
    some.sharp_edges_.clear();
    std::map<std::uint32_t, std::uint32_t> number;
    const auto numbered = [&](std::uint32_t w) {
      const auto [at, added] =
          number.emplace(w, static_cast<std::uint32_t>(some.positions_.size()));
      if (added) some.positions_.push_back(positions_[w]);
      return at->second;
    };
    numbered(v);
    for (const std::uint32_t f : vertex_faces_[v]) {
      some.faces_.emplace_back();
      for (const std::uint32_t w : faces_[f]) some.faces_.back().push_back(numbered(w));
    }
    for (const auto& [edge, s] : sharp_edges_)
      if (number.contains(edge.first) && number.contains(edge.second))
        some.sharp_edges_[key(number[edge.first], number[edge.second])] = s;
    some.sharp_vertices_.assign(some.positions_.size(), 0);
    some.sharp_vertices_[0] = sharp_vertices_[v];
    some.connect();
    return some;
  }

  std::vector<std::uint32_t> sharp_neighbours(std::uint32_t v, bool next_level) const {
    std::vector<std::uint32_t> out;
    for (const std::uint32_t other : neighbours_[v]) {
      const double s = edge_sharpness(key(v, other));
      if ((next_level ? less(s) : s) > 0) out.push_back(other);
    }
    return out;
  }

  Rule rule_of(std::uint32_t v, bool next_level) const {
    const double s = sharp_vertices_[v];
    if ((next_level ? less(s) : s) > 0) return Rule::corner;
    const std::size_t count = sharp_neighbours(v, next_level).size();
    return count < 2 ? Rule::smooth : count == 2 ? Rule::crease : Rule::corner;
  }

  Vec3 by_rule(std::uint32_t v, Rule rule, bool next_level,
               const std::vector<Vec3>& centres) const {
    const Vec3& p = positions_[v];
    if (rule == Rule::corner) return p;
    if (rule == Rule::crease) {
      Vec3 ends(0);
      for (const std::uint32_t other : sharp_neighbours(v, next_level)) ends += positions_[other];
      return 0.75 * p + 0.125 * ends;
    }
    const auto n = static_cast<double>(vertex_faces_[v].size());
    Vec3 edges(0), faces(0);
    for (const std::uint32_t other : neighbours_[v]) edges += positions_[other];
    for (const std::uint32_t f : vertex_faces_[v]) faces += centres[f];
    return ((n - 2) / n) * p + edges / (n * n) + faces / (n * n);
  }

  Vec3 vertex_point(std::uint32_t v, const std::vector<Vec3>& centres) const {
    if (vertex_faces_[v].empty()) return positions_[v];
    const Rule now = rule_of(v, false), next = rule_of(v, true);
    const Vec3 here = by_rule(v, now, false, centres);
    if (now == next) return here;
    // the mean of the creases ending here, DeRose, Kass and Truong as in OpenSubdiv
    double sum = 0;
    int count = 0;
    const auto look_at = [&](double s) {
      if (s > 0 && less(s) == 0) sum += s, ++count;
    };
    look_at(sharp_vertices_[v]);
    for (const std::uint32_t other : neighbours_[v]) look_at(edge_sharpness(key(v, other)));
    const double share = std::min(1.0, sum / count);
    return share * here + (1 - share) * by_rule(v, next, true, centres);
  }

  std::vector<Vec3> positions_;
  std::vector<std::vector<std::uint32_t>> faces_;
  std::map<Key, double> sharp_edges_;
  std::vector<double> sharp_vertices_;
  std::map<Key, Edge> edges_;
  std::vector<std::vector<std::uint32_t>> vertex_faces_;
  std::vector<std::vector<std::uint32_t>> neighbours_;
};

}  // namespace panwright::oracles
