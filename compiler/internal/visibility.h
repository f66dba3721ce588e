// Which triangles lines from outside a model reach.
#pragma once

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "geometry/mesh.h"

namespace panwright::compiler::internal {

// A model in the world.
struct World {
  std::vector<Vec3> positions;                // V
  std::vector<geometry::Triangle> triangles;  // T
  std::vector<char> transparent;              // T: hides nothing
  std::vector<char> candidate;                // T: whether it matters that it is hidden
};

struct VisibilityOptions {
  std::uint64_t rays_from_outside = 0;
  std::uint32_t rays_per_triangle = 0;
  std::uint64_t max_probes = 0;
};

struct Visibility {
  std::vector<char> seen;        // T: or to be kept in doubt
  std::vector<char> kept;        // T: the latter
  std::uint64_t rays = 0;        // in all
  std::uint64_t last_rays = 0;   // from outside, laid evenly, after all else
  std::uint64_t last_found = 0;  // of them, that met something not seen before
  std::uint64_t probes = 0;      // through each triangle that was not seen
  std::uint64_t ambiguous = 0;   // not met, and kept
};

// See prune_hidden(). Throws Cancelled.
Visibility visibility_of(World world, const VisibilityOptions& options, const Job& job);

}  // namespace panwright::compiler::internal
