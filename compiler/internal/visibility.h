// Which triangles of a model can be seen from outside. Private to compiler.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/job.h"
#include "geometry/mesh.h"

namespace panwright::compiler::internal {

// A mesh in its place.
struct VisibilityPart {
  std::uint32_t mesh = 0;
  Mat4 world_from_mesh{1};
  bool transparent = false;  // occludes nothing
  bool candidate = true;     // may lose triangles, or go
};

// Meshes and where they stand. Parts are rigid against each other.
struct VisibilityModel {
  std::vector<std::shared_ptr<const geometry::Mesh>> meshes;  // M, not null
  std::vector<char> divisible;                                // M: may lose single triangles
  std::vector<VisibilityPart> parts;                          // P, no two alike
};

struct VisibilityOptions {
  std::uint32_t rays_per_triangle = 64;  // without escape, at least, before it counts as hidden
  std::uint64_t max_rays = 0;            // in all
  double least_slack = 0;                // metres: of what counts as one surface
};

struct Visibility {
  std::vector<char> part_visible;        // P: with a triangle that is seen, or kept
  std::vector<std::vector<char>> shown;  // M, T: seen or kept in some part
  std::uint64_t rays = 0;                // in all
  std::uint64_t last_found = 0;          // triangles that the last rays from outside found
  std::uint64_t probes = 0;              // from each triangle that is hidden
  std::uint64_t ambiguous = 0;           // triangles of parts, not seen and kept
  bool capped = false;                   // for want of rays
};

// See prune_hidden(). Throws Cancelled.
Visibility visibility_of(const VisibilityModel& model, const VisibilityOptions& options,
                         const Job& job);

}  // namespace panwright::compiler::internal
