#include "compiler/internal/jobs.h"

#include "compiler/internal/storage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "base/hash.h"
#include "base/parallel.h"

namespace panwright::compiler::internal {

namespace {

// what is below or above no mesh can keep or needs (geometry::kMinRadius, kMaxCoordinate)
constexpr double kLeastError = 1e-60;
constexpr double kMostError = 1e30;

using JobKey = std::tuple<Hash128, bool, bool, bool, std::array<double, 16>>;

JobKey key_of(const MeshJob& job) {
  std::array<double, 16> matrix{};
  if (job.projected())
    for (int i = 0; i < 16; ++i)
      matrix[static_cast<std::size_t>(i)] = job.texture_from_shape[i / 4][i % 4];
  return {job.hash, job.textured, job.projected(), job.boxed, matrix};
}

bool needs_texcoords(const scene::Scene& scene, const scene::Instance& instance) {
  const auto needs = [&](std::int32_t index) {
    const materials::Material& material = scene.materials[static_cast<std::size_t>(index)];
    // anisotropic microfacets lie along u and v
    return material.maps.any() || material.cells || materials::is_anisotropic(material);
  };
  return instance.texture != scene::kNone || needs(instance.material) ||
         (instance.back != scene::kNone && needs(instance.back));
}

// Lowers the job's error to what one of its instances asks for.
void refine(MeshJob& job, const Tolerance& tolerance, const Stretch& stretch) {
  const double local = stretch.largest > 0 ? tolerance.metres / stretch.largest : kMostError;
  if (job.max_error > 0 && !(local < job.max_error)) return;
  job.max_error = std::clamp(local, kLeastError, kMostError);
  job.reason = tolerance.reason;
}

}  // namespace

Plan plan_of(const scene::Scene& scene, const std::vector<Mat4>& world, const Options& options,
             const Allotment& allotment) {
  std::vector<Hash128> hashes(scene.shapes.size());
  parallel_for(hashes.size(),
               [&](std::size_t i) { hashes[i] = geometry::hash_of(scene.shapes[i]); });
  std::vector<Stretch> stretches(world.size());
  for (std::size_t i = 0; i < world.size(); ++i) stretches[i] = stretch_of(world[i]);
  Plan plan;
  plan.weights = allotment.weight;
  plan.asked = scene.budget.any() || options.max_error.has_value();
  std::map<JobKey, std::uint32_t> known;
  for (const scene::Instance& instance : scene.instances) {
    const auto shape = static_cast<std::size_t>(instance.shape);
    MeshJob job;
    job.shape = &scene.shapes[shape];
    job.hash = hashes[shape];
    job.textured = needs_texcoords(scene, instance);
    job.mapping = instance.mapping;
    job.texture_from_shape = instance.texture_from_shape;
    // a texture of the file's own lies where the file says: nowhere
    if (const auto* mesh = std::get_if<geometry::MeshShape>(job.shape))
      job.boxed = job.textured && instance.texture == scene::kNone && (*mesh)->texcoords.empty();
    job.user = &instance;
    const auto [place, added] =
        known.emplace(key_of(job), static_cast<std::uint32_t>(plan.jobs.size()));
    if (added) plan.jobs.push_back(std::move(job));
    plan.job_of.push_back(place->second);
    const Stretch& stretch = stretches[static_cast<std::size_t>(instance.node)];
    const scene::Budget budget = allotment.of(scene.budget, plan.job_of.size() - 1);
    const Tolerance tolerance =
        tolerance_for(budget, scene.shapes[shape], stretch,
                      {instance.tolerance, options.max_error, microfacet_slope(scene, instance)});
    refine(plan.jobs[place->second], tolerance, stretch);
    plan.asked |= instance.tolerance.has_value();
    if (tolerance.reason != pan::layout::ToleranceReason::explicit_counts)
      plan.smallest =
          plan.smallest > 0 ? std::min(plan.smallest, tolerance.metres) : tolerance.metres;
  }
  for (std::size_t i = 0; i < scene.decals.size(); ++i) {
    const auto instance = static_cast<std::size_t>(scene.decals[i].instance);
    plan.jobs[plan.job_of[instance]].decals.push_back(static_cast<std::uint32_t>(i));
  }
  share_circular_edges(world, scene, plan);
  return plan;
}

geometry::TessellationOptions tessellation_of(const MeshJob& job, const Options& options) {
  geometry::TessellationOptions out;
  // storage in few bits has its share of the tolerance
  out.max_error = job.max_error * (options.storage.streams() ? 1 - kStorageShare : 1);
  out.max_triangles = options.max_triangles;
  out.texcoords = job.textured && !job.projected();
  out.edge_segments = job.edge_segments;
  return out;
}

}  // namespace panwright::compiler::internal
