#include "compiler/hidden.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "base/parallel.h"
#include "compiler/internal/jobs.h"
#include "compiler/internal/visibility.h"
#include "geometry/tessellate/tessellate.h"

namespace panwright::compiler {

namespace {

using geometry::Mesh;
using geometry::MeshShape;

constexpr std::uint32_t kUnused = 0xffffffffu;

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
    report_.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
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
    const internal::Visibility visibility = internal::visibility_of(
        world_triangles(),
        {options_.rays_from_outside, options_.rays_per_triangle, options_.max_probes}, job_);
    report_.rays = visibility.rays;
    report_.reached = visibility.last_found;
    report_.ambiguous = visibility.ambiguous;
    decide(visibility);
    state_confidence(visibility);
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

  internal::WorldTriangles world_triangles() {
    internal::WorldTriangles out;
    first_.clear();
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      first_.push_back(out.triangles.size());
      if (!meshes_[i]) continue;
      const scene::Instance& instance = scene_.instances[i];
      const Mat4& world_from_mesh = world_from_node_[static_cast<std::size_t>(instance.node)];
      const auto& material = scene_.materials[static_cast<std::size_t>(instance.material)];
      const auto base = static_cast<std::uint32_t>(out.positions.size());
      for (const Vec3& p : meshes_[i]->positions)
        out.positions.push_back(Vec3(world_from_mesh * Vec4(p, 1)));
      for (const geometry::Triangle& t : meshes_[i]->triangles)
        out.triangles.push_back({base + t[0], base + t[1], base + t[2]});
      out.transparent.resize(out.triangles.size(), material.maps.cutout >= 0 ? 1 : 0);
      out.candidate.resize(out.triangles.size(), allowed_[i]);
    }
    first_.push_back(out.triangles.size());
    return out;
  }

  bool is_visible(const internal::Visibility& visibility, std::size_t instance) const {
    if (!allowed_[instance]) return true;
    const auto begin = visibility.visible.begin() + static_cast<std::ptrdiff_t>(first_[instance]);
    const auto end = visibility.visible.begin() + static_cast<std::ptrdiff_t>(first_[instance + 1]);
    return std::find(begin, end, 1) != end;
  }

  void decide(const internal::Visibility& visibility) {
    std::vector<char> visible(scene_.instances.size());
    // of each shape, the triangles that are visible in some instance
    std::vector<std::vector<char>> shown(scene_.shapes.size());
    for (std::size_t i = 0; i < visible.size(); ++i) {
      visible[i] = is_visible(visibility, i);
      for (std::size_t t = first_[i]; t < first_[i + 1]; ++t)
        report_.hidden += allowed_[i] && !visibility.visible[t];
      if (!visible[i]) continue;
      const auto shape = static_cast<std::size_t>(scene_.instances[i].shape);
      if (!std::holds_alternative<MeshShape>(scene_.shapes[shape])) continue;
      std::vector<char>& show = shown[shape];
      show.resize(meshes_[i]->triangles.size(), 0);
      for (std::size_t t = 0; t < show.size(); ++t)
        if (!allowed_[i] || visibility.visible[first_[i] + t]) show[t] = 1;
    }
    for (std::size_t s = 0; s < shown.size(); ++s)
      if (!shown[s].empty()) reduce(s, shown[s]);
    drop_instances(visible);
  }

  // Keeps some triangles of a mesh, and the vertices that they use.
  void reduce(std::size_t shape, const std::vector<char>& show) {
    if (std::find(show.begin(), show.end(), 0) == show.end()) return;
    const Mesh& mesh = *std::get<MeshShape>(scene_.shapes[shape]);
    Mesh out;
    out.error = mesh.error;
    out.closed = mesh.closed;
    std::vector<std::uint32_t> kept(mesh.positions.size(), kUnused);
    for (std::size_t t = 0; t < show.size(); ++t)
      if (show[t])
        for (const std::uint32_t v : mesh.triangles[t]) kept[v] = 0;
    std::uint32_t count = 0;
    const auto take = [](auto& to, const auto& from, std::size_t v) {
      if (!from.empty()) to.push_back(from[v]);
    };
    for (std::size_t v = 0; v < kept.size(); ++v) {
      if (kept[v] == kUnused) continue;
      kept[v] = count++;
      take(out.positions, mesh.positions, v);
      take(out.normals, mesh.normals, v);
      take(out.texcoords, mesh.texcoords, v);
      take(out.colors, mesh.colors, v);
    }
    for (std::size_t t = 0; t < show.size(); ++t) {
      const geometry::Triangle& from = mesh.triangles[t];
      if (show[t]) out.triangles.push_back({kept[from[0]], kept[from[1]], kept[from[2]]});
    }
    scene_.shapes[shape] = std::make_shared<const Mesh>(std::move(out));
  }

  void drop_instances(const std::vector<char>& visible) {
    std::vector<std::int32_t> moved(visible.size(), scene::kNone);
    std::vector<scene::Instance> kept;
    std::vector<MeshShape> meshes;
    for (std::size_t i = 0; i < visible.size(); ++i) {
      if (!visible[i]) continue;
      moved[i] = static_cast<std::int32_t>(kept.size());
      const auto* mesh = std::get_if<MeshShape>(
          &scene_.shapes[static_cast<std::size_t>(scene_.instances[i].shape)]);
      meshes.push_back(mesh ? *mesh : meshes_[i]);
      kept.push_back(std::move(scene_.instances[i]));
    }
    scene_.instances = std::move(kept);
    meshes_ = std::move(meshes);
    for (scene::Decal& decal : scene_.decals)
      decal.instance = moved[static_cast<std::size_t>(decal.instance)];
    drop_shapes();
    report_.instances_after = scene_.instances.size();
    report_.unique_after = unique_triangles();
    report_.triangles_after = 0;
    for (const MeshShape& mesh : meshes_)
      report_.triangles_after += mesh ? mesh->triangles.size() : 0;
  }

  void drop_shapes() {
    std::vector<std::int32_t> moved(scene_.shapes.size(), scene::kNone);
    for (const scene::Instance& instance : scene_.instances)
      moved[static_cast<std::size_t>(instance.shape)] = 0;
    std::vector<geometry::Shape> kept;
    for (std::size_t s = 0; s < moved.size(); ++s) {
      if (moved[s] == scene::kNone) continue;
      moved[s] = static_cast<std::int32_t>(kept.size());
      kept.push_back(std::move(scene_.shapes[s]));
    }
    scene_.shapes = std::move(kept);
    for (scene::Instance& instance : scene_.instances)
      instance.shape = moved[static_cast<std::size_t>(instance.shape)];
  }

  // No hit in n trials: with 95 % confidence the share is below 3 / n.
  void state_confidence(const internal::Visibility& visibility) {
    if (report_.hidden == 0) return;
    const auto probes = static_cast<double>(std::max<std::uint64_t>(1, visibility.probes));
    report_.open_share_each = std::min(1.0, 3 / probes);
    report_.open_share = std::min(1.0, 3 / (probes * static_cast<double>(report_.hidden)));
  }

  scene::Scene& scene_;
  const HiddenOptions& options_;
  const Job& job_;
  HiddenReport report_;
  std::vector<Mat4> world_from_node_;
  std::vector<MeshShape> meshes_;   // one per instance
  std::vector<char> allowed_;       // one per instance: may lose faces
  std::vector<std::size_t> first_;  // of each instance, in the world's triangles; and their end
};

}  // namespace

Result<HiddenReport> prune_hidden(scene::Scene& scene, const HiddenOptions& options,
                                  DiagnosticLog& log, const Job& job) {
  const auto found = run_job(
      job, log, [&]() -> Result<HiddenReport> { return Pruner(scene, options, job).run(); });
  if (!found) return failed;
  const HiddenReport& report = *found;
  const std::uint64_t gone = report.triangles_before - report.triangles_after;
  if (gone > 0)
    log.report_file(Code::N6304, {},
                    fmt::format("removed {} of {} triangles ({:.1f} %) as hidden; none of {} rays "
                                "from outside hit them",
                                gone, report.triangles_before,
                                100.0 * static_cast<double>(gone) /
                                    static_cast<double>(report.triangles_before),
                                report.rays),
                    "use --keep-hidden, or hidden=\"keep\" in a pxn file, to keep them");
  return report;
}

}  // namespace panwright::compiler
