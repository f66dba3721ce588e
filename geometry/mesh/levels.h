// Levels of detail of a mesh, each with an error bound that holds everywhere.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "base/job.h"
#include "geometry/mesh.h"
#include "geometry/mesh/distance.h"

namespace panwright::geometry {

struct MeshLevel {
  Mesh mesh;                  // error: distance.high
  DistanceInterval distance;  // two-sided, from the full mesh
  NormalError normals;        // of the full mesh against it
  double area_error = 0;      // projected_area_error()
  double flux_error = 0;      // diffuse_flux_error(), if LevelOptions ask for it
};

struct LevelOptions {
  // Tolerances are this times a power of two, metres.
  double unit = 1;
  double least_error = 0;          // metres: finer levels are not needed
  double most_error = 0.05;        // of the diagonal of the bounds
  double most_normal_error = 0.1;  // radians, rms, of the whole
  double most_area_error = 0.005;  // of the whole
  // Of diffuse light; levels beyond it are left out. Infinite: not computed.
  double most_flux_error = std::numeric_limits<double>::infinity();
  double most_part_normal_error = 0.5;
  double most_part_area_error = 0.2;
  // Simplification of parts: the factor between successive errors of the simplifier; the largest
  // share of triangles that a measured step keeps; the accepted width of distance intervals.
  double growth = 2;
  double worth = 0.8;
  double interval = 0.5;
  // Largest share of the previous level's triangles
  double share = 0.7;
  std::size_t least_triangles = 16;  // of a level
  // V, or empty: vertices shared with another mesh. A part with such a vertex keeps its open
  // borders.
  std::span<const char> shared = {};
};

// Returns successively coarser meshes. Parts connected by position, texture coordinates and colour
// are simplified separately, and shared borders kept: an edge between two colours does not move.
// Steps double the simplifier's error, and each is measured. A level takes of each part a step
// whose bound is within its tolerance. Steps with the best saving per error in area and normals
// come first, within the limits of the whole. Tolerances double, from 3e-5 of the diagonal on. So a
// part that cannot be simplified does not limit others, and no part vanishes. The result is
// measured as a whole, which narrows the interval: high ≤ 1.5 · low, or the parts' bound.
//
// Equal for any number of threads, and for one version of meshoptimizer.
//
// Expects: indices in range, finite numbers within ±1e100, 3*T < 2^32.
// Cost: O(V + T log T) for each step and level: 10 to 200 µs for each triangle in all.
std::vector<MeshLevel> mesh_levels(const Mesh& mesh, const LevelOptions& options = {},
                                   const Job& job = {});

}  // namespace panwright::geometry
