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
  // one for each instance: whether it may lose faces; empty: all may. All of them hide others.
  std::vector<char> may_lose;
  Options compile;                              // as the model will be compiled with
  std::uint64_t rays_from_outside = 1'000'000;  // at least
  std::uint32_t rays_per_triangle = 64;         // each removed triangle was not seen along so many
  std::uint64_t max_triangles = 40'000'000;     // instances counted; a larger model is left alone
};

struct HiddenReport {
  std::uint64_t triangles_before = 0;  // instances counted
  std::uint64_t triangles_after = 0;
  std::uint64_t unique_before = 0;  // of meshes
  std::uint64_t unique_after = 0;
  std::uint64_t instances_before = 0;
  std::uint64_t instances_after = 0;
  std::uint64_t hidden = 0;  // triangles never seen: what was removed, and what shared shapes keep
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
// Lines from outside are followed to the first surface; whatever they meet there, and within 1e-6
// of the model's radius behind it, stays. Lines are laid through the model evenly, then through
// corners, edges and insides of the triangles not yet met, in rounds until they find nothing new,
// and close to lines that found something rarely seen. So what is removed was never met, and
// nothing that is met is removed. Hits on outlines are decided in double. Surfaces hide from both
// sides; cut-out materials hide nothing. Shapes shared by several instances lose what all of them
// hide. Exact shapes are hidden as a whole or not at all. What carries decals stays whole. A mesh
// that was closed stays marked so: its back is seen no more than before. Deterministic, whatever
// the number of threads.
//
//   scene  sound (scene::check), and sound afterwards; unused shapes stay as empty meshes' users go
//
// Reports: N6304.
// Cost: about 1 µs a ray on two cores; 400 bytes a triangle, instances counted.
HiddenReport prune_hidden(scene::Scene& scene, const HiddenOptions& options, DiagnosticLog& log);

}  // namespace panwright::compiler
