// Flux errors of round shapes, which meshes replace by facets.
#pragma once

#include <cstdint>
#include <span>

#include "base/diagnostic.h"
#include "compiler/internal/jobs.h"
#include "pan/writer.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// Below, place: of the scene's instances in out.instances; beyond them: none.

// Returns the sum of the relative flux errors of round shapes, weighted by their part of the
// model's light.
double flux_of_shapes(const scene::Scene& scene, const Plan& plan,
                      std::span<const std::uint32_t> place, const pan::Contents& out);

// Reports: N2029, for round parts whose mesh a stated tolerance leaves over a tenth of their radius
// away.
void note_coarse(const scene::Scene& scene, const Plan& plan, std::span<const std::uint32_t> place,
                 const pan::Contents& out, DiagnosticLog& log);

}  // namespace panwright::compiler::internal
