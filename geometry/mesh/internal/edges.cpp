#include "geometry/mesh/internal/edges.h"

#include <algorithm>

#include "base/parallel.h"
#include "geometry/internal/lists.h"

namespace panwright::geometry {

namespace {

constexpr std::size_t kChunk = 1u << 14;  // vertices that a thread takes at once

// What one chunk of vertices found.
struct Found {
  std::vector<std::uint32_t> border;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> many;  // first side, triangles
  std::uint64_t misoriented = 0;
};

struct Ends {
  std::uint32_t low;
  std::uint32_t high;
  bool forward;  // the side runs from low to high
};

Ends ends_of(const Mesh& mesh, std::span<const std::uint32_t> place, std::uint32_t side) {
  const Triangle& t = mesh.triangles[side / 3];
  const std::uint32_t k = side % 3;
  const std::uint32_t from = place[t[k]];
  const std::uint32_t to = place[t[k == 2 ? 0 : k + 1]];
  return {std::min(from, to), std::max(from, to), from < to};
}

void pair_sides(const Mesh& mesh, std::span<const std::uint32_t> place,
                std::span<const std::uint32_t> sides, std::vector<std::uint64_t>& sorted,
                std::vector<std::uint32_t>& twin, Found& found) {
  sorted.clear();
  for (const std::uint32_t side : sides)
    sorted.push_back(std::uint64_t{ends_of(mesh, place, side).high} << 32 | side);
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < sorted.size();) {
    std::size_t end = i + 1;
    while (end < sorted.size() && sorted[end] >> 32 == sorted[i] >> 32) ++end;
    const auto side = [&](std::size_t at) { return static_cast<std::uint32_t>(sorted[at]); };
    if (end - i == 1) {
      twin[side(i)] = Edges::kBorder;
      found.border.push_back(side(i));
    } else if (end - i == 2) {
      twin[side(i)] = side(i + 1);
      twin[side(i + 1)] = side(i);
      found.misoriented +=
          ends_of(mesh, place, side(i)).forward == ends_of(mesh, place, side(i + 1)).forward;
    } else {
      for (std::size_t j = i; j < end; ++j) twin[side(j)] = Edges::kMany;
      found.many.push_back({side(i), static_cast<std::uint32_t>(end - i)});
    }
    i = end;
  }
}

}  // namespace

Edges edges_of(const Mesh& mesh, std::span<const std::uint32_t> place) {
  const std::size_t sides = 3 * mesh.triangles.size();
  std::vector<std::uint32_t> low(sides);
  parallel_for((sides + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(sides, (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      const Triangle& t = mesh.triangles[i / 3];
      const bool collapsed =
          place[t[0]] == place[t[1]] || place[t[1]] == place[t[2]] || place[t[2]] == place[t[0]];
      low[i] = collapsed ? kNoKey : ends_of(mesh, place, static_cast<std::uint32_t>(i)).low;
    }
  });
  const std::size_t vertices = mesh.positions.size();
  const Lists lists = lists_by(low, vertices);
  low = std::vector<std::uint32_t>();

  Edges edges;
  edges.twin.assign(sides, Edges::kMany);
  std::vector<Found> found((vertices + kChunk - 1) / kChunk);
  parallel_for(found.size(), [&](std::size_t chunk) {
    std::vector<std::uint64_t> sorted;
    const std::size_t end = std::min(vertices, (chunk + 1) * kChunk);
    for (std::size_t v = chunk * kChunk; v < end; ++v)
      pair_sides(mesh, place, lists[v], sorted, edges.twin, found[chunk]);
  });
  std::vector<std::pair<std::uint32_t, std::uint32_t>> many;
  for (const Found& part : found) {
    edges.border.insert(edges.border.end(), part.border.begin(), part.border.end());
    many.insert(many.end(), part.many.begin(), part.many.end());
    edges.misoriented += part.misoriented;
  }
  std::sort(edges.border.begin(), edges.border.end());
  std::sort(many.begin(), many.end());
  for (const auto& [side, count] : many) {
    edges.many.push_back(side);
    edges.many_count.push_back(count);
  }
  return edges;
}

}  // namespace panwright::geometry
