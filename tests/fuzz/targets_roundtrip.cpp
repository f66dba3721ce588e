#include "tests/fuzz/targets_roundtrip.h"

#include <cmath>
#include <string>
#include <vector>

#include "compiler/compile.h"
#include "importers/clean.h"
#include "importers/import.h"
#include "pan/diff.h"
#include "pan/model.h"
#include "pxn/pxn.h"
#include "tests/fuzz/require.h"

namespace panwright::fuzz {

namespace {

// note: what a log says of files refers to their bytes
struct Files {
  std::vector<pxn::MemoryFile> pxn;
  std::vector<importers::MemoryFile> cad;
};

std::optional<scene::Scene> read_pxn(const std::string& text, Files& kept, DiagnosticLog& log) {
  kept.pxn = {{"top.pxn", text}, {"part.pxn", text}};
  pxn::Options options;
  options.limits.nodes = 2000;
  options.limits.elements = 20'000;
  options.limits.includes = 20;
  options.limits.texture_bytes = 1 << 20;
  auto scene = pxn::read_memory(kept.pxn, options, log);
  if (!scene) return std::nullopt;
  return std::move(*scene);
}

std::optional<scene::Scene> read_cad(Source source, const std::string& bytes, Files& kept,
                                     DiagnosticLog& log) {
  constexpr const char* kNames[] = {"",      "m.wrl",  "m.gltf", "m.obj", "m.stl",
                                    "m.ply", "m.urdf", "m.xml",  "m.step"};
  const std::string name = kNames[static_cast<std::size_t>(source)];
  // a file may be its own part, buffer and library
  kept.cad = {{name, bytes}, {"part.wrl", bytes}, {"data.bin", bytes}, {"m.mtl", bytes}};
  // and the mesh of a robot
  constexpr const char* kCube =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  if (source == Source::urdf || source == Source::mjcf) kept.cad.push_back({"meshes/a.obj", kCube});
  importers::Options options;
  options.limits.nodes = 2000;
  options.limits.triangles = 20'000;
  options.limits.memory = 64 << 20;
  options.limits.texture_bytes = 1 << 20;
  options.limits.files = 20;
  options.limits.seconds = 20;
  auto imported = importers::import_memory(kept.cad, options, log);
  if (!imported) return std::nullopt;
  require(imported->materials.size() == imported->scene.materials.size(), "a material for each");
  DiagnosticLog cleaning;
  importers::place(*imported, std::nullopt, std::nullopt, false, cleaning);
  require(importers::clean_up(imported->scene, {}, cleaning).ok(), "cleaning is not cancelled");
  return std::move(imported->scene);
}

// The model has what the scene has. note: shapes that cannot be made are told and left out
void compare(const scene::Scene& scene, const pan::Model& model, bool all_made) {
  require(model.nodes().size() == scene.nodes.size(), "as many nodes");
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const scene::Node& node = scene.nodes[i];
    require(model.nodes()[i].parent == node.parent, "the same parent");
    require(std::string(model.node_name(i)) == to_utf8(node.name, Encoding::utf8), "its name");
  }
  const auto worlds = scene::world_from_nodes(scene);
  const auto stored = model.world_from_nodes();
  for (std::size_t i = 0; i < worlds.size(); ++i) require(worlds[i] == stored[i], "its place");
  require(model.instances().size() <= scene.instances.size(), "no more instances");
  require(!all_made || model.instances().size() == scene.instances.size(), "all instances");
  require(model.frames().size() == scene.frames.size(), "as many frames");
  require(model.keypoints().size() == scene.keypoints.size(), "as many keypoints");
}

bool write_and_read(const scene::Scene& scene) {
  std::vector<std::byte> written[2];
  std::vector<pan::Model> models;
  for (const bool compress : {false, true}) {
    compiler::Options options;
    options.max_error = 0.05;
    options.max_triangles = 20'000;
    if (compress) options.storage.kind = pan::StorageForm::Kind::lossless;
    DiagnosticLog log;
    auto bytes = compiler::compiled(scene, options, log);
    if (!bytes) {
      require(log.has_errors(), "no file without an error");
      return false;
    }
    DiagnosticLog again;
    const auto second = compiler::compiled(scene, options, again);
    require(second && *second == *bytes, "the same bytes a second time");
    DiagnosticLog reading;
    auto model = pan::Model::from_bytes(*bytes, "fuzz.pan", reading);
    const bool sound = model && model->check(reading);
    require(sound, "the reader takes it: " + to_text(reading));
    compare(scene, *model, !log.has_errors() && log.warnings() == 0);
    models.push_back(std::move(*model));
  }
  const auto difference = pan::diff(models[0], models[1]);
  require(difference.same_model(), "compression changes nothing");
  return true;
}

}  // namespace

bool roundtrip(Source source, std::span<const std::byte> input) {
  const std::string bytes(reinterpret_cast<const char*>(input.data()), input.size());
  Files kept;
  DiagnosticLog log;
  const auto scene =
      source == Source::pxn ? read_pxn(bytes, kept, log) : read_cad(source, bytes, kept, log);
  require(scene.has_value() || log.has_errors(), "no scene without an error");
  for (const Diagnostic& entry : log.entries())
    require(!entry.message.empty(), "a message with each code");
  require(to_text(log).size() < 1u << 20, "messages of bounded size");
  (void)to_json(log);
  if (!scene) return false;
  require(scene::check(*scene).empty(), scene::check(*scene));
  return write_and_read(*scene);
}

void roundtrip(std::span<const std::byte> input) {
  if (input.empty()) return;
  const auto kind = static_cast<std::uint8_t>(input[0]) % static_cast<std::uint8_t>(Source::step);
  roundtrip(static_cast<Source>(kind), input.subspan(1));
}

}  // namespace panwright::fuzz
