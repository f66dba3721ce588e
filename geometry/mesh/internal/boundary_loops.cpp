#include "geometry/mesh/internal/boundary_loops.h"
#include "geometry/internal/limits.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wdeprecated-copy"
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#pragma GCC diagnostic pop

namespace panwright::geometry {

namespace {

constexpr std::size_t kExactFill = 64;  // vertices: the cube of them is searched

struct HalfEdgeTraits : OpenMesh::DefaultTraits {
  VertexAttributes(OpenMesh::Attributes::None);
  HalfedgeAttributes(OpenMesh::Attributes::None);
  EdgeAttributes(OpenMesh::Attributes::None);
  FaceAttributes(OpenMesh::Attributes::None);
};
using HalfEdges = OpenMesh::TriMesh_ArrayKernelT<HalfEdgeTraits>;

// Faces that do not fit are left out: that is expected, and nothing to print. OpenMesh's stream is
// the host program's too, and is as it was when the last of these is gone.
class QuietOpenMesh {
 public:
  QuietOpenMesh() {
    const std::lock_guard lock(mutex);
    if (users++ > 0) return;
    was_enabled = omerr().is_enabled();
    omerr().disable();
  }
  ~QuietOpenMesh() {
    const std::lock_guard lock(mutex);
    if (--users == 0 && was_enabled) omerr().enable();
  }
  QuietOpenMesh(const QuietOpenMesh&) = delete;
  QuietOpenMesh& operator=(const QuietOpenMesh&) = delete;

 private:
  static inline std::mutex mutex;
  static inline int users = 0;
  static inline bool was_enabled = false;
};

class LoopFinder {
 public:
  LoopFinder(const Mesh& mesh, std::span<const std::uint32_t> unique_position, const Edges& edges)
      : mesh_(mesh), unique_position_(unique_position), edges_(edges) {}

  std::vector<BoundaryLoop> run() {
    if (edges_.border.empty()) return {};
    {
      const QuietOpenMesh quiet;
      add_faces();
    }
    mark_borders();
    std::vector<BoundaryLoop> boundary_loops;
    for (const std::uint32_t half_edge : edges_.border) walk(half_edge, boundary_loops);
    return boundary_loops;
  }

 private:
  // Faces at the border alone: they are all that its loops need.
  void add_faces() {
    std::vector<char> at_border(mesh_.positions.size(), 0);
    for (const std::uint32_t half_edge : edges_.border)
      for (const std::uint32_t step : {0u, 1u}) at_border[unique_position(half_edge, step)] = 1;
    handle_.assign(mesh_.positions.size(), kNone);
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
      const std::uint32_t corners[3] = {unique_position(3 * i, 0), unique_position(3 * i, 1),
                                        unique_position(3 * i, 2)};
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
        continue;
      if (!at_border[corners[0]] && !at_border[corners[1]] && !at_border[corners[2]]) continue;
      HalfEdges::VertexHandle vertices[3];
      for (int k = 0; k < 3; ++k) vertices[k] = vertex(corners[k]);
      half_edges_.add_face(vertices[0], vertices[1], vertices[2]);
    }
  }

  std::uint32_t unique_position(std::uint32_t half_edge, std::uint32_t step) const {
    return unique_position_[mesh_.triangles[half_edge / 3][(half_edge % 3 + step) % 3]];
  }

  HalfEdges::VertexHandle vertex(std::uint32_t at) {
    if (handle_[at] == kNone) {
      handle_[at] = static_cast<std::uint32_t>(positions_.size());
      positions_.push_back(at);
      half_edges_.add_vertex(HalfEdges::Point(0, 0, 0));
    }
    return HalfEdges::VertexHandle(static_cast<int>(handle_[at]));
  }

  // The half-edge outside of a border side, if its face could be added.
  HalfEdges::HalfedgeHandle outside(std::uint32_t half_edge) {
    const std::uint32_t from = handle_[unique_position(half_edge, 0)];
    const std::uint32_t to = handle_[unique_position(half_edge, 1)];
    HalfEdges::HalfedgeHandle none;
    if (from == kNone || to == kNone) return none;
    const HalfEdges::HalfedgeHandle found =
        half_edges_.find_halfedge(HalfEdges::VertexHandle(static_cast<int>(to)),
                                  HalfEdges::VertexHandle(static_cast<int>(from)));
    return found.is_valid() && half_edges_.is_boundary(found) ? found : none;
  }

  void mark_borders() {
    unused_.assign(half_edges_.n_halfedges(), 0);
    for (const std::uint32_t half_edge : edges_.border)
      if (const auto outer = outside(half_edge); outer.is_valid()) unused_[index(outer)] = 1;
  }

  static std::size_t index(HalfEdges::HalfedgeHandle half_edge) {
    return static_cast<std::size_t>(half_edge.idx());
  }

  void walk(std::uint32_t half_edge, std::vector<BoundaryLoop>& boundary_loops) {
    const HalfEdges::HalfedgeHandle begin = outside(half_edge);
    if (!begin.is_valid() || !unused_[index(begin)]) return;
    BoundaryLoop loop;
    loop.triangle = half_edge / 3;
    HalfEdges::HalfedgeHandle at = begin;
    do {
      // a face that was left out blocks it
      if (!unused_[index(at)]) return;
      unused_[index(at)] = 0;
      const std::uint32_t from =
          positions_[static_cast<std::size_t>(half_edges_.from_vertex_handle(at).idx())];
      const std::uint32_t to =
          positions_[static_cast<std::size_t>(half_edges_.to_vertex_handle(at).idx())];
      loop.unique_positions.push_back(from);
      loop.length += glm::length(mesh_.positions[to] - mesh_.positions[from]);
      at = half_edges_.next_halfedge_handle(at);
    } while (at != begin);
    boundary_loops.push_back(std::move(loop));
  }

  const Mesh& mesh_;
  std::span<const std::uint32_t> unique_position_;
  const Edges& edges_;
  HalfEdges half_edges_;
  std::vector<std::uint32_t> handle_;     // V, of unique positions
  std::vector<std::uint32_t> positions_;  // of handles
  std::vector<char> unused_;              // of half-edges: on a border, and in no boundary loop yet
};

double double_area(const Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return glm::length(
      glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
}

// Barequet and Sharir, "Filling gaps in the boundary of a polyhedron", 1995.
void fill_exactly(Mesh& mesh, const std::vector<std::uint32_t>& loop) {
  const std::size_t n = loop.size();
  std::vector<double> cost(n * n, 0);
  std::vector<std::size_t> middle(n * n, 0);
  for (std::size_t gap = 2; gap < n; ++gap) {
    for (std::size_t i = 0; i + gap < n; ++i) {
      const std::size_t k = i + gap;
      double best = HUGE_VAL;
      for (std::size_t j = i + 1; j < k; ++j) {
        const double area =
            cost[i * n + j] + cost[j * n + k] + double_area(mesh, loop[i], loop[j], loop[k]);
        if (area < best) middle[i * n + k] = j;
        best = std::min(best, area);
      }
      cost[i * n + k] = best;
    }
  }
  std::vector<std::pair<std::size_t, std::size_t>> waiting = {{0, n - 1}};
  while (!waiting.empty()) {
    const auto [i, k] = waiting.back();
    waiting.pop_back();
    if (k - i < 2) continue;
    const std::size_t j = middle[i * n + k];
    mesh.triangles.push_back({loop[i], loop[j], loop[k]});
    waiting.push_back({j, k});
    waiting.push_back({i, j});
  }
}

template <class T>
void add_mean(std::vector<T>& list, const std::vector<std::uint32_t>& loop) {
  if (list.empty()) return;
  T sum(0);
  for (const std::uint32_t v : loop) sum += list[v];
  list.push_back(sum / static_cast<double>(loop.size()));
}

}  // namespace

std::vector<BoundaryLoop> boundary_loops_of(const Mesh& mesh,
                                            std::span<const std::uint32_t> unique_position,
                                            const Edges& edges) {
  return LoopFinder(mesh, unique_position, edges).run();
}

void fill(Mesh& mesh, const BoundaryLoop& loop) {
  const std::vector<std::uint32_t>& at = loop.unique_positions;
  if (at.size() < 3) return;
  if (at.size() <= kExactFill) return fill_exactly(mesh, at);
  const auto centre = static_cast<std::uint32_t>(mesh.positions.size());
  add_mean(mesh.positions, at);
  add_mean(mesh.texcoords, at);
  add_mean(mesh.colors, at);
  if (!mesh.normals.empty()) {
    Vec3 normal(0);
    for (std::size_t i = 0; i < at.size(); ++i)
      normal += glm::cross(mesh.positions[at[i]] - mesh.positions[centre],
                           mesh.positions[at[(i + 1) % at.size()]] - mesh.positions[centre]);
    const double length = glm::length(normal);
    mesh.normals.push_back(length > 0 ? normal / length : Vec3(0, 0, 1));
  }
  for (std::size_t i = 0; i < at.size(); ++i)
    mesh.triangles.push_back({at[i], at[(i + 1) % at.size()], centre});
}

}  // namespace panwright::geometry
