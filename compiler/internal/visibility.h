// Which triangles of a model rays from outside reach. Private to compiler.
#pragma once

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "geometry/mesh.h"

namespace panwright::compiler::internal {

// The triangles of a model in world coordinates.
struct WorldTriangles {
  std::vector<Vec3> positions;                // V
  std::vector<geometry::Triangle> triangles;  // T
  std::vector<char> transparent;              // T: occludes nothing
  std::vector<char> candidate;                // T: may be removed where it is hidden
};

struct VisibilityOptions {
  std::uint64_t rays_from_outside = 0;
  std::uint32_t rays_per_triangle = 0;
  std::uint64_t max_probes = 0;
};

struct Visibility {
  std::vector<char> visible;     // T: hit, or ambiguous and kept
  std::vector<char> kept;        // T: the latter
  std::uint64_t rays = 0;        // in all
  std::uint64_t last_rays = 0;   // of the last even distribution from outside, after all others
  std::uint64_t last_found = 0;  // triangles that those were the first to hit
  std::uint64_t probes = 0;      // through each triangle that was not hit
  std::uint64_t ambiguous = 0;   // triangles not hit, and kept
};

// See prune_hidden(). Throws Cancelled.
Visibility visibility_of(WorldTriangles model, const VisibilityOptions& options, const Job& job);

}  // namespace panwright::compiler::internal
