#include "compiler/compile.h"

#include <fmt/format.h>

#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <tuple>

#include "base/hash.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/text.h"
#include "geometry/mapping.h"
#include "geometry/tessellate.h"
#include "pan/writer.h"

namespace panwright::compiler {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// One mesh that the file will hold: a shape, with texture coordinates if something needs them.
struct Job {
  const geometry::Shape* shape = nullptr;
  bool textured = false;
  scene::Mapping mapping = scene::Mapping::texcoords;
  Mat4 texture_from_shape{1};
  const scene::Instance* user = nullptr;  // the first one
};

using JobKey = std::tuple<Hash128, bool, bool, std::array<double, 16>>;

JobKey key_of(const Job& job, const Hash128& shape) {
  const bool projected = job.textured && job.mapping == scene::Mapping::sphere;
  std::array<double, 16> matrix{};
  if (projected)
    for (int i = 0; i < 16; ++i)
      matrix[static_cast<std::size_t>(i)] = job.texture_from_shape[i / 4][i % 4];
  return {shape, job.textured, projected, matrix};
}

// Finds out which meshes a scene needs, and which of them each instance shows.
std::vector<Job> collect_jobs(const scene::Scene& scene, std::vector<std::uint32_t>& mesh_of) {
  std::vector<Hash128> hashes(scene.shapes.size());
  parallel_for(hashes.size(), [&](std::size_t i) { hashes[i] = geometry::hash_of(scene.shapes[i]); });
  std::vector<Job> jobs;
  std::map<JobKey, std::uint32_t> known;
  for (const scene::Instance& instance : scene.instances) {
    const auto shape = static_cast<std::size_t>(instance.shape);
    const Job job{&scene.shapes[shape], instance.texture != scene::kNone, instance.mapping,
                  instance.texture_from_shape, &instance};
    const auto [place, added] =
        known.emplace(key_of(job, hashes[shape]), static_cast<std::uint32_t>(jobs.size()));
    if (added) jobs.push_back(job);
    mesh_of.push_back(place->second);
  }
  return jobs;
}

std::string mesh_name(const Job& job, std::size_t index) {
  return fmt::format("{}{}", geometry::kind_name(*job.shape), index + 1);
}

// The mesh's own error and that of rounding it, measured together where the shape is known.
pan::PackedMesh packed_shape(const geometry::Shape& shape, geometry::Mesh& mesh, std::string name) {
  if (const auto* sphere = std::get_if<geometry::Sphere>(&shape)) {
    pan::PackedMesh packed = pan::packed(mesh, std::move(name));
    packed.error = geometry::sphere_error(mesh, sphere->radius, packed.origin);
    return packed;
  }
  if (std::holds_alternative<geometry::MeshShape>(shape))
    mesh.error = 0;  // exact as written: packing measures the rounding, which is all there is
  return pan::packed(mesh, std::move(name));
}

std::optional<pan::PackedMesh> packed_job(const Job& job, const Options& options, std::string name,
                                          DiagnosticLog& log) {
  const bool projected = job.textured && job.mapping == scene::Mapping::sphere;
  geometry::TessellationOptions tessellation;
  tessellation.max_error = options.max_error;
  tessellation.max_triangles = options.max_triangles;
  tessellation.texcoords = job.textured && !projected;
  const auto* authored = std::get_if<geometry::MeshShape>(job.shape);
  if (authored && !projected) {  // nothing to change, so nothing to copy
    if (!geometry::within_limits(**authored, tessellation, {}, log)) return std::nullopt;
    return pan::packed(**authored, std::move(name));
  }
  auto mesh = geometry::tessellated(*job.shape, tessellation, {}, log);
  if (!mesh) return std::nullopt;
  if (projected) geometry::apply_sphere_mapping(*mesh, job.texture_from_shape);
  return packed_shape(*job.shape, *mesh, std::move(name));
}

// Reports what went wrong with a shape at the place where the shape was written.
void pass_on(const DiagnosticLog& from, const scene::Source& source, DiagnosticLog& log) {
  for (const Diagnostic& entry : from.entries()) {
    const std::string place =
        source.line == 0 ? source.file
                         : fmt::format("{}:{}:{}", source.file, source.line, source.column);
    log.report(entry.code, {}, fmt::format("{}: {}", place, entry.message), entry.hint);
  }
}

// Makes the meshes, all of them together within the limit. What cannot be made is reported and
// left empty.
std::vector<std::optional<pan::PackedMesh>> pack_all(const std::vector<Job>& jobs,
                                                     const Options& options, DiagnosticLog& log) {
  std::vector<std::optional<pan::PackedMesh>> meshes(jobs.size());
  std::vector<DiagnosticLog> logs(jobs.size());
  std::vector<char> allowed(jobs.size());
  double planned = 0;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    geometry::TessellationOptions tessellation;
    tessellation.max_error = options.max_error;
    const double more = geometry::planned_triangles(*jobs[i].shape, tessellation);
    allowed[i] = planned + more <= static_cast<double>(options.max_triangles);
    if (allowed[i])
      planned += more;
    else
      logs[i].report(Code::E2003, {},
                     fmt::format("{:.0f} triangles here and {:.0f} before them are more than the "
                                 "limit of {} for a model (--max-triangles)",
                                 more, planned, options.max_triangles));
  }
  Progress progress("tessellating", jobs.size());
  std::mutex mutex;
  parallel_for(jobs.size(), [&](std::size_t i) {
    if (allowed[i]) meshes[i] = packed_job(jobs[i], options, mesh_name(jobs[i], i), logs[i]);
    const std::lock_guard lock(mutex);
    progress.advance();
  });
  for (std::size_t i = 0; i < jobs.size(); ++i) pass_on(logs[i], jobs[i].user->source, log);
  return meshes;
}

std::string describe(const Options& options) {
  return fmt::format("max_error={} max_triangles={} strip_sources={}",
                     format_double(options.max_error), options.max_triangles,
                     options.strip_sources ? 1 : 0);
}

// Names come from files and folders, which may hold any bytes; a pan file holds UTF-8.
std::string text(const std::string& name) { return to_utf8(name, Encoding::utf8); }

void copy_tables(const scene::Scene& scene, pan::Contents& out) {
  for (const scene::Input& input : scene.inputs)
    out.inputs.push_back({text(input.path), input.hash, input.bytes});
  for (const scene::Node& node : scene.nodes) {
    const scene::Transform& t = node.parent_from_node;
    out.nodes.push_back({text(node.name), node.parent, t.translation, t.rotation, t.scale});
  }
  out.materials = scene.materials;
  for (materials::Material& material : out.materials) material.name = text(material.name);
  for (const scene::Texture& texture : scene.textures)
    out.textures.push_back(
        {text(texture.name), texture.width, texture.height, texture.linear, texture.rgba});
  for (const scene::Frame& frame : scene.frames)
    out.frames.push_back(
        {text(frame.name), static_cast<std::uint32_t>(frame.node), frame.origin, frame.rotation});
}

pan::Contents contents_of(const scene::Scene& scene, const Options& options, Report& report,
                          DiagnosticLog& log) {
  const auto start = Clock::now();
  std::vector<std::uint32_t> mesh_of;
  const std::vector<Job> jobs = collect_jobs(scene, mesh_of);
  auto meshes = pack_all(jobs, options, log);

  pan::Contents out;
  out.version = "panwright " PANWRIGHT_VERSION;
  out.options = describe(options);
  std::vector<std::uint32_t> place(meshes.size());
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    place[i] = static_cast<std::uint32_t>(out.meshes.size());
    if (meshes[i]) out.meshes.push_back(std::move(*meshes[i]));
  }
  copy_tables(scene, out);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Instance& instance = scene.instances[i];
    if (!meshes[mesh_of[i]]) continue;  // reported above
    out.instances.push_back({static_cast<std::uint32_t>(instance.node), place[mesh_of[i]],
                             static_cast<std::uint32_t>(instance.material), instance.texture});
    if (!options.strip_sources)
      out.sources.push_back(
          {text(instance.source.file), instance.source.line, instance.source.column});
    report.triangles += out.meshes[place[mesh_of[i]]].triangle_count();
  }
  for (const pan::PackedMesh& mesh : out.meshes) {
    report.unique_triangles += mesh.triangle_count();
    report.worst_error = std::max(report.worst_error, mesh.error);
  }
  report.unique_meshes = out.meshes.size();
  report.instances = out.instances.size();
  report.seconds_tessellate = seconds_since(start);
  return out;
}

}  // namespace

Result<Report> compile(const scene::Scene& scene, const Options& options,
                       const std::filesystem::path& output, DiagnosticLog& log) {
  Report report;
  const auto contents = contents_of(scene, options, report, log);
  const auto start = Clock::now();
  const auto written = pan::write(contents, output, log);
  if (!written) return failed;
  report.bytes = written->bytes;
  report.seconds_sync = written->seconds_sync;
  report.seconds_write = seconds_since(start) - written->seconds_sync;
  return report;
}

Result<std::vector<std::byte>> compiled(const scene::Scene& scene, const Options& options,
                                        DiagnosticLog& log) {
  Report report;
  const auto contents = contents_of(scene, options, report, log);
  return pan::write_to_memory(contents);
}

}  // namespace panwright::compiler
