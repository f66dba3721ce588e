#include "compiler/compile.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "base/clock.h"
#include "base/parallel.h"
#include "base/text.h"
#include "base/work_cache.h"
#include "compiler/internal/decals.h"
#include "compiler/internal/fit.h"
#include "compiler/internal/foil_levels.h"
#include "compiler/internal/jobs.h"
#include "compiler/internal/kept_meshes.h"
#include "compiler/internal/mesh_levels.h"
#include "compiler/internal/round_parts.h"
#include "compiler/internal/size_check.h"
#include "compiler/internal/sound.h"
#include "compiler/internal/storage.h"
#include "geometry/mesh/bytes.h"
#include "geometry/tessellate/mapping.h"
#include "geometry/tessellate/tessellate.h"
#include "materials/report.h"
#include "pan/model.h"
#include "pan/writer.h"

namespace panwright::compiler {

namespace {

using Clock = std::chrono::steady_clock;
using internal::MeshJob;
using internal::place_of;
using internal::Plan;

std::string mesh_name(const MeshJob& job, std::size_t index) {
  return fmt::format("{}{}", geometry::kind_name(*job.shape), index + 1);
}

// The mesh's own error and that of rounding it. Exact shapes have it measured for their vertices as
// rounded about the centre of the bounds; a sphere about its own centre, which need not be the
// same.
//
//   needed  afterwards; else the mesh frees its memory
pan::PackedMesh packed_shape(const geometry::Shape& shape, geometry::Mesh& mesh, std::string name,
                             bool needed) {
  // exact as written: the rounding, which packing measures, is the only error
  const bool authored = std::holds_alternative<geometry::MeshShape>(shape);
  if (authored) mesh.error = 0;
  const auto* sphere = std::get_if<geometry::Sphere>(&shape);
  pan::PackedMesh packed = needed || sphere ? pan::packed(mesh, std::move(name))
                                            : pan::packed(std::move(mesh), std::move(name));
  if (authored) return packed;
  packed.error = mesh.error;
  if (sphere && sphere->whole() && packed.origin != Vec3(0))
    packed.error = geometry::sphere_error(mesh, sphere->radius, packed.origin);
  return packed;
}

// Triangles of a shape with the texture coordinates that its instances use; nothing where it cannot
// be made: reported.
std::optional<geometry::Mesh> mesh_of(const MeshJob& job,
                                      const geometry::TessellationOptions& tessellation,
                                      DiagnosticLog& log) {
  auto mesh = geometry::tessellated(*job.shape, tessellation, {}, log);
  if (!mesh) return {};
  if (job.projected()) geometry::apply_sphere_mapping(*mesh, job.texture_from_shape);
  if (job.boxed) geometry::apply_box_mapping(*mesh);
  return *std::move(mesh);
}

// The results of the jobs. Decals have the indices of the scene's list.
struct Product {
  std::vector<std::optional<pan::PackedMesh>> meshes;
  std::vector<std::optional<pan::DecalContent>> decals;
  std::vector<char> hidden;     // decals that are not visible
  std::vector<double> seconds;  // of each job
};

void place_decals(const scene::Scene& scene, const MeshJob& job, const geometry::Mesh& mesh,
                  Product& out) {
  for (const std::uint32_t decal : job.decals) {
    out.decals[decal] = internal::placed(scene.decals[decal], mesh);
    out.hidden[decal] = out.decals[decal] && !internal::shows(*out.decals[decal], mesh);
  }
}

void make_job(const scene::Scene& scene, const Plan& plan, std::size_t index,
              const Options& options, Product& out, DiagnosticLog& log) {
  const MeshJob& job = plan.jobs[index];
  const geometry::TessellationOptions tessellation = internal::tessellation_of(job, options);
  const WorkCache* cache = internal::worth_keeping(job, tessellation) ? options.cache : nullptr;
  const auto* authored = std::get_if<geometry::MeshShape>(job.shape);
  if (authored && !job.projected() && !job.boxed) {  // nothing to change, so nothing to copy
    if (!geometry::within_limits(**authored, tessellation, {}, log)) return;
    out.meshes[index] = pan::packed(**authored, mesh_name(job, index));
    place_decals(scene, job, **authored, out);
  } else if (job.decals.empty()) {
    out.meshes[index] = remember<pan::PackedMesh>(
        cache, Work::meshes, [&] { return internal::mesh_key(job, tessellation); },
        [&] {
          auto mesh = mesh_of(job, tessellation, log);
          return mesh ? std::optional(packed_shape(*job.shape, *mesh, {}, false)) : std::nullopt;
        },
        internal::write_packed, internal::read_packed);
    if (!out.meshes[index]) return;
    out.meshes[index]->name = mesh_name(job, index);
  } else {
    auto mesh = remember<geometry::Mesh>(
        cache, Work::meshes,
        [&] { return internal::mesh_key(job, tessellation, internal::Kept::mesh); },
        [&] { return mesh_of(job, tessellation, log); }, geometry::write, geometry::read_mesh);
    if (!mesh) return;
    out.meshes[index] = packed_shape(*job.shape, *mesh, mesh_name(job, index), true);
    place_decals(scene, job, *mesh, out);
  }
  pan::PackedMesh& mesh = *out.meshes[index];
  if (!internal::is_sound(mesh, log)) {
    out.meshes[index].reset();
    for (const std::uint32_t decal : job.decals) out.decals[decal].reset();
    return;
  }
  // a mesh without texture coordinates takes the corner of its texture
  if (job.textured && mesh.texcoords.empty()) mesh.texcoords.resize(2 * mesh.vertex_count());
}

// Reports the problems of a shape at its location in the source.
void pass_on(const DiagnosticLog& from, const scene::Source& source, DiagnosticLog& log) {
  for (const Diagnostic& entry : from.entries())
    internal::report_at(source, entry.code, entry.message, entry.hint, log);
}

// Each decal once, however many shapes it is on.
void report_hidden(const scene::Scene& scene, const Product& product, DiagnosticLog& log) {
  std::set<std::string> known;
  for (std::size_t i = 0; i < scene.decals.size(); ++i) {
    if (!product.hidden[i]) continue;
    const std::string place = place_of(scene.decals[i].source);
    if (known.insert(place).second)
      internal::report_at(scene.decals[i].source, Code("W2020"),
                          "the decal is not visible: no surface within its box faces it",
                          "give a normal that points away from the surface, or omit it", log);
  }
}

// Triangles of one shape at most: they take 2 GB while they are made. Those of files are there
// already, and limited by all of the model alone.
constexpr double kMostOfShape = 1 << 25;

// Makes the meshes, all of them together within the limit. What cannot be made is reported and
// left empty.
Product make_all(const scene::Scene& scene, const Plan& plan, const Options& options,
                 DiagnosticLog& log, const Job& job) {
  const std::vector<MeshJob>& jobs = plan.jobs;
  Product out;
  out.meshes.resize(jobs.size());
  out.seconds.resize(jobs.size());
  out.decals.resize(scene.decals.size());
  out.hidden.resize(scene.decals.size());
  std::vector<DiagnosticLog> logs(jobs.size());
  std::vector<char> allowed(jobs.size());
  double planned = 0;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const double more =
        geometry::planned_triangles(*jobs[i].shape, internal::tessellation_of(jobs[i], options));
    const auto limit = static_cast<double>(options.max_triangles);
    // one that exceeds the limit by itself has its own message, before anything is allocated
    const bool alone = more > limit;
    const bool large = !alone && more > kMostOfShape &&
                       !std::holds_alternative<geometry::MeshShape>(*jobs[i].shape);
    allowed[i] = alone || (!large && planned + more <= limit);
    if (allowed[i])
      planned += alone ? 0 : more;
    else if (large)
      logs[i].report(Code("E2003"), {},
                     fmt::format("this shape needs {:.0f} triangles, expected at most {:.0f}", more,
                                 kMostOfShape),
                     "give fewer segments and rings, or a larger tolerance");
    else
      logs[i].report(Code("E2003"), {},
                     fmt::format("{:.0f} triangles here and {:.0f} in the shapes before exceed the "
                                 "limit of {} for a model (--max-triangles)",
                                 more, planned, options.max_triangles));
  }
  Phase phase(job, "tessellating", jobs.size());
  const auto make = [&](std::size_t i) {
    const auto start = Clock::now();
    if (allowed[i]) make_job(scene, plan, i, options, out, logs[i]);
    out.seconds[i] = seconds_since(start);
    phase.advance();
  };
  parallel_for(jobs.size(), make, job);
  for (std::size_t i = 0; i < jobs.size(); ++i) pass_on(logs[i], jobs[i].user->source, log);
  report_hidden(scene, out, log);
  return out;
}

// Warns of BRDFs that reflect more light than they receive.
void certify(const scene::Scene& scene, DiagnosticLog& log, const Job& job) {
  // error bound of quadrature and fits
  constexpr double kTolerance = 1e-3;
  std::vector<std::optional<materials::Gain>> gains(scene.materials.size());
  const auto certify_one = [&](std::size_t i) {
    const materials::Material& material = scene.materials[i];
    if (materials::may_gain(material))
      gains[i] = materials::gain_above(material, kTolerance + material.fits.error);
  };
  parallel_for(gains.size(), certify_one, job);
  for (std::size_t i = 0; i < gains.size(); ++i) {
    if (!gains[i]) continue;
    const materials::Material& material = scene.materials[i];
    const materials::Gain& gain = *gains[i];
    log.report(Code("W1408"), {},
               fmt::format("the material {} reflects {:.4f} times the light that arrives at {:.1f} "
                           "degrees from its normal, expected at most 1",
                           in_quotes(material.name), gain.albedo, det::acos(gain.mu) / kDegree),
               "`panwright material` shows its albedo; use darker colours or another BRDF to "
               "conserve energy");
  }
}

std::string describe(const Options& options) {
  return fmt::format("max_error={} max_triangles={} strip_sources={}{}{}",
                     options.max_error ? format_double(*options.max_error) : "need",
                     options.max_triangles, options.strip_sources ? 1 : 0,
                     options.mesh_levels ? " mesh_levels=1" : "",
                     (options.storage.streams() ? " storage=" + pan::storage_name(options.storage)
                                                : std::string()) +
                         options.origin);
}

// Names come from files and folders, which may hold any bytes; a pan file holds UTF-8.
std::string text(const std::string& name) { return to_utf8(name, Encoding::utf8); }

void copy_tables(const scene::Scene& scene, pan::Contents& out) {
  for (const scene::Input& input : scene.inputs)
    out.inputs.push_back({text(input.path), input.hash, input.bytes});
  for (const scene::Node& node : scene.nodes) {
    const scene::Transform& t = node.parent_from_node;
    out.nodes.push_back({text(node.name), node.parent, t.translation, t.rotation, t.scale});
    if (!node.marks.label.empty())
      out.labels.push_back(
          {text(node.marks.label), static_cast<std::uint32_t>(out.nodes.size() - 1)});
  }
  out.materials = scene.materials;
  for (materials::Material& material : out.materials) material.name = text(material.name);
  for (const scene::Texture& texture : scene.textures)
    out.textures.push_back(
        {text(texture.name), texture.width, texture.height, texture.linear, texture.rgba});
  for (const scene::Frame& frame : scene.frames)
    out.frames.push_back(
        {text(frame.name), static_cast<std::uint32_t>(frame.node), frame.origin, frame.rotation});
  for (const scene::Keypoint& point : scene.keypoints)
    out.keypoints.push_back(
        {text(point.name), static_cast<std::uint32_t>(point.node), point.position});
  for (const scene::Lamp& lamp : scene.lamps) {
    const Vec2 pulse = lamp.pulse.value_or(Vec2(0));
    out.lamps.push_back(
        {text(lamp.name),
         static_cast<std::uint32_t>(lamp.node),
         static_cast<std::uint32_t>(lamp.kind),
         (lamp.on ? 0 : pan::layout::kLampOff) | (lamp.pulse ? pan::layout::kLampPulsed : 0),
         lamp.position,
         lamp.axis,
         lamp.intensity,
         lamp.half_angle,
         lamp.exponent,
         lamp.radius,
         {pulse.x, pulse.y}});
  }
  for (const scene::Setting& setting : scene.settings)
    out.scene.push_back({text(setting.name), text(setting.value)});
}

// By node. A name that another joint has, or none, becomes one with a number.
void copy_joints(const scene::Scene& scene, pan::Contents& out) {
  std::vector<std::size_t> order(scene.joints.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return scene.joints[i].node; });
  std::vector<std::int32_t> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<std::int32_t>(k);
  const std::vector<std::string> names = scene::joint_names(scene);
  for (const std::size_t i : order) {
    const scene::Joint& joint = scene.joints[i];
    pan::JointContent content;
    content.name = text(names[i]);
    content.node = static_cast<std::uint32_t>(joint.node);
    content.joint = scene::kinematic(joint);
    if (joint.mimic != scene::kNone)
      content.joint.mimic = place[static_cast<std::size_t>(joint.mimic)];
    if (joint.gimbal != scene::kNone)
      content.gimbal = place[static_cast<std::size_t>(joint.gimbal)];
    content.value = scene::initial_values(joint);
    content.pointing = joint.pointing;
    content.points_at_sun = joint.point_at == scene::PointAt::sun;
    out.joints.push_back(std::move(content));
  }
}

// Reports where texture coordinates were generated.
void report_boxed(const scene::Scene& scene, const Plan& plan, DiagnosticLog& log) {
  std::size_t count = 0;
  const MeshJob* first = nullptr;
  for (const MeshJob& job : plan.jobs) {
    if (!job.boxed) continue;
    ++count;
    if (first == nullptr) first = &job;
  }
  if (first == nullptr) return;
  const auto material = static_cast<std::size_t>(first->user->material);
  log.report(
      Code("N2021"), {},
      fmt::format(
          "{} without texture coordinates {} them from {} bounds; the first has the material {}",
          count == 1 ? "1 mesh" : fmt::format("{} meshes", count), count == 1 ? "gets" : "get",
          count == 1 ? "its" : "their", in_quotes(scene.materials[material].name)));
}

// The budget as the file stores it: the authored terms and the smallest derived tolerance.
pan::layout::Budget budget_record(const scene::Budget& budget, const Options& options,
                                  double smallest) {
  pan::layout::Budget record{};
  record.tolerance = options.max_error ? *options.max_error : budget.tolerance.value_or(0);
  record.nearest = budget.nearest.value_or(0);
  record.ifov = budget.ifov.value_or(0);
  record.pixels = budget.pixels.value_or(0);
  record.flux = budget.flux.value_or(0);
  record.centroid = budget.centroid.value_or(0);
  record.smallest = smallest;
  return record;
}

pan::layout::MeshTolerance mesh_tolerance(const MeshJob& job) {
  const bool counts = job.reason == pan::layout::ToleranceReason::explicit_counts;
  return {counts ? 0 : job.max_error, static_cast<std::uint32_t>(job.reason), 0};
}

constexpr std::uint32_t kLeftOut = 0xffffffffu;

// Whether the back of an instance is a material of its own that is ever seen.
bool shows_back(const scene::Scene& scene, const scene::Instance& instance,
                const pan::PackedMesh& mesh) {
  return instance.back != scene::kNone &&
         (!mesh.closed ||
          scene.materials[static_cast<std::size_t>(instance.material)].maps.cutout >= 0);
}

// Leaves out the materials of backs that are hidden.
void drop_unseen_backs(const scene::Scene& scene, pan::Contents& out) {
  std::vector<char> unseen(out.materials.size());
  for (const scene::Instance& instance : scene.instances)
    if (instance.back != scene::kNone) unseen[static_cast<std::size_t>(instance.back)] = 1;
  for (const scene::Instance& instance : scene.instances)
    unseen[static_cast<std::size_t>(instance.material)] = 0;
  for (const pan::InstanceContent& instance : out.instances)
    if (instance.back >= 0) unseen[static_cast<std::size_t>(instance.back)] = 0;
  std::vector<std::uint32_t> place(unseen.size());
  std::vector<materials::Material> kept;
  for (std::size_t i = 0; i < unseen.size(); ++i) {
    place[i] = static_cast<std::uint32_t>(kept.size());
    if (!unseen[i]) kept.push_back(std::move(out.materials[i]));
  }
  out.materials = std::move(kept);
  for (pan::InstanceContent& instance : out.instances) {
    instance.material = place[instance.material];
    if (instance.back >= 0)
      instance.back = static_cast<std::int32_t>(place[static_cast<std::size_t>(instance.back)]);
  }
}

// Instances with their sources and decals. Those without a mesh are left out: kLeftOut in what is
// returned.
std::vector<std::uint32_t> place_instances(const scene::Scene& scene, const Plan& plan,
                                           const Options& options,
                                           const std::vector<std::uint32_t>& mesh_of_job,
                                           Product& product, pan::Contents& out) {
  std::vector<std::uint32_t> place(scene.instances.size(), kLeftOut);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Instance& instance = scene.instances[i];
    const std::uint32_t mesh = mesh_of_job[plan.job_of[i]];
    if (mesh == kLeftOut) continue;  // reported
    place[i] = static_cast<std::uint32_t>(out.instances.size());
    out.instances.push_back({static_cast<std::uint32_t>(instance.node), mesh,
                             static_cast<std::uint32_t>(instance.material), instance.texture,
                             shows_back(scene, instance, out.meshes[mesh]) ? instance.back : -1});
    if (!options.strip_sources)
      out.sources.push_back(
          {text(instance.source.file), instance.source.line, instance.source.column});
  }
  for (std::size_t i = 0; i < scene.decals.size(); ++i) {
    if (!product.decals[i]) continue;
    pan::DecalContent decal = std::move(*product.decals[i]);
    decal.name = text(decal.name);
    decal.instance = place[static_cast<std::size_t>(scene.decals[i].instance)];
    out.decals.push_back(std::move(decal));
  }
  return place;
}

// What sheets have become, beside each mesh that was made of one.
void describe_sheets(const scene::Scene& scene, const Plan& plan,
                     const std::vector<std::uint32_t>& mesh_of_job, pan::Contents& out) {
  std::map<const geometry::Shape*, const scene::Foil*> foils;
  for (const scene::Foil& foil : scene.foils)
    foils[&scene.shapes[static_cast<std::size_t>(foil.shape)]] = &foil;
  for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
    const auto found = foils.find(plan.jobs[i].shape);
    if (found == foils.end() || mesh_of_job[i] == kLeftOut) continue;
    const mli::Recipe& recipe = found->second->recipe;
    const mli::Statistics& s = found->second->statistics;
    pan::layout::Sheet record{};
    record.width = recipe.width;
    record.height = recipe.height;
    record.lowest = s.lowest;
    record.highest = s.highest;
    record.height_mean = s.height_mean;
    record.height_rms = s.height_rms;
    const mli::Covariance *v = &s.slope_covariance, *f = &s.facet_slope_covariance;
    const double rest[] = {s.slope_mean.x,
                           s.slope_mean.y,
                           v->xx,
                           v->xy,
                           v->yy,
                           f->xx,
                           f->xy,
                           f->yy,
                           s.slope_rms,
                           s.correlation_length.x,
                           s.correlation_length.y};
    std::copy_n(rest, 2, record.slope_mean);
    std::copy_n(rest + 2, 3, record.slope_covariance);
    std::copy_n(rest + 5, 3, record.facet_slope_covariance);
    record.slope_rms = rest[8];
    std::copy_n(rest + 9, 2, record.correlation_length);
    record.mesh = mesh_of_job[i];
    record.seed = recipe.seed;
    record.columns = recipe.xgrid;
    record.rows = static_cast<std::uint32_t>(recipe.ygrid());
    record.form = found->second->wrapped
                      ? static_cast<std::uint32_t>(std::variant_size_v<mli::Form>)
                      : static_cast<std::uint32_t>(found->second->form.index());
    out.sheets.push_back(record);
  }
}

// Jobs of meshes that were made to a tolerance are made to it.
void note_tolerances(const scene::Scene& scene, const internal::Fitted& fitted, Plan& plan) {
  for (std::size_t i = 0; i < scene.instances.size() && !fitted.made_to.empty(); ++i) {
    const auto& made_to = fitted.made_to[static_cast<std::size_t>(scene.instances[i].shape)];
    if (!made_to) continue;
    MeshJob& job = plan.jobs[plan.job_of[i]];
    job.max_error = made_to->metres;
    job.reason = made_to->reason;
  }
}

// Rows of meshes that instances show.
std::vector<PartReport> parts_of(const scene::Scene& scene, const internal::Fitted& fitted,
                                 const Plan& plan, const Product& product,
                                 const std::vector<std::uint32_t>& place,
                                 const pan::Contents& out) {
  std::vector<PartReport> parts(out.meshes.size());
  const std::vector<Mat4> world = scene::world_from_nodes(scene);
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] == kLeftOut) continue;
    const std::uint32_t index = out.instances[place[i]].mesh;
    const pan::PackedMesh& mesh = out.meshes[index];
    PartReport& part = parts[index];
    if (part.instances++ == 0) {
      part.mesh = mesh.name;
      part.name = internal::name_of(scene, i);
      part.bytes = 4 * (mesh.positions.size() + mesh.normals.size() + mesh.texcoords.size() +
                        mesh.colors.size() + mesh.indices.size());
      part.seconds = product.seconds[plan.job_of[i]];
    }
    part.triangles += mesh.triangle_count();
    const double stretch =
        stretch_of(world[static_cast<std::size_t>(scene.instances[i].node)]).largest;
    part.achieved = std::max(part.achieved, mesh.error * stretch);
    const MeshJob& job = plan.jobs[plan.job_of[i]];
    if (job.reason != pan::layout::ToleranceReason::explicit_counts)
      part.asked = std::max(part.asked, job.max_error * stretch);
    part.reason = pan::reason_name(job.reason);
    if (scene.budget.nearest) {
      const double nearest = *fitted.allotment.of(scene.budget, i).nearest;
      part.nearest = part.nearest > 0 ? std::min(part.nearest, nearest) : nearest;
    }
  }
  std::erase_if(parts, [](const PartReport& part) { return part.instances == 0; });
  std::stable_sort(parts.begin(), parts.end(), [](const PartReport& a, const PartReport& b) {
    return a.triangles > b.triangles;
  });
  return parts;
}

// What the file holds: with views of the fitted scene's textures.
pan::Contents contents_of(internal::Fitted& fitted, const Options& options, Report& report,
                          DiagnosticLog& log, const Job& job) {
  const auto start = Clock::now();
  const scene::Scene& scene = fitted.scene();
  report.fit = std::move(fitted.report);
  Plan plan = internal::plan_of(scene, scene::world_from_nodes(scene), options, fitted.allotment);
  note_tolerances(scene, fitted, plan);
  report_boxed(scene, plan, log);
  Product product = make_all(scene, plan, options, log, job);

  pan::Contents out;
  out.version = "panwright " PANWRIGHT_VERSION;
  out.options = describe(options);
  std::vector<std::uint32_t> mesh_of_job(plan.jobs.size(), kLeftOut);
  // note: a list that grows copies its meshes
  std::size_t meshes = plan.jobs.size();
  for (const scene::Foil& foil : scene.foils) meshes += foil.levels.size();
  out.meshes.reserve(meshes);
  for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
    if (!product.meshes[i]) continue;
    mesh_of_job[i] = static_cast<std::uint32_t>(out.meshes.size());
    out.meshes.push_back(std::move(*product.meshes[i]));
    if (plan.asked) out.mesh_tolerances.push_back(mesh_tolerance(plan.jobs[i]));
  }
  if (plan.asked) out.budget = budget_record(scene.budget, options, plan.smallest);
  copy_tables(scene, out);
  copy_joints(scene, out);
  describe_sheets(scene, plan, mesh_of_job, out);
  certify(scene, log, job);
  const auto place = place_instances(scene, plan, options, mesh_of_job, product, out);
  drop_unseen_backs(scene, out);
  internal::add_foil_levels(scene, plan, mesh_of_job, place, out, log, job);
  if (options.storage.streams()) {
    std::vector<double> tolerances;
    for (std::size_t i = 0; plan.asked && i < place.size(); ++i)
      if (place[i] != kLeftOut) tolerances.push_back(plan.jobs[plan.job_of[i]].max_error);
    internal::snap_meshes(scene, options.storage, tolerances, out, report.storage, job);
  }
  if (options.mesh_levels) internal::add_mesh_levels(scene, options.cache, out, job);
  report.parts = parts_of(scene, fitted, plan, product, place, out);
  report.flux_shapes = internal::flux_of_shapes(scene, plan, place, out);
  internal::note_coarse(scene, plan, place, out, log);
  if (options.storage.streams()) internal::encode_meshes(options.storage, out, report.storage, job);
  if (options.check_size) internal::check_size(scene, out, log);
  for (const pan::InstanceContent& instance : out.instances)
    report.triangles += out.meshes[instance.mesh].triangle_count();
  for (const pan::PackedMesh& mesh : out.meshes) report.unique_triangles += mesh.triangle_count();
  std::vector<char> coarse(out.meshes.size());
  for (const pan::layout::Level& level : out.levels) coarse[level.mesh] = 1;
  for (const pan::InstanceContent& instance : out.instances) coarse[instance.mesh] = 0;
  for (std::size_t i = 0; i < out.meshes.size(); ++i)
    if (!coarse[i]) report.worst_error = std::max(report.worst_error, out.meshes[i].error);
  report.unique_meshes = out.meshes.size();
  report.instances = out.instances.size();
  report.levels = out.levels.size();
  report.seconds_tessellate = report.fit.seconds + seconds_since(start);
  return out;
}

// note: what is no mesh is compressed as well, but where nothing is compressed
pan::WriteOptions write_options(const Options& options) {
  return {.compress = options.storage.kind != pan::StorageForm::Kind::plain};
}

}  // namespace

Result<Report> compile(const scene::Scene& scene, const Options& options,
                       const std::filesystem::path& output, DiagnosticLog& log, const Job& job) {
  return run_job(job, log, [&]() -> Result<Report> {
    if (!internal::is_sound(scene, log)) return failed;
    Report report;
    internal::Fitted fitted =
        internal::fitted_to_budget(scene, options.max_error, options.cache, log, job);
    auto contents = contents_of(fitted, options, report, log, job);
    const auto start = Clock::now();
    const auto written = pan::write(std::move(contents), output, log, write_options(options), job);
    if (!written) return failed;
    report.bytes = written->bytes;
    report.seconds_sync = written->seconds_sync;
    report.seconds_write = seconds_since(start) - written->seconds_sync;
    return report;
  });
}

Result<std::vector<std::byte>> compiled(const scene::Scene& scene, const Options& options,
                                        DiagnosticLog& log, const Job& job) {
  return run_job(job, log, [&]() -> Result<std::vector<std::byte>> {
    if (!internal::is_sound(scene, log)) return failed;
    Report report;
    internal::Fitted fitted =
        internal::fitted_to_budget(scene, options.max_error, options.cache, log, job);
    auto contents = contents_of(fitted, options, report, log, job);
    job.poll();
    return pan::write_to_memory(std::move(contents), write_options(options));
  });
}

}  // namespace panwright::compiler
