// Forms of storage: bytes a triangle, how fast meshes are stored and loaded, and what that moves.
#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>

#include "bench/bench.h"
#include "compiler/compile.h"
#include "pan/internal/mesh_stream.h"
#include "pan/model.h"
#include "workspace/open.h"

namespace panwright::bench::case_storage {

namespace {

constexpr const char* kForms[] = {"none", "lossless", "lossy:11", "lossy:14", "lossy:16"};

// Meshes as a plain file has them, as they were before they are stored.
std::vector<pan::PackedMesh> meshes_of(const pan::Model& model) {
  std::vector<pan::PackedMesh> out;
  for (std::size_t m = 0; m < model.meshes().size(); ++m) {
    const pan::MeshView view = model.mesh(m);
    pan::PackedMesh& mesh = out.emplace_back();
    for (const auto& p : view.positions)
      mesh.positions.insert(mesh.positions.end(), {p.x, p.y, p.z});
    for (const auto& n : view.normals) mesh.normals.insert(mesh.normals.end(), {n.x, n.y, n.z});
    for (std::size_t i = 0; i < view.indices.size(); ++i) mesh.indices.push_back(view.indices[i]);
  }
  return out;
}

std::uint64_t stored_bytes(const pan::Model& model) {
  using pan::layout::SectionKind;
  std::uint64_t out = 0;
  for (const SectionKind kind : {SectionKind::positions, SectionKind::normals, SectionKind::indices,
                                 SectionKind::stream_bytes, SectionKind::mesh_streams})
    if (const auto* entry = model.entry(kind)) out += entry->stored_length;
  return out;
}

void run_form(Context& context, const std::string& name, const scene::Scene& scene,
              const pan::Model& plain, const char* text) {
  const pan::StorageForm form = *pan::storage_form(text);
  DiagnosticLog log;
  compiler::Options options;
  options.storage = form;
  const auto bytes = compiler::compiled(scene, options, log);
  auto model = bytes ? pan::Model::from_bytes(*bytes, name, log) : Result<pan::Model>(failed);
  if (!model || !model->check(log)) {
    context.note(fmt::format("{} could not be stored as {}", name, text));
    return;
  }
  double moved = 0, turned = 0, relative = 0;
  for (std::size_t m = 0; m < model->mesh_streams().size(); ++m) {
    const auto& stream = model->mesh_streams()[m];
    const auto& mesh = model->meshes()[m];
    double side = 0;
    for (int k = 0; k < 3; ++k)
      side = std::max<double>(side, mesh.bounds_max[k] - mesh.bounds_min[k]);
    moved = std::max(moved, stream.position_error);
    turned = std::max(turned, stream.normal_error);
    if (side > 0) relative = std::max(relative, stream.position_error / side);
  }
  std::uint64_t triangles = 0;
  for (const auto& mesh : model->meshes()) triangles += mesh.triangle_count;
  const double raw = 24.0 * static_cast<double>(model->positions().size()) +
                     static_cast<double>(model->index_bytes().size());
  const auto stored = stored_bytes(*model);
  const std::vector<pan::PackedMesh> meshes = meshes_of(plain);
  double plain_raw = 0;
  for (const auto& mesh : meshes)
    plain_raw += 24.0 * static_cast<double>(mesh.vertex_count()) +
                 static_cast<double>(mesh.indices.size()) * (mesh.vertex_count() <= 65535 ? 2 : 4);
  const auto store = [&] {
    for (pan::PackedMesh mesh : meshes) {
      if (!form.streams()) continue;
      pan::snap(mesh, form.bits, pan::normal_bits(form.bits), {});
      pan::encode(mesh);
    }
  };
  const auto load = [&] {
    DiagnosticLog inner;
    if (!model->check(inner)) std::abort();
  };
  const auto timings = interleaved({{"load", load}, {"store", store}}, context.quick() ? 3 : 5);
  const std::string setting =
      fmt::format("{} {} bytes={} bytes/triangle={:.2f}", name, text, stored,
                  static_cast<double>(stored) / static_cast<double>(triangles));
  Row row{.case_name = "storage",
          .setting = fmt::format("load {} relative={:.2g}", setting, relative),
          .speed_unit = "GB/s",
          .error = moved,
          .error_unit = "m",
          .reference = "positions before they were stored, largest distance"};
  set_rate(row, timings[0], 1e-9 * raw);
  context.add(row);
  if (!form.streams()) return;
  row.setting = "store, one core, " + setting;
  row.error = turned / kDegree;
  row.error_unit = "deg";
  row.reference = "normals before they were stored, largest angle";
  set_rate(row, timings[1], 1e-9 * plain_raw);
  context.add(row);
}

void run_model(Context& context, const std::string& name, const std::filesystem::path& path) {
  DiagnosticLog log;
  workspace::OpenOptions options;
  auto scene = workspace::read_scene(path, options, log);
  if (!scene) {
    context.note(name + " could not be read");
    return;
  }
  const auto bytes = compiler::compiled(*scene, {}, log);
  auto plain = bytes ? pan::Model::from_bytes(*bytes, name, log) : Result<pan::Model>(failed);
  if (!plain || !plain->check(log)) {
    context.note(name + " could not be compiled");
    return;
  }
  for (const char* form : kForms) run_form(context, name, *scene, *plain, form);
}

void run(Context& context) {
  run_model(context, "servicer", context.source("examples/servicer/servicer.pxn"));
  if (context.quick()) return;
  for (const char* name : {"jwst-draco-webp", "landsat8-blender"}) {
    const auto path =
        context.source(std::string("../shared/data/spacecraft-gltf/") + name + ".glb");
    if (path.empty())
      context.note(fmt::format("{}.glb is not there", name));
    else
      run_model(context, name, path);
  }
}

const bool kAdded = add_case({"storage", "forms of storage: bytes, speed and what is moved", run});

}  // namespace

}  // namespace panwright::bench::case_storage
