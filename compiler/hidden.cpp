#include "compiler/hidden.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <tuple>
#include <utility>

#include "base/clock.h"
#include "base/parallel.h"
#include "compiler/internal/jobs.h"
#include "compiler/internal/scene_edit.h"
#include "compiler/internal/visibility.h"
#include "compiler/internal/visibility_cache.h"
#include "geometry/tessellate/tessellate.h"

namespace panwright::compiler {

namespace {

using geometry::Mesh;
using geometry::MeshShape;

// The meshes of the compiled model, one per instance; null: cannot be tessellated.
std::vector<MeshShape> meshes_of(const scene::Scene& scene, const std::vector<Mat4>& world,
                                 const Options& options, const Job& job_of_all) {
  const internal::Plan plan = internal::plan_of(scene, world, options);
  std::vector<MeshShape> made(plan.jobs.size());
  const auto make = [&](std::size_t i) {
    const internal::MeshJob& job = plan.jobs[i];
    if (const auto* mesh = std::get_if<MeshShape>(job.shape)) {
      made[i] = *mesh;
      return;
    }
    DiagnosticLog ignored;  // the compilation reports the same
    const auto tessellation = internal::tessellation_of(job, options);
    if (geometry::planned_triangles(*job.shape, tessellation) >
        static_cast<double>(options.max_triangles))
      return;
    if (auto mesh = geometry::tessellated(*job.shape, tessellation, {}, ignored))
      made[i] = std::make_shared<const Mesh>(std::move(*mesh));
  };
  parallel_for(made.size(), make, job_of_all);
  std::vector<MeshShape> out;
  for (const std::uint32_t job : plan.job_of) out.push_back(made[job]);
  return out;
}

// Of each node, a number of the rigid body that it belongs to: what a joint can move starts one.
std::vector<std::int32_t> bodies_of(const scene::Scene& scene) {
  std::vector<char> moves(scene.nodes.size(), 0);
  for (const scene::Joint& joint : scene.joints)
    if (scene::can_move(joint)) moves[static_cast<std::size_t>(joint.node)] = 1;
  std::vector<std::int32_t> bodies(scene.nodes.size(), 0);
  for (std::size_t n = 0; n < bodies.size(); ++n) {
    const std::int32_t parent = scene.nodes[n].parent;
    if (moves[n])
      bodies[n] = static_cast<std::int32_t>(n);
    else if (parent != scene::kNone)
      bodies[n] = bodies[static_cast<std::size_t>(parent)];
  }
  return bodies;
}

// One rigid body: its meshes in their places, equal ones once.
struct Body {
  internal::VisibilityModel model;
  std::vector<std::pair<std::size_t, std::uint32_t>> parts;  // instance, part of the model
};

class Pruner {
 public:
  Pruner(scene::Scene& scene, const HiddenOptions& options, const Job& job)
      : scene_(scene), options_(options), job_(job) {}

  HiddenReport run() {
    const auto start = std::chrono::steady_clock::now();
    world_from_node_ = scene::world_from_nodes(scene_);
    meshes_ = meshes_of(scene_, world_from_node_, options_.compile, job_);
    for (const MeshShape& mesh : meshes_)
      report_.triangles_before += mesh ? mesh->triangles.size() : 0;
    report_.triangles_after = report_.triangles_before;
    report_.instances_before = report_.instances_after = scene_.instances.size();
    report_.unique_before = report_.unique_after = unique_triangles();
    if (report_.triangles_before <= options_.max_triangles) prune();
    report_.seconds = seconds_since(start);
    return report_;
  }

 private:
  std::uint64_t unique_triangles() const {
    std::vector<char> counted(scene_.shapes.size(), 0);
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      const auto shape = static_cast<std::size_t>(scene_.instances[i].shape);
      if (!counted[shape] && meshes_[i]) sum += meshes_[i]->triangles.size();
      counted[shape] = 1;
    }
    return sum;
  }

  void prune() {
    find_allowed();
    if (std::find(allowed_.begin(), allowed_.end(), 1) == allowed_.end()) return;
    visible_.assign(scene_.instances.size(), 1);
    shown_.resize(scene_.shapes.size());
    std::uint64_t probes = 0;
    std::size_t searched = 0;
    std::size_t known = 0;
    for (const Body& body : bodies()) {
      if (std::none_of(body.model.parts.begin(), body.model.parts.end(),
                       [](const internal::VisibilityPart& part) { return part.candidate; })) {
        show_all(body);
        continue;
      }
      const std::uint64_t left = options_.max_rays - std::min(options_.max_rays, report_.rays);
      bool is_known = false;
      const internal::Visibility found = internal::cached_visibility_of(
          body.model, {options_.rays_per_triangle, left, 0}, options_.cache, &is_known, job_);
      ++searched;
      known += is_known;
      report_.rays += found.rays;
      report_.reached += found.last_found;
      report_.ambiguous += found.ambiguous;
      report_.capped = report_.capped || found.capped;
      if (found.probes > 0) probes = probes > 0 ? std::min(probes, found.probes) : found.probes;
      take(body, found);
    }
    for (std::size_t s = 0; s < shown_.size(); ++s)
      if (!shown_[s].empty()) reduce(s, shown_[s]);
    drop_instances(visible_);
    report_.hidden = report_.triangles_before - report_.triangles_after;
    report_.cached = searched > 0 && known == searched;
    state_confidence(probes);
  }

  // Shapes with decals stay whole, wherever they are used.
  void find_allowed() {
    std::vector<char> keep(scene_.shapes.size(), 0);
    for (const scene::Decal& decal : scene_.decals) {
      const auto& instance = scene_.instances[static_cast<std::size_t>(decal.instance)];
      keep[static_cast<std::size_t>(instance.shape)] = 1;
    }
    allowed_.assign(scene_.instances.size(), 1);
    for (std::size_t i = 0; i < allowed_.size(); ++i) {
      const auto shape = static_cast<std::size_t>(scene_.instances[i].shape);
      if (keep[shape] || !meshes_[i] || (i < options_.may_lose.size() && !options_.may_lose[i]))
        allowed_[i] = 0;
    }
  }

  // What stands in one place more than once is one part.
  std::vector<Body> bodies() const {
    using Key = std::tuple<std::uint32_t, bool, std::array<double, 16>>;
    std::vector<Body> out;
    std::map<std::int32_t, std::size_t> numbers;
    std::vector<std::map<const Mesh*, std::uint32_t>> meshes;
    std::vector<std::map<Key, std::uint32_t>> parts;
    const std::vector<std::int32_t> body_of = bodies_of(scene_);
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      if (!meshes_[i]) continue;
      const scene::Instance& instance = scene_.instances[i];
      const auto node = static_cast<std::size_t>(instance.node);
      const std::size_t b = numbers.try_emplace(body_of[node], numbers.size()).first->second;
      if (b == out.size()) {
        out.emplace_back();
        meshes.emplace_back();
        parts.emplace_back();
      }
      internal::VisibilityModel& model = out[b].model;
      const auto [mesh, is_new] =
          meshes[b].try_emplace(meshes_[i].get(), static_cast<std::uint32_t>(model.meshes.size()));
      if (is_new) {
        model.meshes.push_back(meshes_[i]);
        model.divisible.push_back(std::holds_alternative<MeshShape>(
            scene_.shapes[static_cast<std::size_t>(instance.shape)]));
      }
      internal::VisibilityPart part;
      part.mesh = mesh->second;
      part.world_from_mesh = world_from_node_[node];
      part.transparent =
          instance.see_through ||
          scene_.materials[static_cast<std::size_t>(instance.material)].maps.cutout >= 0;
      part.candidate = allowed_[i] != 0;
      Key key{part.mesh, part.transparent, {}};
      for (int k = 0; k < 16; ++k)
        std::get<2>(key)[static_cast<std::size_t>(k)] = part.world_from_mesh[k / 4][k % 4];
      const auto [known, first] =
          parts[b].try_emplace(key, static_cast<std::uint32_t>(model.parts.size()));
      if (first)
        model.parts.push_back(part);
      else if (part.candidate)
        model.parts[known->second].candidate = true;
      out[b].parts.push_back({i, known->second});
    }
    return out;
  }

  std::vector<char>* shown_of(std::size_t instance) {
    const auto shape = static_cast<std::size_t>(scene_.instances[instance].shape);
    if (!std::holds_alternative<MeshShape>(scene_.shapes[shape])) return nullptr;
    shown_[shape].resize(meshes_[instance]->triangles.size(), 0);
    return &shown_[shape];
  }

  void show_all(const Body& body) {
    for (const auto& [instance, part] : body.parts)
      if (std::vector<char>* const shown = shown_of(instance)) shown->assign(shown->size(), 1);
  }

  // Whatever is visible in one body stays.
  void take(const Body& body, const internal::Visibility& found) {
    for (const auto& [instance, part] : body.parts) {
      visible_[instance] = !allowed_[instance] || found.part_visible[part];
      if (!visible_[instance]) continue;
      std::vector<char>* const shown = shown_of(instance);
      if (shown == nullptr) continue;
      const std::vector<char>& seen = found.shown[body.model.parts[part].mesh];
      for (std::size_t t = 0; t < seen.size(); ++t)
        if (seen[t] || !allowed_[instance]) (*shown)[t] = 1;
    }
  }

  // Keeps some triangles of a mesh, and the vertices that they use.
  void reduce(std::size_t shape, const std::vector<char>& show) {
    if (std::find(show.begin(), show.end(), 0) == show.end()) return;
    scene_.shapes[shape] =
        internal::some_triangles(*std::get<MeshShape>(scene_.shapes[shape]), show);
  }

  void drop_instances(const std::vector<char>& visible) {
    std::vector<MeshShape> meshes;
    for (std::size_t i = 0; i < visible.size(); ++i) {
      if (!visible[i]) continue;
      const auto* mesh = std::get_if<MeshShape>(
          &scene_.shapes[static_cast<std::size_t>(scene_.instances[i].shape)]);
      meshes.push_back(mesh ? *mesh : meshes_[i]);
    }
    meshes_ = std::move(meshes);
    internal::keep_instances(scene_, visible);
    report_.instances_after = scene_.instances.size();
    report_.unique_after = unique_triangles();
    report_.triangles_after = 0;
    for (const MeshShape& mesh : meshes_)
      report_.triangles_after += mesh ? mesh->triangles.size() : 0;
  }

  // No escape in n trials: with 95 % confidence the share is below 3 / n.
  void state_confidence(std::uint64_t probes) {
    if (report_.hidden == 0) return;
    const auto each = static_cast<double>(std::max<std::uint64_t>(1, probes));
    report_.open_share_each = std::min(1.0, 3 / each);
    report_.open_share = std::min(1.0, 3 / (each * static_cast<double>(report_.hidden)));
  }

  scene::Scene& scene_;
  const HiddenOptions& options_;
  const Job& job_;
  HiddenReport report_;
  std::vector<Mat4> world_from_node_;
  std::vector<MeshShape> meshes_;         // one per instance
  std::vector<char> allowed_;             // one per instance: may lose faces
  std::vector<char> visible_;             // one per instance
  std::vector<std::vector<char>> shown_;  // of each mesh, the triangles that stay; else empty
};

}  // namespace

Result<HiddenReport> prune_hidden(scene::Scene& scene, const HiddenOptions& options,
                                  DiagnosticLog& log, const Job& job) {
  const auto found = run_job(
      job, log, [&]() -> Result<HiddenReport> { return Pruner(scene, options, job).run(); });
  if (!found) return failed;
  const HiddenReport& report = *found;
  const std::uint64_t gone = report.triangles_before - report.triangles_after;
  if (gone > 0 || report.capped) {
    const std::string kept =
        report.capped ? fmt::format("; kept {} that these rays leave undecided", report.ambiguous)
                      : "";
    log.report_file(Code("N6304"), {},
                    fmt::format("removed {} of {} triangles ({:.1f} %) as hidden; none of {} rays "
                                "reached them from outside{}",
                                gone, report.triangles_before,
                                100.0 * static_cast<double>(gone) /
                                    static_cast<double>(report.triangles_before),
                                report.rays, kept),
                    "use --keep-hidden, or hidden=\"keep\" in a pxn file, to keep them");
  }
  return report;
}

}  // namespace panwright::compiler
