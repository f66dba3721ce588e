#include "geometry/mesh/internal/tjunction.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "geometry/internal/deduplicate.h"
#include "geometry/internal/limits.h"

namespace panwright::geometry {

namespace {

constexpr std::uint64_t kTries = 64;  // for each border edge
constexpr double kSamples = 8;        // points on border edges for each of them, on average

struct OpenEdge {
  Vec3 a;
  Vec3 b;
  std::uint32_t from;
  std::uint32_t to;
  std::uint32_t half_edge;
};

std::uint64_t cell_hash(const Vec3& cell) {
  std::uint64_t h = kHashSeed;
  for (int axis = 0; axis < 3; ++axis)
    h = hash_step(h, std::bit_cast<std::uint64_t>(cell[axis] + 0.0));
  return hash_end(h);
}

// Points along the edges, half a cell apart, by the cell that they lie in.
class Samples {
 public:
  Samples(const std::vector<OpenEdge>& edges, double cell) : cell_(cell) {
    std::size_t count = 0;
    for (const OpenEdge& edge : edges) count += steps(edge) + 1;
    heads_.assign(std::bit_ceil(std::max<std::size_t>(16, 2 * count)), kNone);
    entries_.reserve(count);
    for (std::uint32_t i = 0; i < edges.size(); ++i) {
      const std::size_t n = steps(edges[i]);
      for (std::size_t k = 0; k <= n; ++k) {
        const double s = static_cast<double>(k) / static_cast<double>(n);
        add(i, glm::floor((edges[i].a + s * (edges[i].b - edges[i].a)) / cell_));
      }
    }
  }

  // Calls body(edge) for edges with a point in the eight cells around p, until it says no.
  template <class Body>
  void near(const Vec3& p, const Body& body) const {
    const Vec3 corner = glm::floor(p / cell_ + 0.5);
    for (int i = 0; i < 8; ++i) {
      const Vec3 cell = corner - Vec3(i & 1, (i >> 1) & 1, (i >> 2) & 1);
      for (std::uint32_t e = heads_[cell_hash(cell) & (heads_.size() - 1)]; e != kNone;
           e = entries_[e].next)
        if (!body(entries_[e].edge)) return;
    }
  }

 private:
  struct Entry {
    std::uint32_t edge;
    std::uint32_t next;
  };

  std::size_t steps(const OpenEdge& edge) const {
    return 1 + static_cast<std::size_t>(glm::length(edge.b - edge.a) / (0.5 * cell_));
  }

  void add(std::uint32_t edge, const Vec3& cell) {
    std::uint32_t& head = heads_[cell_hash(cell) & (heads_.size() - 1)];
    if (head != kNone && entries_[head].edge == edge) return;
    entries_.push_back({edge, head});
    head = static_cast<std::uint32_t>(entries_.size() - 1);
  }

  double cell_;
  std::vector<std::uint32_t> heads_;
  std::vector<Entry> entries_;
};

bool lies_inside(const Vec3& p, const OpenEdge& edge, double distance) {
  const Vec3 along = edge.b - edge.a;
  const double squared = glm::dot(along, along);
  if (!(squared > 4 * distance * distance)) return false;
  const double s = glm::dot(p - edge.a, along) / squared;
  const double margin = distance / std::sqrt(squared);
  if (!(s > margin && s < 1 - margin)) return false;
  const Vec3 off = p - (edge.a + s * along);
  return glm::dot(off, off) <= distance * distance;
}

}  // namespace

std::vector<Junction> junctions_of(const Mesh& mesh, std::span<const std::uint32_t> unique_position,
                                   const Edges& edges, double distance) {
  std::vector<OpenEdge> border;
  std::vector<std::uint32_t> vertices;
  double total = 0;
  for (const std::uint32_t half_edge : edges.border) {
    const Triangle& t = mesh.triangles[half_edge / 3];
    const std::uint32_t from = unique_position[t[half_edge % 3]];
    const std::uint32_t to = unique_position[t[(half_edge + 1) % 3]];
    border.push_back({mesh.positions[from], mesh.positions[to], from, to, half_edge});
    total += glm::length(border.back().b - border.back().a);
    vertices.push_back(from);
    vertices.push_back(to);
  }
  std::vector<Junction> out;
  if (border.empty() || !(total > 0) || !std::isfinite(total)) return out;
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  // note: points half a cell apart, so that what is near an edge is within a cell's quarter and the
  // distance of one of its points
  const double cell =
      std::max(8 * distance, 2 * total / (kSamples * static_cast<double>(border.size())));
  const Samples samples(border, cell);
  std::uint64_t tries = kTries * border.size() + 4096;
  for (const std::uint32_t v : vertices) {
    const Vec3& p = mesh.positions[v];
    std::uint32_t best = kNone;
    samples.near(p, [&](std::uint32_t e) {
      const OpenEdge& edge = border[e];
      if (edge.half_edge < best && edge.from != v && edge.to != v && lies_inside(p, edge, distance))
        best = edge.half_edge;
      return tries > 0 && --tries > 0;
    });
    if (best != kNone) out.push_back({v, best});
    if (tries == 0) break;
  }
  return out;
}

}  // namespace panwright::geometry
