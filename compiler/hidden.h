// Hidden-geometry removal: triangles that no viewpoint outside the model sees.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/diagnostic.h"
#include "compiler/compile.h"
#include "scene/scene.h"

namespace panwright::compiler {

struct HiddenOptions {
  // one per instance: whether it may lose faces; empty: all may. All of them occlude others.
  std::vector<char> may_lose;
  Options compile;                              // as the model will be compiled with
  std::uint64_t rays_from_outside = 1'000'000;  // at least
  std::uint32_t rays_per_triangle = 256;        // that each removed triangle was not hit by
  // Spent on triangles that no ray hit but that face a visible surface, 2048 for each, and as many
  // again by area. Where it is not enough for all of them, they stay.
  std::uint64_t max_probes = 12'000'000;
  std::uint64_t max_triangles = 8'000'000;  // instances counted; a larger model is left alone
};

struct HiddenReport {
  std::uint64_t triangles_before = 0;  // instances counted
  std::uint64_t triangles_after = 0;
  std::uint64_t unique_before = 0;  // of meshes
  std::uint64_t unique_after = 0;
  std::uint64_t instances_before = 0;
  std::uint64_t instances_after = 0;
  std::uint64_t hidden = 0;  // triangles never hit: what was removed, and what shared shapes keep
  // Never hit and kept: max_probes did not suffice, or a visible neighbour continues smoothly.
  std::uint64_t ambiguous = 0;
  std::uint64_t rays = 0;
  std::uint64_t reached = 0;  // rays of the last round that found something new
  // With 95 % confidence, the share of all directions from points of the removed triangles together
  // (by number) that lead outside; and of any one of them.
  double open_share = 0;
  double open_share_each = 0;
  double seconds = 0;
};

// Removes the triangles of meshes, and whole instances, that no ray from outside reaches. Joints
// stay at rest.
//
// Visibility rays from outside are followed to the first surface; whatever they hit there, and what
// coincides with it to 1e-5 of the model's radius, stays. Rays are distributed over the model
// evenly, then through corners, edges and insides of the triangles not yet hit, close to rays that
// found something, and from where the neighbours of a triangle are visible, until a last even
// distribution finds nothing. What faces a visible surface and continues a visible triangle
// smoothly stays too. So what is removed was never hit, and nothing that is hit is removed; gaps
// narrower than 3e-6 of the radius count as closed. Hits on outlines are decided in double.
// Surfaces are visible and occlude from both sides; cut-out materials occlude nothing. Shapes
// shared by several instances lose what is hidden in all of them. Exact shapes are hidden as a
// whole or not at all. What carries decals stays whole. A mesh that was closed stays marked so: no
// more of its back is visible than before. Unused shapes are removed; nodes stay. Deterministic,
// whatever the number of threads.
//
//   scene  valid (scene::check), and valid afterwards; unchanged on failure
//
// Reports: N6304. Fails: E0001.
// Cost: about 1 µs per ray on two cores; 400 bytes per triangle, instances counted.
Result<HiddenReport> prune_hidden(scene::Scene& scene, const HiddenOptions& options,
                                  DiagnosticLog& log, const Job& job = {});

}  // namespace panwright::compiler
