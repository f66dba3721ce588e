// Hidden-geometry removal: triangles that no viewpoint outside the model sees.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/diagnostic.h"
#include "base/file_cache.h"
#include "compiler/compile.h"
#include "scene/scene.h"

namespace panwright::compiler {

struct HiddenOptions {
  // one per instance: whether it may lose faces; empty: all may. All of them occlude others.
  std::vector<char> may_lose;
  Options compile;                       // as the model will be compiled with
  std::uint32_t rays_per_triangle = 64;  // that lead nowhere from each removed triangle
  // In all, and four more for each triangle of a mesh. What they do not suffice for stays.
  std::uint64_t max_rays = 16'000'000;
  std::uint64_t max_triangles = 8'000'000;  // instances counted; a larger model is left alone
  // Of what earlier searches found; null: none. It changes no result, `cached` and `seconds` apart.
  const FileCache* cache = nullptr;
};

struct HiddenReport {
  std::uint64_t triangles_before = 0;  // instances counted
  std::uint64_t triangles_after = 0;
  std::uint64_t unique_before = 0;  // of meshes
  std::uint64_t unique_after = 0;
  std::uint64_t instances_before = 0;
  std::uint64_t instances_after = 0;
  std::uint64_t hidden = 0;  // triangles that are gone
  // Not seen and kept: max_rays did not suffice, or a visible neighbour continues smoothly.
  std::uint64_t ambiguous = 0;
  bool capped = false;  // max_rays did not suffice for some
  std::uint64_t rays = 0;
  std::uint64_t reached = 0;  // triangles that the last rays from outside found
  // With 95 % confidence, the share of all directions from points of the removed triangles together
  // (by number) that lead outside; and of any one of them.
  double open_share = 0;
  double open_share_each = 0;
  double seconds = 0;
  bool cached = false;  // all that takes a search was found before
};

// Removes the triangles of meshes, and whole instances, that nobody outside the model can see.
//
// A ray from a point of a triangle that leads outside proves that it is seen, so it stays. From
// each triangle rays go along both normals, then by the cosine on both sides, until one escapes.
// Where none does, they go along those that neighbours escaped by, and triangles that face a
// visible side take more: towards gaps that others were seen through, and evenly over area and
// direction, as the rays of images do. Rays from outside find where there are gaps. What faces a
// visible side and continues a visible triangle smoothly stays, and so does whatever max_rays do
// not suffice for. So from what is removed no ray escaped. Rays are decided in double; surfaces
// within 1e-5 of the model's radius are one; gaps narrower than 3e-6 of it count as closed.
//
// Surfaces are visible and occlude from both sides; cut-out materials occlude nothing. Shapes
// shared by several instances lose what is hidden in all of them. Exact shapes are hidden as a
// whole or not at all. What carries decals stays whole. Parts that a joint can move occlude nothing
// but themselves, and are occluded by nothing else: what some joint position uncovers stays. A mesh
// that was closed stays marked so: no more of its back is visible than before. Unused shapes are
// removed; nodes stay. Deterministic, whatever the number of threads.
//
//   scene  valid (scene::check), and valid afterwards; unchanged on failure
//
// Reports: N6304. Fails: E0001.
// Cost: about 0.3 µs per ray on two cores, one or two rays for a triangle in the open; 150 bytes
// per triangle, instances counted. From the cache: a hash of the meshes.
Result<HiddenReport> prune_hidden(scene::Scene& scene, const HiddenOptions& options,
                                  DiagnosticLog& log, const Job& job = {});

}  // namespace panwright::compiler
