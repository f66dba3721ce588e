#include "geometry/mesh/internal/edges.h"

#include <algorithm>

#include "base/parallel.h"
#include "geometry/internal/compressed_rows.h"

namespace panwright::geometry {

namespace {

constexpr std::size_t kEdgeChunk = 1u << 14;  // vertices that a thread takes at once

// What one chunk of vertices found.
struct Found {
  std::vector<std::uint32_t> border;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> many;  // first half-edge, triangles
  std::uint64_t misoriented = 0;
};

struct Ends {
  std::uint32_t low;
  std::uint32_t high;
  bool forward;  // the side runs from low to high
};

Ends ends_of(const Mesh& mesh, std::span<const std::uint32_t> unique_position,
             std::uint32_t half_edge) {
  const Triangle& t = mesh.triangles[half_edge / 3];
  const std::uint32_t k = half_edge % 3;
  const std::uint32_t from = unique_position[t[k]];
  const std::uint32_t to = unique_position[t[k == 2 ? 0 : k + 1]];
  return {std::min(from, to), std::max(from, to), from < to};
}

void pair_half_edges(const Mesh& mesh, std::span<const std::uint32_t> unique_position,
                     std::span<const std::uint32_t> half_edges, std::vector<std::uint64_t>& sorted,
                     std::vector<std::uint32_t>& twin, Found& found) {
  sorted.clear();
  for (const std::uint32_t half_edge : half_edges)
    sorted.push_back(std::uint64_t{ends_of(mesh, unique_position, half_edge).high} << 32 |
                     half_edge);
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < sorted.size();) {
    std::size_t end = i + 1;
    while (end < sorted.size() && sorted[end] >> 32 == sorted[i] >> 32) ++end;
    const auto half_edge = [&](std::size_t at) { return static_cast<std::uint32_t>(sorted[at]); };
    if (end - i == 1) {
      twin[half_edge(i)] = Edges::kBorder;
      found.border.push_back(half_edge(i));
    } else if (end - i == 2) {
      twin[half_edge(i)] = half_edge(i + 1);
      twin[half_edge(i + 1)] = half_edge(i);
      found.misoriented += ends_of(mesh, unique_position, half_edge(i)).forward ==
                           ends_of(mesh, unique_position, half_edge(i + 1)).forward;
    } else {
      for (std::size_t j = i; j < end; ++j) twin[half_edge(j)] = Edges::kNonManifold;
      found.many.push_back({half_edge(i), static_cast<std::uint32_t>(end - i)});
    }
    i = end;
  }
}

}  // namespace

Edges edges_of(const Mesh& mesh, std::span<const std::uint32_t> unique_position) {
  const std::size_t half_edges = 3 * mesh.triangles.size();
  std::vector<std::uint32_t> low(half_edges);
  parallel_for((half_edges + kEdgeChunk - 1) / kEdgeChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(half_edges, (chunk + 1) * kEdgeChunk);
    for (std::size_t i = chunk * kEdgeChunk; i < end; ++i) {
      const Triangle& t = mesh.triangles[i / 3];
      const bool collapsed = unique_position[t[0]] == unique_position[t[1]] ||
                             unique_position[t[1]] == unique_position[t[2]] ||
                             unique_position[t[2]] == unique_position[t[0]];
      low[i] =
          collapsed ? kNoKey : ends_of(mesh, unique_position, static_cast<std::uint32_t>(i)).low;
    }
  });
  const std::size_t vertices = mesh.positions.size();
  const CompressedRows rows = compressed_rows_by(low, vertices);
  low = std::vector<std::uint32_t>();

  Edges edges;
  edges.twin.assign(half_edges, Edges::kNonManifold);
  std::vector<Found> found((vertices + kEdgeChunk - 1) / kEdgeChunk);
  parallel_for(found.size(), [&](std::size_t chunk) {
    std::vector<std::uint64_t> sorted;
    const std::size_t end = std::min(vertices, (chunk + 1) * kEdgeChunk);
    for (std::size_t v = chunk * kEdgeChunk; v < end; ++v)
      pair_half_edges(mesh, unique_position, rows[v], sorted, edges.twin, found[chunk]);
  });
  std::vector<std::pair<std::uint32_t, std::uint32_t>> many;
  for (const Found& part : found) {
    edges.border.insert(edges.border.end(), part.border.begin(), part.border.end());
    many.insert(many.end(), part.many.begin(), part.many.end());
    edges.misoriented += part.misoriented;
  }
  std::sort(edges.border.begin(), edges.border.end());
  std::sort(many.begin(), many.end());
  for (const auto& [half_edge, count] : many) {
    edges.many.push_back(half_edge);
    edges.many_count.push_back(count);
  }
  return edges;
}

}  // namespace panwright::geometry
