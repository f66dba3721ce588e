#include "geometry/mesh/internal/reorder.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <utility>

#include "base/parallel.h"

namespace panwright::geometry {

namespace {

constexpr std::uint32_t kUnused = 0xffffffffu;
constexpr unsigned int kCache = 16;  // vertices, of the smallest that GPUs have
constexpr std::size_t kReorderChunk = 1u << 15;

static_assert(sizeof(Triangle) == 3 * sizeof(unsigned int));

template <class T>
void permute(std::vector<T>& list, const std::vector<std::uint32_t>& remap, std::size_t count) {
  if (list.empty()) return;
  std::vector<T> out(count);
  parallel_for((remap.size() + kReorderChunk - 1) / kReorderChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(remap.size(), (chunk + 1) * kReorderChunk);
    for (std::size_t v = chunk * kReorderChunk; v < end; ++v)
      if (remap[v] != kUnused) out[remap[v]] = list[v];
  });
  list = std::move(out);
}

}  // namespace

void reorder_triangles(Mesh& mesh) {
  if (mesh.triangles.empty()) return;
  std::vector<Triangle> out(mesh.triangles.size());
  meshopt_optimizeVertexCacheFifo(out[0].data(), mesh.triangles[0].data(),
                                  3 * mesh.triangles.size(), mesh.positions.size(), kCache);
  mesh.triangles = std::move(out);
}

void compact_vertices(Mesh& mesh, bool keep_order) {
  std::vector<std::uint32_t> remap(mesh.positions.size(), kUnused);
  std::uint32_t count = 0;
  bool same = true;
  if (keep_order) {
    for (const Triangle& t : mesh.triangles)
      for (const std::uint32_t v : t) remap[v] = 0;
    for (std::uint32_t& v : remap)
      if (v != kUnused) v = count++;
    same = count == remap.size();
  } else {
    for (const Triangle& t : mesh.triangles) {
      for (const std::uint32_t v : t) {
        if (remap[v] != kUnused) continue;
        same = same && v == count;
        remap[v] = count++;
      }
    }
    same = same && count == remap.size();
  }
  if (same) return;
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = remap[v];
  permute(mesh.positions, remap, count);
  permute(mesh.normals, remap, count);
  permute(mesh.texcoords, remap, count);
  permute(mesh.colors, remap, count);
}

}  // namespace panwright::geometry
