#include "geometry/mesh/clean.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/axis_box.h"
#include "base/parallel.h"
#include "geometry/internal/deduplicate.h"
#include "geometry/internal/triangle.h"
#include "geometry/internal/weld.h"
#include "geometry/mesh/internal/boundary_loops.h"
#include "geometry/mesh/internal/clean_orient.h"
#include "geometry/mesh/internal/edges.h"
#include "geometry/mesh/internal/normals.h"
#include "geometry/mesh/internal/reorder.h"
#include "geometry/mesh/internal/tjunction.h"
#include "geometry/mesh/strip.h"

namespace panwright::geometry {

namespace {

constexpr std::size_t kCleanChunk = 1u << 14;
// of the diagonal: the resolution of positions in single precision
constexpr double kJunction = 1e-6;

template <class Body>
void for_each_index(std::size_t count, const Body& body) {
  parallel_for((count + kCleanChunk - 1) / kCleanChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(count, (chunk + 1) * kCleanChunk);
    for (std::size_t i = chunk * kCleanChunk; i < end; ++i) body(i);
  });
}

template <class V>
std::uint64_t hashed(std::uint64_t h, const V& v) {
  for (typename V::length_type i = 0; i < v.length(); ++i)
    h = hash_step(h, std::bit_cast<std::uint64_t>(v[i] + 0.0));
  return h;
}

class Cleaner {
 public:
  Cleaner(Mesh& mesh, const CleanOptions& options, const Job& job)
      : mesh_(mesh), options_(options), job_(job) {}

  CleanReport run() {
    report_.vertices_before = mesh_.positions.size();
    report_.triangles_before = mesh_.triangles.size();
    if (!options_.keep_normals) mesh_.normals = std::vector<Vec3>();
    weld();
    if (options_.drop_degenerate) drop_collapsed();
    if (options_.drop_duplicates) drop_duplicates();
    job_.poll();
    edges_ = edges_of(mesh_, unique_position_);
    if (options_.drop_degenerate) drop_slivers();
    job_.poll();
    turn();
    if (options_.orient && !mesh_.normals.empty()) turn_normals();
    job_.poll();
    examine();
    job_.poll();
    mesh_.closed = !mesh_.triangles.empty() && edges_.border.empty() && edges_.many.empty() &&
                   edges_.misoriented == 0 && has_edges();
    mesh_.error += report_.largest_move;
    // frees memory for the next step
    edges_ = {};
    piece_of_ = std::vector<std::uint32_t>();
    if (mesh_.normals.empty()) compute_normals(mesh_, options_.crease_angle, unique_position_);
    unique_position_ = std::vector<std::uint32_t>();
    job_.poll();
    if (options_.reorder) reorder_triangles(mesh_);
    compact_vertices(mesh_, !options_.reorder);
    report_.vertices_after = mesh_.positions.size();
    report_.triangles_after = mesh_.triangles.size();
    return std::move(report_);
  }

 private:
  void weld() {
    unique_position_ = welded_within(mesh_.positions, options_.weld ? options_.tolerance : 0);
    if (!options_.weld) return;
    if (options_.tolerance > 0) {
      double largest = 0;
      for (std::size_t v = 0; v < unique_position_.size(); ++v) {
        const Vec3 off = mesh_.positions[unique_position_[v]] - mesh_.positions[v];
        largest = std::max(largest, glm::dot(off, off));
      }
      report_.largest_move = std::sqrt(largest);
      for (std::size_t v = 0; v < unique_position_.size(); ++v)
        mesh_.positions[v] = mesh_.positions[unique_position_[v]];
    }
    const bool plain = mesh_.normals.empty() && mesh_.texcoords.empty() && mesh_.colors.empty();
    std::vector<std::uint32_t> seams;
    if (!plain) seams = same_vertices();
    const std::vector<std::uint32_t>& first = plain ? unique_position_ : seams;
    for (std::size_t v = 0; v < first.size(); ++v) report_.welded += first[v] != v;
    if (report_.welded == 0) return;
    for_each_index(mesh_.triangles.size(), [&](std::size_t i) {
      for (std::uint32_t& v : mesh_.triangles[i]) v = first[v];
    });
  }

  // For each vertex the first one with the same position and attributes.
  std::vector<std::uint32_t> same_vertices() const {
    const auto hash = [&](std::uint32_t v) {
      std::uint64_t h = hash_step(kHashSeed, unique_position_[v]);
      if (!mesh_.normals.empty()) h = hashed(h, mesh_.normals[v]);
      if (!mesh_.texcoords.empty()) h = hashed(h, mesh_.texcoords[v]);
      if (!mesh_.colors.empty()) h = hashed(h, mesh_.colors[v]);
      return hash_end(h);
    };
    const auto equal = [&](std::uint32_t a, std::uint32_t b) {
      return unique_position_[a] == unique_position_[b] &&
             (mesh_.normals.empty() || mesh_.normals[a] == mesh_.normals[b]) && same_look(a, b);
    };
    auto first = deduplicate(unique_position_.size(), hash, equal);
    if (first) return std::move(*first);
    // adversarial hashes: no vertices are merged
    std::vector<std::uint32_t> none(unique_position_.size());
    std::iota(none.begin(), none.end(), 0u);
    return none;
  }

  bool same_look(std::uint32_t a, std::uint32_t b) const {
    return (mesh_.texcoords.empty() || mesh_.texcoords[a] == mesh_.texcoords[b]) &&
           (mesh_.colors.empty() || mesh_.colors[a] == mesh_.colors[b]);
  }

  std::array<std::uint32_t, 3> unique_positions(std::size_t triangle) const {
    const Triangle& t = mesh_.triangles[triangle];
    return {unique_position_[t[0]], unique_position_[t[1]], unique_position_[t[2]]};
  }

  bool is_collapsed(std::size_t triangle) const {
    const auto [a, b, c] = unique_positions(triangle);
    return a == b || b == c || c == a;
  }

  // Keeps the triangles that are not marked; returns the number removed.
  std::uint64_t drop(const std::vector<char>& marked) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < marked.size(); ++i)
      if (!marked[i]) mesh_.triangles[kept++] = mesh_.triangles[i];
    const std::uint64_t dropped = mesh_.triangles.size() - kept;
    mesh_.triangles.resize(kept);
    return dropped;
  }

  void drop_collapsed() {
    std::vector<char> marked(mesh_.triangles.size());
    for_each_index(marked.size(), [&](std::size_t i) { marked[i] = is_collapsed(i); });
    report_.degenerate += drop(marked);
  }

  void drop_slivers() {
    std::vector<char> marked(mesh_.triangles.size());
    for_each_index(marked.size(), [&](std::size_t i) {
      const Triangle& t = mesh_.triangles[i];
      const bool sliver =
          measure(mesh_.positions[t[0]], mesh_.positions[t[1]], mesh_.positions[t[2]]).degenerate();
      const std::uint32_t* twin = &edges_.twin[3 * i];
      marked[i] = sliver && std::max({twin[0], twin[1], twin[2]}) >= Edges::kNonManifold;
    });
    const std::uint64_t dropped = drop(marked);
    report_.degenerate += dropped;
    if (dropped > 0) edges_ = edges_of(mesh_, unique_position_);
  }

  // Whether one of two triangles with the same corners can go: they are wound alike, or back to
  // back and look the same.
  bool repeats(std::uint32_t first, std::uint32_t again) const {
    const Triangle& a = mesh_.triangles[first];
    const Triangle& b = mesh_.triangles[again];
    std::size_t turn = 0;
    while (unique_position_[b[turn]] != unique_position_[a[0]]) ++turn;
    if (unique_position_[b[(turn + 1) % 3]] == unique_position_[a[1]]) return true;
    for (std::size_t k = 0; k < 3; ++k)
      if (!same_look(a[k], b[(turn + 3 - k) % 3])) return false;
    return true;
  }

  void drop_duplicates() {
    const std::size_t count = mesh_.triangles.size();
    const auto sorted = [&](std::uint32_t i) {
      auto key = unique_positions(i);
      std::sort(key.begin(), key.end());
      return key;
    };
    const auto hash = [&](std::uint32_t i) {
      const auto key = sorted(i);
      return hash_end(hash_step(hash_step(hash_step(kHashSeed, key[0]), key[1]), key[2]));
    };
    const auto first = deduplicate(
        count, hash, [&](std::uint32_t a, std::uint32_t b) { return sorted(a) == sorted(b); });
    if (!first) return;
    std::vector<char> marked(count);
    for_each_index(count, [&](std::size_t i) {
      const std::uint32_t other = (*first)[i];
      marked[i] = other != i && !is_collapsed(i) && repeats(other, static_cast<std::uint32_t>(i));
    });
    report_.duplicates = drop(marked);
  }

  void turn() {
    Orientation orientation = orientation_of(mesh_, unique_position_, edges_);
    components_ = std::move(orientation.components);
    piece_of_ = std::move(orientation.component_of);
    report_.components = components_.size();
    for (const Component& component : components_) {
      report_.closed_components += component.closed;
      report_.one_sided += component.one_sided;
      if (!options_.orient || component.flipped == 0) continue;
      report_.flipped += component.flipped;
      const Triangle& t = mesh_.triangles[component.first];
      add_spot({SpotKind::flipped,
                (mesh_.positions[t[0]] + mesh_.positions[t[1]] + mesh_.positions[t[2]]) / 3.0,
                std::sqrt(component.area), component.flipped});
    }
    if (!options_.orient || report_.flipped == 0) return;
    flip(orientation.flip);
    edges_ = {};
    edges_ = edges_of(mesh_, unique_position_);
  }

  void flip(const std::vector<char>& marked) {
    for (std::size_t i = 0; i < marked.size(); ++i)
      if (marked[i]) std::swap(mesh_.triangles[i][1], mesh_.triangles[i][2]);
  }

  // Normals that point away from the outside of their triangle would light its back, whichever of
  // the two the file has wrong. Vertices that others share are doubled.
  void turn_normals() {
    std::vector<char> marked(mesh_.triangles.size());
    for_each_index(marked.size(), [&](std::size_t i) {
      const Triangle& t = mesh_.triangles[i];
      const Vec3 outwards = glm::cross(mesh_.positions[t[1]] - mesh_.positions[t[0]],
                                       mesh_.positions[t[2]] - mesh_.positions[t[0]]);
      const Vec3 mean = mesh_.normals[t[0]] + mesh_.normals[t[1]] + mesh_.normals[t[2]];
      marked[i] = glm::dot(outwards, mean) < 0;
    });
    std::vector<char> stays(mesh_.positions.size(), 0);
    for (std::size_t i = 0; i < marked.size(); ++i) {
      report_.normals_turned += marked[i];
      if (!marked[i])
        for (const std::uint32_t v : mesh_.triangles[i]) stays[v] = 1;
    }
    if (report_.normals_turned == 0) return;
    std::vector<std::uint32_t> turned(mesh_.positions.size(), kNone);
    for (std::size_t i = 0; i < marked.size(); ++i) {
      if (!marked[i]) continue;
      for (std::uint32_t& v : mesh_.triangles[i]) v = turned_vertex(v, stays, turned);
    }
  }

  std::uint32_t turned_vertex(std::uint32_t v, const std::vector<char>& stays,
                              std::vector<std::uint32_t>& turned) {
    if (turned[v] != kNone) return turned[v];
    turned[v] = v;
    if (stays[v]) {
      turned[v] = static_cast<std::uint32_t>(mesh_.positions.size());
      copy(mesh_.positions, v);
      copy(mesh_.normals, v);
      copy(mesh_.texcoords, v);
      copy(mesh_.colors, v);
      copy(unique_position_, v);
    }
    Vec3& normal = mesh_.normals[turned[v]];
    normal = Vec3(0) - normal;
    return turned[v];
  }

  template <class T>
  static void copy(std::vector<T>& list, std::uint32_t v) {
    if (list.empty()) return;
    const T value = list[v];
    list.push_back(value);
  }

  void examine() {
    report_.non_manifold_edges = edges_.many.size();
    report_.border_edges = edges_.border.size();
    for (std::size_t i = 0; i < edges_.many.size(); ++i) {
      const auto [a, b] = ends(edges_.many[i]);
      add_spot({SpotKind::non_manifold_edge, 0.5 * a + 0.5 * b, glm::length(b - a),
                edges_.many_count[i]});
    }
    if (options_.examine && !edges_.border.empty()) {
      find_junctions();
      find_holes();
    }
    sort_spots();
  }

  std::array<Vec3, 2> ends(std::uint32_t half_edge) const {
    const Triangle& t = mesh_.triangles[half_edge / 3];
    return {mesh_.positions[t[half_edge % 3]], mesh_.positions[t[(half_edge + 1) % 3]]};
  }

  void find_junctions() {
    double distance = options_.junction;
    if (!(distance > 0)) {
      AxisBox box;
      for (const Vec3& p : mesh_.positions) box.add(p);
      distance = std::max(options_.tolerance, kJunction * box.diagonal());
    }
    const std::vector<Junction> junctions = junctions_of(mesh_, unique_position_, edges_, distance);
    report_.t_junctions = junctions.size();
    for (const Junction& junction : junctions) {
      const auto [a, b] = ends(junction.half_edge);
      add_spot({SpotKind::t_junction, mesh_.positions[junction.vertex], glm::length(b - a), 1});
    }
  }

  void find_holes() {
    const std::vector<BoundaryLoop> boundary_loops =
        boundary_loops_of(mesh_, unique_position_, edges_);
    report_.boundary_loops = boundary_loops.size();
    for (const BoundaryLoop& loop : boundary_loops) {
      if (!(loop.length * loop.length < components_[piece_of_[loop.triangle]].area)) continue;
      ++report_.holes;
      report_.hole_length += loop.length;
      Vec3 middle(0);
      for (const std::uint32_t v : loop.unique_positions)
        middle += mesh_.positions[v] / static_cast<double>(loop.unique_positions.size());
      add_spot({SpotKind::hole, middle, loop.length, loop.unique_positions.size()});
      if (!options_.fill_holes) continue;
      fill(mesh_, loop);
      ++report_.filled;
    }
    if (report_.filled == 0) return;
    for (std::size_t v = unique_position_.size(); v < mesh_.positions.size(); ++v)
      unique_position_.push_back(static_cast<std::uint32_t>(v));
    edges_ = edges_of(mesh_, unique_position_);
  }

  void add_spot(const Spot& spot) { report_.spots.push_back(spot); }

  // By kind; the longest of each, then in the order in which they were found.
  void sort_spots() {
    std::vector<Spot>& spots = report_.spots;
    std::stable_sort(spots.begin(), spots.end(), [](const Spot& a, const Spot& b) {
      return a.kind != b.kind ? a.kind < b.kind : a.length > b.length;
    });
    std::array<std::uint32_t, 4> kept{};
    std::erase_if(spots, [&](const Spot& spot) {
      return kept[static_cast<std::size_t>(spot.kind)]++ >= options_.max_spots;
    });
  }

  // Whether a triangle has edges at all.
  bool has_edges() const {
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i)
      if (!is_collapsed(i)) return true;
    return false;
  }

  static constexpr std::uint32_t kNone = 0xffffffffu;

  Mesh& mesh_;
  const CleanOptions& options_;
  const Job& job_;
  CleanReport report_;
  std::vector<std::uint32_t> unique_position_;  // V: the first vertex at its position
  Edges edges_;
  std::vector<Component> components_;
  std::vector<std::uint32_t> piece_of_;  // T
};

}  // namespace

CleanReport clean(Mesh& mesh, const CleanOptions& options, const Job& job) {
  assert(mesh.positions.size() + 3 * mesh.triangles.size() < 0xffffffffull);
  return Cleaner(mesh, options, job).run();
}

}  // namespace panwright::geometry
