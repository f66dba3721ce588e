// Triangles of a model that are visible from outside. Private to compiler.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/job.h"
#include "geometry/mesh.h"

namespace panwright::compiler::internal {

// A placed mesh.
struct VisibilityPart {
  std::uint32_t mesh = 0;
  Mat4 world_from_mesh{1};
  bool transparent = false;  // occludes nothing
  bool candidate = true;     // may lose triangles, or be removed
};

// Meshes and their placements. Parts are rigid against each other.
struct VisibilityModel {
  std::vector<std::shared_ptr<const geometry::Mesh>> meshes;  // M, not null
  std::vector<char> divisible;                                // M: may lose single triangles
  std::vector<VisibilityPart> parts;                          // P, no two alike
};

struct VisibilityOptions {
  std::uint32_t rays_per_triangle = 64;  // without escape, at least, for a hidden triangle
  std::uint64_t max_rays = 0;            // in all
  double least_slack = 0;                // metres: distance within which surfaces count as one
};

struct Visibility {
  std::vector<char> part_visible;        // P: with a visible or kept triangle
  std::vector<std::vector<char>> shown;  // M, T: visible or kept in some part
  std::uint64_t rays = 0;                // in all
  std::uint64_t last_found = 0;          // triangles found by the last rays from outside
  std::uint64_t probes = 0;              // from each hidden triangle
  std::uint64_t ambiguous = 0;           // triangles of parts, unseen and kept
  bool capped = false;                   // out of rays
};

// See prune_hidden(). Throws Cancelled.
Visibility visibility_of(const VisibilityModel& model, const VisibilityOptions& options,
                         const Job& job);

}  // namespace panwright::compiler::internal
