#include "tests/fuzz/targets.h"

#include <cstring>
#include <string>

#include "compiler/compile.h"
#include "importers/import.h"
#include "pan/diff.h"
#include "pan/model.h"
#include "pxn/pxn.h"
#include "tests/fuzz/require.h"

namespace panwright::fuzz {

namespace {

// Reads every byte that a checked model hands out.
void touch(const panwright::pan::Model& model) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < model.meshes().size(); ++i) {
    const auto mesh = model.mesh(i);
    for (std::size_t k = 0; k < mesh.indices.size(); ++k) {
      const std::uint32_t index = mesh.indices[k];
      require(index < mesh.positions.size(), "index below vertex count");
      sum += static_cast<std::uint64_t>(mesh.positions[index].x > 0);
    }
    sum += model.mesh_name(i).size();
  }
  for (std::size_t i = 0; i < model.nodes().size(); ++i) sum += model.node_path(i).size();
  for (std::size_t i = 0; i < model.textures().size(); ++i) sum += model.texels(i).back();
  for (std::size_t i = 0; i < model.materials().size(); ++i) sum += model.material_name(i).size();
  for (std::size_t i = 0; i < model.frames().size(); ++i)
    sum += static_cast<std::uint64_t>(is_finite(Vec3(model.world_from_frame(i)[3])));
  for (const auto& instance : model.instances())
    sum += model.world_from_nodes()[instance.node][3].w > 0;
  if (const auto bounds = model.world_bounds()) require(bounds->low.x <= bounds->high.x, "bounds");
  sum += model.version().size() + model.options().size();
  const auto difference = panwright::pan::diff(model, model);
  require(difference.model.empty() && difference.provenance.empty(), "a model equals itself");
  require(sum != ~std::uint64_t{0}, "a sum that uses every value read");
}

// Compiles a sound scene, and checks what comes of it.
void compile(const scene::Scene& scene) {
  compiler::Options options;
  options.max_error = 0.05;
  options.max_triangles = 5000;
  DiagnosticLog log;
  const auto bytes = compiler::compiled(scene, options, log);
  if (!bytes) {
    require(log.has_errors(), "no file without an error");
    return;
  }
  DiagnosticLog reading;
  auto model = panwright::pan::Model::from_bytes(*bytes, "fuzz.pan", reading);
  require(model && model->check(reading), "what the compiler writes is sound: " + to_text(reading));
}

}  // namespace

void pxn(std::span<const std::byte> input) {
  const std::string text(reinterpret_cast<const char*>(input.data()), input.size());
  const panwright::pxn::MemoryFile files[] = {{"top.pxn", text}, {"part.pxn", text}};
  panwright::pxn::Options options;
  options.limits.nodes = 2000;
  options.limits.elements = 20000;
  options.limits.includes = 20;
  options.limits.texture_bytes = 1 << 20;
  DiagnosticLog log;
  const auto scene = panwright::pxn::read_memory(files, options, log);
  require(scene.ok() || log.has_errors(), "no scene without an error");
  (void)to_text(log);
  (void)to_json(log);
  if (!scene) return;
  require(scene::check(*scene).empty(), scene::check(*scene));
  compile(*scene);
}

void vrml(std::span<const std::byte> input) {
  const std::string text(reinterpret_cast<const char*>(input.data()), input.size());
  const importers::MemoryFile files[] = {{"top.wrl", text}, {"part.wrl", text}};
  importers::Options options;
  options.limits.nodes = 2000;
  options.limits.triangles = 20000;
  options.limits.files = 20;
  options.limits.memory = 64u << 20;
  options.limits.texture_bytes = 1 << 20;
  options.assume = importers::Format::vrml97;
  DiagnosticLog log;
  const auto imported = importers::import_memory(files, options, log);
  require(imported.ok() || log.has_errors(), "no scene without an error");
  (void)to_text(log);
  if (!imported) return;
  require(scene::check(imported->scene).empty(), scene::check(imported->scene));
  require(imported->materials.size() == imported->scene.materials.size(), "a record for each");
  compile(imported->scene);
}

void pan(std::span<const std::byte> input) {
  DiagnosticLog log;
  auto model = panwright::pan::Model::from_bytes(input, "fuzz.pan", log);
  if (!model || !model->check(log)) {
    require(log.has_errors() && exit_code(log) == 4,
            "a refusal names a damaged pan: " + to_text(log));
    return;
  }
  touch(*model);
}

}  // namespace panwright::fuzz
