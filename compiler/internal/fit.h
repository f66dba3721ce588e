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

// What each instance has of the budget. Empty: the same for all.
struct Allotment {
  std::vector<double> nearest;  // metres: the budget's, from where the camera may be
  std::vector<double> share;    // of its flux and centroid; may be above 1
  std::vector<double> weight;   // what it sends of the model's light
  scene::Budget of(const scene::Budget& budget, std::size_t instance) const;
};

struct Fitted {
  const scene::Scene* authored = nullptr;
  std::optional<scene::Scene> changed;  // where the budget asks for it
  const scene::Scene& scene() const { return changed ? *changed : *authored; }
  Allotment allotment;
  // Of each shape that was simplified, what to: metres in the mesh's frame.
  std::vector<std::optional<Tolerance>> made_to;
  FitReport report;
};

// The authored scene must outlive the result. Deterministic, whatever the number of threads.
// Reports: N2025. Throws Cancelled.
//
//   max_error  nothing is left out or simplified, the command line decides all
//   cache      of meshes that were simplified before; null: none
// Cost: about 5 µs a triangle for parts; 10 to 200 µs a triangle for meshes that are simplified.
Fitted fitted_to_budget(const scene::Scene& scene, const std::optional<double>& max_error,
                        const WorkCache* cache, DiagnosticLog& log, const Job& job);

// Leaves out parts, and allots the budget to the instances that stay. Instances of `scene` go, and
// of the allotment with them.
void allot(scene::Scene& scene, Allotment& allotment, FitReport& report, const Job& job);

// Textures that are made smaller.
void reduce_textures(scene::Scene& scene, const Allotment& allotment, FitReport& report,
                     const Job& job);

// Shares of the budget's flux, and as much of its centroid, for each instance: those with which the
// model has the fewest triangles while the sum of weight times share is kPartsShare. Equal shapes
// have one share. Triangles go with a power of the error, found by planning each shape twice.
//
//   weights  one per instance: its share of what the model sends
std::vector<double> shares_of(const scene::Scene& scene, const std::vector<double>& weights);

// Meshes that are simplified.
//
//   returns  one per shape: what it was made to, metres in its frame; none: as it was
std::vector<std::optional<Tolerance>> simplify_meshes(scene::Scene& scene,
                                                      const Allotment& allotment,
                                                      const WorkCache* cache, FitReport& report,
                                                      const Job& job);

// The nearest name above an instance.
std::string name_of(const scene::Scene& scene, std::size_t instance);

}  // namespace panwright::compiler::internal
