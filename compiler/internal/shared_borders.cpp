#include "compiler/internal/shared_borders.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "base/axis_box.h"
#include "base/parallel.h"

namespace panwright::compiler::internal {
namespace {

constexpr double kSamePlace = 1e-6;  // of the model's diagonal
constexpr std::size_t kMostShared = 1u
                                    << 24;  // vertices of all placements whose borders are compared

// V: whether an edge of one triangle ends there. Vertices at equal positions count as one.
std::vector<char> borders(const Surface& mesh) {
  const std::vector<std::uint32_t> first = first_at_place(mesh);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t i = 0; i < mesh.triangles; ++i) {
    const geometry::Triangle triangle = mesh.triangle(i);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = first[triangle[k]], b = first[triangle[(k + 1) % 3]];
      if (a != b) edges.emplace_back(std::min(a, b), std::max(a, b));
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<char> at(mesh.vertices);
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if (end == i + 1) at[edges[i].first] = at[edges[i].second] = 1;
    i = end;
  }
  for (std::size_t v = 0; v < at.size(); ++v) at[v] = at[first[v]];
  return at;
}

// Places where borders of placements are, in cells of a grid.
class Meetings {
 public:
  explicit Meetings(double tolerance) : cell_(4 * tolerance) {}

  void add(const Vec3& p, std::uint32_t placement) {
    const auto [found, added] = cells_.try_emplace(key(p), placement);
    if (!added && found->second != placement) found->second = kSeveral;
  }

  // Whether another placement's border is next to a place: within the tolerance, or a few times it.
  bool meets(const Vec3& p, std::uint32_t placement) const {
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 off(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      const auto found = cells_.find(key(p + 0.25 * cell_ * off));
      if (found != cells_.end() && found->second != placement) return true;
    }
    return false;
  }

 private:
  static constexpr std::uint32_t kSeveral = 0xffffffffu;
  using Cell = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Cell& c) const {
      std::uint64_t h = 0x9e3779b97f4a7c15ull;
      for (const std::int64_t k : c) {
        h = (h ^ static_cast<std::uint64_t>(k)) * 0xff51afd7ed558ccdull;
        h ^= h >> 32;
      }
      return static_cast<std::size_t>(h);
    }
  };
  Cell key(const Vec3& p) const {
    Cell out;
    // note: places are within the model, so 1e6 cells each way
    for (int k = 0; k < 3; ++k)
      out[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(std::floor(p[k] / cell_));
    return out;
  }

  double cell_;
  std::unordered_map<Cell, std::uint32_t, Hash> cells_;
};

}  // namespace

Surface surface_of(const geometry::Mesh& mesh) {
  return {mesh.positions.size(), mesh.triangles.size(),
          [&mesh](std::size_t v) { return mesh.positions[v]; },
          [&mesh](std::size_t t) { return mesh.triangles[t]; }};
}

Surface surface_of(const pan::PackedMesh& mesh) {
  return {mesh.vertex_count(), mesh.indices.size() / 3,
          [&mesh](std::size_t v) {
            const float* p = &mesh.positions[3 * v];
            return mesh.origin + Vec3(p[0], p[1], p[2]);
          },
          [&mesh](std::size_t t) {
            return geometry::Triangle{mesh.indices[3 * t], mesh.indices[3 * t + 1],
                                      mesh.indices[3 * t + 2]};
          }};
}

std::vector<std::uint32_t> first_at_place(const Surface& mesh) {
  std::vector<std::uint32_t> order(mesh.vertices);
  for (std::uint32_t v = 0; v < order.size(); ++v) order[v] = v;
  const auto place = [&](std::uint32_t v) {
    const Vec3 p = mesh.position(v);
    return std::array<double, 3>{p.x, p.y, p.z};
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto p = place(a), q = place(b);
    return p != q ? p < q : a < b;
  });
  std::vector<std::uint32_t> first(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] =
        i > 0 && place(order[i]) == place(order[i - 1]) ? first[order[i - 1]] : order[i];
  return first;
}

std::optional<std::vector<std::vector<char>>> shared_borders(
    const std::vector<Surface>& meshes, const std::vector<PlacedSurface>& placed,
    const std::vector<Mat4>& world, Compared compared, const Job& job) {
  std::vector<std::vector<char>> shared(meshes.size()), border(meshes.size());
  std::vector<char> used(meshes.size());
  std::size_t vertices = 0;
  for (const PlacedSurface& at : placed) {
    vertices += meshes[at.mesh].vertices;
    used[at.mesh] = 1;
  }
  if (vertices > kMostShared) return {};
  for (std::size_t i = 0; i < meshes.size(); ++i) shared[i].assign(meshes[i].vertices, 0);
  parallel_for(
      border.size(),
      [&](std::size_t i) {
        if (!used[i]) return;
        border[i] = compared == Compared::all ? std::vector<char>(meshes[i].vertices, 1)
                                              : borders(meshes[i]);
      },
      job);
  const auto each = [&](const PlacedSurface& at, const auto& visit) {
    for (std::size_t v = 0; v < border[at.mesh].size(); ++v)
      if (border[at.mesh][v])
        visit(v, Vec3(world[at.instance] * Vec4(meshes[at.mesh].position(v), 1)));
  };
  AxisBox box;
  for (const PlacedSurface& at : placed) each(at, [&](std::size_t, const Vec3& p) { box.add(p); });
  const double diagonal = box.diagonal();
  if (!(diagonal > 0 && diagonal < HUGE_VAL)) return shared;
  Meetings meetings(kSamePlace * diagonal);
  for (const PlacedSurface& at : placed)
    each(at, [&](std::size_t, const Vec3& p) { meetings.add(p - box.low, at.instance); });
  for (const PlacedSurface& at : placed)
    each(at, [&](std::size_t v, const Vec3& p) {
      if (!shared[at.mesh][v] && meetings.meets(p - box.low, at.instance)) shared[at.mesh][v] = 1;
    });
  return shared;
}

}  // namespace panwright::compiler::internal
