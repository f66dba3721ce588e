// Hidden-geometry removal: triangles that are invisible from every viewpoint outside the model.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/diagnostic.h"
#include "base/work_cache.h"
#include "compiler/compile.h"
#include "scene/scene.h"

namespace panwright::compiler {

struct HiddenOptions {
  // one per instance: true if it may lose faces; empty: all may. All of them occlude others.
  std::vector<char> may_lose;
  Options compile;                       // options of the later compilation
  std::uint32_t rays_per_triangle = 64;  // without escape, of each removed triangle
  // In all, and four more for each triangle of a mesh. Triangles left undecided stay.
  std::uint64_t max_rays = 16'000'000;
  std::uint64_t max_triangles = 8'000'000;  // instances counted; a larger model is left alone
  // Cache of earlier searches; null: none. It changes no result, `cached` and `seconds` apart.
  const WorkCache* cache = nullptr;
};

struct HiddenReport {
  std::uint64_t triangles_before = 0;  // instances counted
  std::uint64_t triangles_after = 0;
  std::uint64_t unique_before = 0;  // of meshes
  std::uint64_t unique_after = 0;
  std::uint64_t instances_before = 0;
  std::uint64_t instances_after = 0;
  std::uint64_t hidden = 0;  // removed triangles
  // Unseen but kept: max_rays did not suffice, or a visible neighbour continues smoothly.
  std::uint64_t ambiguous = 0;
  bool capped = false;  // max_rays did not suffice for some
  std::uint64_t rays = 0;
  std::uint64_t reached = 0;  // triangles found by the last rays from outside
  // With 95 % confidence, the share of open directions from points of all removed triangles
  // together (by number), and from any one of them.
  double open_share = 0;
  double open_share_each = 0;
  double seconds = 0;
  bool cached = false;  // the whole search came from the cache
};

// Removes triangles of meshes, and whole instances, that are invisible from outside the model.
//
// A ray that escapes from a point of a triangle proves it visible, so it stays. Rays start along
// both normals, then by the cosine on both sides, until one escapes. If none does, they follow the
// escaping rays of neighbours. Triangles that face a visible side take more: towards gaps found by
// others, and evenly over area and direction, as the rays of images. Rays from outside find gaps.
// Triangles that face a visible side and smoothly continue a visible one stay, as do those
// undecided after max_rays. So no ray escaped from any removed triangle. Rays are decided in
// double; surfaces within 1e-5 of the model's radius are one; gaps narrower than 3e-6 of it count
// as closed.
//
// Surfaces are visible and occlude from both sides; cut-out materials and see-through
// instances occlude nothing. Shapes
// shared by several instances lose only triangles hidden in all of them. Exact shapes are hidden as
// a whole or not at all. Meshes with decals stay whole. Parts that a joint can move occlude nothing
// but themselves, and are occluded by nothing else: triangles uncovered in some joint position
// stay. A mesh that was closed stays marked so: no more of its back is visible than before. Unused
// shapes are removed; nodes stay. Deterministic, whatever the number of threads.
//
//   scene  valid (scene::check), and valid afterwards; unchanged on failure
//
// Reports: N6304. Fails: E0001.
// Cost: about 0.3 µs per ray on two cores, one or two rays for a triangle in the open; 150 bytes
// per triangle, instances counted. From the cache: a hash of the meshes.
Result<HiddenReport> prune_hidden(scene::Scene& scene, const HiddenOptions& options,
                                  DiagnosticLog& log, const Job& job = {});

}  // namespace panwright::compiler
