// The scene that a budget needs (compiler/fit.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/work_cache.h"
#include "compiler/fit.h"
#include "compiler/tolerance.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// Shares of the budget by instance. Empty: the same for all.
struct Allotment {
  std::vector<double> nearest;  // metres: the budget's, by the camera's positions
  std::vector<double> share;    // of its flux and centroid; may be above 1
  std::vector<double> weight;   // share of the model's light
  scene::Budget of(const scene::Budget& budget, std::size_t instance) const;
};

struct Fitted {
  const scene::Scene* authored = nullptr;
  std::optional<scene::Scene> changed;  // none: unchanged
  const scene::Scene& scene() const { return changed ? *changed : *authored; }
  Allotment allotment;
  // Tolerance of each simplified shape, metres in the mesh's frame.
  std::vector<std::optional<Tolerance>> made_to;
  FitReport report;
};

// Fits a scene to its budget. The authored scene must outlive the result. Deterministic, whatever
// the number of threads.
// Reports: N2025. Throws Cancelled.
//
//   max_error  of the command line; if given, nothing is left out or simplified
//   cache      of simplified meshes; null: none
// Cost: about 5 µs a triangle for parts; 10 to 200 µs a triangle for simplified meshes.
Fitted fitted_to_budget(const scene::Scene& scene, const std::optional<double>& max_error,
                        const WorkCache* cache, DiagnosticLog& log, const Job& job);

// Leaves out parts, and allots the budget to the kept instances. Removed instances lose their
// allotment too.
void allot(scene::Scene& scene, Allotment& allotment, FitReport& report, const Job& job);

// Reduces the resolution of textures.
void reduce_textures(scene::Scene& scene, const Allotment& allotment, FitReport& report,
                     const Job& job);

// Returns the share of the budget's flux, and of its centroid, for each instance: those with the
// fewest triangles at a sum of weight times share of kPartsShare. Equal shapes have one share.
// Triangles go with a power of the error, found by planning each shape twice.
//
//   weights  one per instance: its share of the model's light
std::vector<double> shares_of(const scene::Scene& scene, const std::vector<double>& weights);

// Simplifies meshes.
//
//   returns  one per shape: its tolerance, metres in its frame; none: unchanged
std::vector<std::optional<Tolerance>> simplify_meshes(scene::Scene& scene,
                                                      const Allotment& allotment,
                                                      const WorkCache* cache, FitReport& report,
                                                      const Job& job);

// Returns the nearest name above an instance.
std::string name_of(const scene::Scene& scene, std::size_t instance);

}  // namespace panwright::compiler::internal
