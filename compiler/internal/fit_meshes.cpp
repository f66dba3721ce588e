// Meshes that the budget lets be coarser.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>
#include <variant>

#include "base/axis_box.h"
#include "base/clock.h"
#include "base/parallel.h"
#include "compiler/internal/fit.h"
#include "compiler/internal/shared_borders.h"
#include "geometry/mesh/bytes.h"
#include "geometry/mesh/levels.h"

namespace panwright::compiler::internal {
namespace {

using geometry::Mesh;
using geometry::MeshShape;

constexpr std::size_t kLeastTriangles = 64;
// What levels begin with: the tolerance may be more than the light allows.
constexpr double kFinest = 1.0 / 16;    // of the tolerance
constexpr double kFine = 1e-4;          // of the diagonal
constexpr double kCoarsestMesh = 0.25;  // of the diagonal: the coarsest

class Simplifier {
 public:
  Simplifier(scene::Scene& scene, const Allotment& allotment, const WorkCache* cache,
             FitReport& report, const Job& job)
      : scene_(scene), allotment_(allotment), cache_(cache), report_(report), job_(job) {}

  std::vector<std::optional<Tolerance>> run() {
    std::vector<std::optional<Tolerance>> made_to(scene_.shapes.size());
    choose();
    if (chosen_.empty()) return made_to;
    find_shared();
    std::vector<std::optional<Made>> made(chosen_.size());
    Phase phase(job_, "simplifying", chosen_.size());
    parallel_for(
        chosen_.size(),
        [&](std::size_t i) {
          made[i] = reused_or_make(chosen_[i]);
          phase.advance();
        },
        job_);
    for (std::size_t i = 0; i < made.size(); ++i) {
      if (!made[i]) continue;
      scene_.shapes[chosen_[i].shape] = std::move(made[i]->mesh);
      made_to[chosen_[i].shape] = chosen_[i].tolerance;
      report_.flux_simplified += weight_of(chosen_[i].shape) * made[i]->entry.flux;
      report_.simplified.push_back(std::move(made[i]->entry));
    }
    std::stable_sort(report_.simplified.begin(), report_.simplified.end(),
                     [](const Simplified& a, const Simplified& b) {
                       return a.before - a.after > b.before - b.after;
                     });
    return made_to;
  }

 private:
  struct Chosen {
    std::size_t shape = 0;
    std::size_t user = 0;     // the first instance
    Tolerance tolerance;      // metres in the mesh's frame
    double flux = HUGE_VAL;   // relative
    double slope = HUGE_VAL;  // the least of microfacets
    std::vector<char> shared;
  };
  struct Made {
    MeshShape mesh;
    Simplified entry;
  };

  double weight_of(std::size_t shape) const {
    double sum = 0;
    for (std::size_t i = 0; i < allotment_.weight.size(); ++i)
      if (static_cast<std::size_t>(scene_.instances[i].shape) == shape) sum += allotment_.weight[i];
    return sum;
  }

  void choose() {
    std::vector<char> stays(scene_.shapes.size());
    for (const scene::Foil& foil : scene_.foils) stays[static_cast<std::size_t>(foil.shape)] = 1;
    for (const scene::Decal& decal : scene_.decals)
      stays[static_cast<std::size_t>(
          scene_.instances[static_cast<std::size_t>(decal.instance)].shape)] = 1;
    const std::vector<Mat4> world = scene::world_from_nodes(scene_);
    std::vector<std::size_t> place(scene_.shapes.size(), scene_.shapes.size());
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      const scene::Instance& instance = scene_.instances[i];
      const auto shape = static_cast<std::size_t>(instance.shape);
      const auto* mesh = std::get_if<MeshShape>(&scene_.shapes[shape]);
      const Stretch stretch = stretch_of(world[static_cast<std::size_t>(instance.node)]);
      const auto is_textured = [&](std::int32_t index) {
        if (index == scene::kNone) return false;
        const materials::Material& material = scene_.materials[static_cast<std::size_t>(index)];
        return material.maps.any() || material.cells.has_value();
      };
      const bool textured = is_textured(instance.material) || is_textured(instance.back);
      if (mesh == nullptr || stays[shape] || (*mesh)->triangles.size() < kLeastTriangles ||
          !(stretch.largest > 0) || (textured && (*mesh)->texcoords.empty())) {
        stays[shape] = 1;
        continue;
      }
      scene::Budget budget = allotment_.of(scene_.budget, i);
      if (!budget.pixels && !budget.centroid) budget.pixels = scene::Budget::kDefaultPixels;
      Tolerance tolerance =
          tolerance_for(budget, geometry::Plane{}, stretch, {instance.tolerance, {}, {}});
      tolerance.metres /= stretch.largest;
      if (place[shape] == scene_.shapes.size()) {
        place[shape] = chosen_.size();
        chosen_.push_back({shape, i, tolerance, HUGE_VAL, HUGE_VAL, {}});
      }
      Chosen& chosen = chosen_[place[shape]];
      if (tolerance.metres < chosen.tolerance.metres) chosen.tolerance = tolerance;
      chosen.flux = std::min(chosen.flux, budget.flux.value_or(HUGE_VAL));
      chosen.slope = std::min(chosen.slope, microfacet_slope(scene_, instance).value_or(HUGE_VAL));
    }
    std::erase_if(chosen_, [&](const Chosen& chosen) { return stays[chosen.shape] != 0; });
  }

  void find_shared() {
    std::vector<Surface> meshes;
    std::vector<std::uint32_t> place(scene_.shapes.size());
    for (std::size_t s = 0; s < scene_.shapes.size(); ++s)
      if (const auto* mesh = std::get_if<MeshShape>(&scene_.shapes[s])) {
        place[s] = static_cast<std::uint32_t>(meshes.size());
        meshes.push_back(surface_of(**mesh));
      }
    const std::vector<Mat4> nodes = scene::world_from_nodes(scene_);
    std::vector<PlacedSurface> placed;
    std::vector<Mat4> world;
    for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
      const auto shape = static_cast<std::size_t>(scene_.instances[i].shape);
      world.push_back(nodes[static_cast<std::size_t>(scene_.instances[i].node)]);
      if (std::holds_alternative<MeshShape>(scene_.shapes[shape]))
        placed.push_back({place[shape], i});
    }
    const auto shared = shared_borders(meshes, placed, world, Compared::borders, job_);
    for (Chosen& chosen : chosen_) {
      const std::uint32_t mesh = place[chosen.shape];
      chosen.shared = shared ? (*shared)[mesh] : std::vector<char>(meshes[mesh].vertices, 1);
    }
  }

  // Of all that make() follows from.
  Hash128 key_of(const Chosen& chosen) const {
    KeyHasher key;
    geometry::add_to_key(*std::get<MeshShape>(scene_.shapes[chosen.shape]), key);
    key.real(chosen.tolerance.metres);
    key.real(chosen.flux);
    key.real(chosen.slope);
    key.list(chosen.shared);
    return key.key();
  }

  static void write(const std::optional<Made>& made, ByteWriter& to) {
    to.number(made.has_value());
    if (!made) return;
    geometry::write(*made->mesh, to);
    to.number(made->entry.before);
    for (const double value : {made->entry.error, made->entry.flux, made->entry.normals})
      to.real(value);
  }

  static std::optional<Made> read(ByteReader& from) {
    if (from.number() == 0) return {};
    Made made;
    auto mesh = std::make_shared<Mesh>(geometry::read_mesh(from));
    made.entry.before = from.number();
    made.entry.after = mesh->triangles.size();
    for (double* value : {&made.entry.error, &made.entry.flux, &made.entry.normals})
      *value = from.real();
    if (mesh->triangles.empty()) from.fail();
    made.mesh = std::move(mesh);
    return made;
  }

  // Whether it can be made coarser is worth keeping too.
  std::optional<Made> reused_or_make(const Chosen& chosen) const {
    auto made = *remember<std::optional<Made>>(
        cache_, Work::simplified, [&] { return key_of(chosen); },
        [&] { return std::optional<std::optional<Made>>(std::in_place, make(chosen)); }, write,
        read);
    if (made) made->entry.name = name_of(scene_, chosen.user);
    return made;
  }

  std::optional<Made> make(const Chosen& chosen) const {
    const auto start = std::chrono::steady_clock::now();
    const MeshShape& full = std::get<MeshShape>(scene_.shapes[chosen.shape]);
    AxisBox box;
    for (const Vec3& p : full->positions) box.add(p);
    const double diagonal = box.diagonal();
    if (!(diagonal > 0)) return {};
    const double most_flux = chosen.flux;
    geometry::LevelOptions options;
    options.unit = chosen.tolerance.metres;
    options.least_error = std::min(kFinest * chosen.tolerance.metres, kFine * diagonal);
    options.most_error = std::min(chosen.tolerance.metres / diagonal * (1 + 1e-12), kCoarsestMesh);
    options.most_area_error = std::min(options.most_area_error, most_flux);
    options.most_normal_error = std::min(options.most_normal_error, chosen.slope / 4);
    options.most_flux_error = std::min(most_flux, 1.0);
    options.shared = chosen.shared;
    options.share = 0.95;
    // one level is wanted, and as coarse as may be
    options.growth = 1.4;
    options.worth = 0.9;
    options.interval = 0.5;
    auto levels = geometry::mesh_levels(*full, options, job_);
    for (std::size_t k = levels.size(); k-- > 0;) {
      geometry::MeshLevel& level = levels[k];
      if (level.distance.high > chosen.tolerance.metres || level.area_error > most_flux) continue;
      Simplified entry;
      entry.before = full->triangles.size();
      entry.after = level.mesh.triangles.size();
      entry.error = level.distance.high;
      entry.flux = level.flux_error;
      entry.normals = level.normals.rms;
      entry.seconds = seconds_since(start);
      level.mesh.error = full->error + level.distance.high;
      return Made{std::make_shared<const Mesh>(std::move(level.mesh)), std::move(entry)};
    }
    return {};
  }

  scene::Scene& scene_;
  const Allotment& allotment_;
  const WorkCache* cache_;
  FitReport& report_;
  const Job& job_;
  std::vector<Chosen> chosen_;
};

}  // namespace

std::vector<std::optional<Tolerance>> simplify_meshes(scene::Scene& scene,
                                                      const Allotment& allotment,
                                                      const WorkCache* cache, FitReport& report,
                                                      const Job& job) {
  return Simplifier(scene, allotment, cache, report, job).run();
}

}  // namespace panwright::compiler::internal
