#include "compiler/internal/foil_levels.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace panwright::compiler::internal {
namespace {

// Stretches that differ by no more are one.
constexpr double kSameStretch = 1e-6;
// What the mean flux of levels is off (bench/results/levels.csv, wrap_levels.csv).
constexpr double kFluxOfLevels = 0.03;

class FoilLevels {
 public:
  FoilLevels(const scene::Scene& scene, const Plan& plan,
             std::span<const std::uint32_t> mesh_of_job, std::span<const std::uint32_t> place,
             pan::Contents& out, DiagnosticLog& log, const Job& job)
      : scene_(scene),
        plan_(plan),
        mesh_of_job_(mesh_of_job),
        place_(place),
        out_(out),
        log_(log),
        job_(job) {}

  void add() {
    std::map<std::int32_t, const scene::Foil*> foils;
    for (const scene::Foil& foil : scene_.foils)
      if (!foil.levels.empty()) foils[foil.shape] = &foil;
    if (foils.empty()) return;
    std::vector<char> decorated(out_.instances.size());
    for (const pan::DecalContent& decal : out_.decals) decorated[decal.instance] = 1;
    const std::vector<Mat4> world = scene::world_from_nodes(scene_);
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      const auto found = foils.find(scene_.instances[i].shape);
      if (found == foils.end() || place_[i] >= out_.instances.size() || decorated[place_[i]] ||
          plan_.jobs[plan_.job_of[i]].projected())
        continue;
      job_.poll();
      const Stretch stretch = stretch_of(world[static_cast<std::size_t>(scene_.instances[i].node)]);
      if (stretch.smallest < stretch.largest * (1 - kSameStretch)) continue;
      add(*found->second, i, stretch.largest);
    }
    drop_unused();
  }

 private:
  // What the nearest pixel sees of an instance, in its own coordinates, metres; 0: not known.
  double nearest_pixel(double stretch) const {
    const scene::Budget& budget = scene_.budget;
    return budget.nearest && budget.ifov ? *budget.nearest * *budget.ifov / stretch : 0;
  }

  bool flux_allows(std::size_t instance) const {
    const double weight = plan_.weights.empty() ? 1 : plan_.weights[instance];
    return !scene_.budget.flux || weight * kFluxOfLevels <= *scene_.budget.flux;
  }

  void add(const scene::Foil& foil, std::size_t index, double stretch) {
    const std::uint32_t mesh_job = plan_.job_of[index], place = place_[index];
    const double pixel = flux_allows(index) ? nearest_pixel(stretch) : 0;
    std::size_t first = 0;  // of the levels that are not the instance's own mesh
    while (first < foil.levels.size() && foil.levels[first].detail <= pixel) ++first;
    pan::InstanceContent& instance = out_.instances[place];
    if (first > 0) {
      instance.mesh = mesh_of(foil, mesh_job, first - 1);
      report(foil, first - 1, pixel * stretch);
    }
    for (std::size_t k = first; k < foil.levels.size(); ++k)
      out_.levels.push_back({foil.levels[k].detail, foil.levels[k].error, place,
                             mesh_of(foil, mesh_job, k), instance.material, 0});
  }

  std::uint32_t mesh_of(const scene::Foil& foil, std::uint32_t mesh_job, std::size_t level) {
    const auto [known, added] =
        meshes_.try_emplace({mesh_job, level}, static_cast<std::uint32_t>(out_.meshes.size()));
    if (added) {
      const std::string& name = out_.meshes[mesh_of_job_[mesh_job]].name;
      out_.meshes.push_back(
          pan::packed(*foil.levels[level].mesh, fmt::format("{} level {}", name, level + 1)));
      if (plan_.jobs[mesh_job].textured && out_.meshes.back().texcoords.empty())
        out_.meshes.back().texcoords.resize(2 * out_.meshes.back().vertex_count());
      if (!out_.mesh_tolerances.empty())
        out_.mesh_tolerances.push_back(
            {0, static_cast<std::uint32_t>(pan::layout::ToleranceReason::explicit_counts), 0});
    }
    return known->second;
  }

  // once for each sheet
  void report(const scene::Foil& foil, std::size_t level, double pixel) {
    if (!reported_.insert({foil.shape, level}).second) return;
    log_.report(Code("N2024"), {},
                fmt::format("{}:{}:{}: the sheet has cells of {:.3g} m in place of {:.3g} m: a "
                            "pixel of the budget spans {:.3g} m at the nearest",
                            foil.source.file, foil.source.line, foil.source.column,
                            foil.levels[level].detail, foil.recipe.cell(), pixel));
  }

  // Meshes and materials that stood for what is left out now. A sheet's record goes to the mesh
  // that took its place.
  void drop_unused() {
    std::vector<char> used(out_.meshes.size());
    for (const pan::InstanceContent& instance : out_.instances) used[instance.mesh] = 1;
    for (const pan::layout::Level& level : out_.levels) used[level.mesh] = 1;
    for (const std::uint32_t mesh : mesh_of_job_)
      if (mesh < used.size() && !is_of_foil(mesh)) used[mesh] = 1;
    std::map<std::uint32_t, std::uint32_t> instead;
    for (const auto& [key, mesh] : meshes_)
      if (used[mesh]) instead.emplace(mesh_of_job_[key.first], mesh);
    for (pan::layout::Sheet& sheet : out_.sheets)
      if (!used[sheet.mesh] && instead.contains(sheet.mesh)) sheet.mesh = instead[sheet.mesh];
    std::vector<std::uint32_t> moved(used.size());
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < used.size(); ++i) {
      moved[i] = count;
      if (!used[i]) continue;
      if (count != i) {
        out_.meshes[count] = std::move(out_.meshes[i]);
        if (!out_.mesh_tolerances.empty()) out_.mesh_tolerances[count] = out_.mesh_tolerances[i];
      }
      ++count;
    }
    out_.meshes.resize(count);
    if (!out_.mesh_tolerances.empty()) out_.mesh_tolerances.resize(count);
    for (pan::InstanceContent& instance : out_.instances) instance.mesh = moved[instance.mesh];
    for (pan::layout::Level& level : out_.levels) level.mesh = moved[level.mesh];
    for (pan::layout::Sheet& sheet : out_.sheets) sheet.mesh = moved[sheet.mesh];
  }

  bool is_of_foil(std::uint32_t mesh) const {
    return std::ranges::any_of(out_.sheets,
                               [&](const pan::layout::Sheet& sheet) { return sheet.mesh == mesh; });
  }

  const scene::Scene& scene_;
  const Plan& plan_;
  std::span<const std::uint32_t> mesh_of_job_;
  std::span<const std::uint32_t> place_;
  pan::Contents& out_;
  DiagnosticLog& log_;
  const Job& job_;
  std::map<std::pair<std::uint32_t, std::size_t>, std::uint32_t> meshes_;  // by job and level
  std::set<std::pair<std::int32_t, std::size_t>> reported_;
};

}  // namespace

void add_foil_levels(const scene::Scene& scene, const Plan& plan,
                     std::span<const std::uint32_t> mesh_of_job,
                     std::span<const std::uint32_t> place, pan::Contents& out, DiagnosticLog& log,
                     const Job& job) {
  FoilLevels(scene, plan, mesh_of_job, place, out, log, job).add();
}

}  // namespace panwright::compiler::internal
