#include "compiler/internal/round_parts.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>

#include "compiler/internal/sound.h"
#include "compiler/tolerance.h"

namespace panwright::compiler::internal {

double flux_of_shapes(const scene::Scene& scene, const Plan& plan,
                      std::span<const std::uint32_t> place, const pan::Contents& out) {
  double sum = 0;
  for (std::size_t i = 0; i < place.size() && !plan.weights.empty(); ++i) {
    if (place[i] >= out.instances.size()) continue;
    const auto radius =
        radius_of_curvature(scene.shapes[static_cast<std::size_t>(scene.instances[i].shape)]);
    const double error = out.meshes[out.instances[place[i]].mesh].error;
    if (radius && *radius > 0)
      sum += plan.weights[i] * std::min(kFluxFactor * error / *radius, 1.0);
  }
  return sum;
}

void note_coarse(const scene::Scene& scene, const Plan& plan, std::span<const std::uint32_t> place,
                 const pan::Contents& out, DiagnosticLog& log) {
  constexpr double kCoarse = 0.1;
  std::size_t count = 0, worst = 0;
  double most = 0, least_radius = 0;
  for (std::size_t i = 0; i < place.size(); ++i) {
    const MeshJob& job = plan.jobs[plan.job_of[i]];
    // pixels and flux have bounds of their own
    if (place[i] >= out.instances.size() || job.reason != pan::layout::ToleranceReason::tolerance)
      continue;
    const auto radius =
        radius_of_curvature(scene.shapes[static_cast<std::size_t>(scene.instances[i].shape)]);
    const double error = out.meshes[out.instances[place[i]].mesh].error;
    if (!radius || !(error > kCoarse * *radius)) continue;
    ++count;
    if (error / *radius <= most) continue;
    most = error / *radius;
    least_radius = *radius;
    worst = i;
  }
  if (count == 0) return;
  const scene::Instance& instance = scene.instances[worst];
  const bool one = count == 1;
  report_at(instance.source, Code("N2029"),
            fmt::format("{}, this one by {:.2g} % of {:.3g}; the flux of such a part may be "
                        "off by 10 % and more",
                        one ? "1 round part differs from its mesh by over a tenth of its radius"
                            : fmt::format("{} round parts differ from their meshes by over a "
                                          "tenth of their radii",
                                          count),
                        100 * most, least_radius),
            "give a smaller tolerance= to the part, or to the budget", log);
}

}  // namespace panwright::compiler::internal
