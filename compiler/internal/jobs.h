// The meshes of a scene and their tolerances.
#pragma once

#include <cstdint>
#include <vector>

#include "base/hash.h"
#include "compiler/compile.h"
#include "compiler/internal/fit.h"
#include "compiler/tolerance.h"
#include "geometry/tessellate/tessellate.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// One mesh of the file: a shape, with texture coordinates if a material or texture uses them.
struct MeshJob {
  const geometry::Shape* shape = nullptr;
  Hash128 hash;  // of the shape
  bool textured = false;
  scene::Mapping mapping = scene::Mapping::texcoords;
  Mat4 texture_from_shape{1};
  bool boxed = false;  // a mesh without texture coordinates, which takes those of its bounds
  const scene::Instance* user = nullptr;  // the first one
  double max_error = 0;                   // metres in the shape's frame, > 0: the smallest
  pan::layout::ToleranceReason reason = pan::layout::ToleranceReason::tolerance;
  std::uint32_t edge_segments = 0;  // 0: as many as the error needs
  std::vector<std::uint32_t> decals;
  bool projected() const { return textured && mapping == scene::Mapping::sphere; }
};

struct Plan {
  std::vector<MeshJob> jobs;
  std::vector<std::uint32_t> job_of;  // one per instance
  std::vector<double> weights;        // of instances, Allotment::weight; empty: not known
  bool asked = false;                 // by a budget, an instance or the command line
  double smallest = 0;                // tolerance in the world, metres; 0: all counts are explicit
};

// Returns the jobs of a scene. Instances of equal shapes with equal texture mappings share a job at
// the smallest tolerance in the shape's frame.
//
// Cost: O(instances + bytes of the shapes).
//   allotment  of the budget to the instances
Plan plan_of(const scene::Scene& scene, const std::vector<Mat4>& world, const Options& options,
             const Allotment& allotment = {});

geometry::TessellationOptions tessellation_of(const MeshJob& job, const Options& options);

// Gives jobs whose circular edges meet in the world as many segments as the largest need among
// them, so that their vertices meet too. CircularEdges meet if centre, axis and radius agree to
// 1e-6 of the radius. If they are turned against each other, up to an eighth more segments are
// tried. They are left alone if none fits, or if an edge became an ellipse.
//
// Cost: O(instances) expected, whatever their number at one place.
void share_circular_edges(const std::vector<Mat4>& world, const scene::Scene& scene, Plan& plan);

}  // namespace panwright::compiler::internal
