// Removal of what no viewpoint outside the model sees.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/diagnostic.h"
#include "compiler/compile.h"
#include "scene/scene.h"

namespace panwright::compiler {

struct HiddenOptions {
  // one per instance: whether it may lose faces; empty: all may. All of them hide others.
  std::vector<char> may_lose;
  Options compile;                              // as the model will be compiled with
  std::uint64_t rays_from_outside = 1'000'000;  // at least
  std::uint32_t rays_per_triangle = 256;        // each removed triangle was not seen along so many
  // Spent on triangles that nothing met but that face a surface which is seen, 2048 for each, and
  // as many once more by area. Where it is not enough for all of them, they stay.
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
  std::uint64_t hidden = 0;  // triangles never seen: what was removed, and what shared shapes keep
  // Never seen and kept: for want of max_probes, or as smooth neighbours of what is seen.
  std::uint64_t ambiguous = 0;
  std::uint64_t rays = 0;
  std::uint64_t reached = 0;  // rays of the last round that found something new
  // With 95 % confidence, the share of all directions from points of the removed triangles together
  // (by number) that lead outside; and of any one of them.
  double open_share = 0;
  double open_share_each = 0;
  double seconds = 0;
};

// Takes away the triangles of meshes, and whole instances, that no ray from outside reaches. At
// rest: joints are not moved.
//
// Lines from outside are followed to the first surface; whatever they meet there, and what lies in
// the same surface to 1e-5 of the model's radius, stays. Lines are laid through the model evenly,
// then through corners, edges and insides of the triangles not yet met, close to lines that found
// something, and from where the neighbours of a triangle are seen, until a last even lot finds
// nothing. What faces a seen surface and goes on smoothly from a seen triangle stays with it. So
// what is removed was never met, and nothing that is met is removed; gaps narrower than
// 3e-6 of the radius are taken as closed. Hits on outlines are decided in double. Surfaces are seen
// and hide from both sides; cut-out materials hide nothing. Shapes shared by several instances lose
// what all of them hide. Exact shapes are hidden as a whole or not at all. What carries decals
// stays whole. A mesh that was closed stays marked so: its back is seen no more than before. Shapes
// that nothing uses any more go; nodes stay. Deterministic, whatever the number of threads.
//
//   scene  sound (scene::check), and sound afterwards; as it was when it fails
//
// Reports: N6304. Fails: E0001.
// Cost: about 1 µs a ray on two cores; 400 bytes a triangle, instances counted.
Result<HiddenReport> prune_hidden(scene::Scene& scene, const HiddenOptions& options,
                                  DiagnosticLog& log, const Job& job = {});

}  // namespace panwright::compiler
