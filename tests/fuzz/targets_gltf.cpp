#include "tests/fuzz/targets_gltf.h"

#include <fmt/core.h>

#include <string>

#include "compiler/compile.h"
#include "exporters/export.h"
#include "image/decode.h"
#include "image/gif.h"
#include "importers/import.h"
#include "pan/model.h"
#include "tests/fuzz/require.h"

namespace panwright::fuzz {

namespace {

importers::Options small_options() {
  importers::Options options;
  options.limits.nodes = 2000;
  options.limits.triangles = 200'000;
  options.limits.memory = 256 << 20;
  options.limits.texture_bytes = 1 << 20;
  options.limits.files = 20;
  return options;
}

void import_and_check(std::span<const importers::MemoryFile> files) {
  DiagnosticLog log;
  const auto imported = importers::import_memory(files, small_options(), log);
  require(imported.ok() || log.has_errors(), "no scene without an error");
  (void)to_text(log);
  (void)to_json(log);
  if (!imported) return;
  require(scene::check(imported->scene).empty(), scene::check(imported->scene));
  require(imported->materials.size() == imported->scene.materials.size(), "a material for each");

  compiler::Options compile;
  compile.max_error = 0.05;
  compile.max_triangles = 200'000;
  DiagnosticLog compiling;
  const auto bytes = compiler::compiled(imported->scene, compile, compiling);
  if (!bytes) {
    require(compiling.has_errors(), "no file without an error");
    return;
  }
  DiagnosticLog reading;
  auto model = panwright::pan::Model::from_bytes(*bytes, "fuzz.pan", reading);
  const bool sound = model && model->check(reading);
  require(sound, "what the compiler writes is sound: " + to_text(reading));
  const auto glb = exporters::glb_from(*model, reading);
  require(glb.ok(), "a small model can be exported");
}

void append_word(std::string& out, std::size_t word) {
  for (int i = 0; i < 4; ++i) out += static_cast<char>(word >> (8 * i) & 255);
}

}  // namespace

void gltf(std::span<const std::byte> input) {
  const std::string bytes(reinterpret_cast<const char*>(input.data()), input.size());
  const importers::MemoryFile files[] = {{"model.gltf", bytes}, {"data.bin", bytes}};
  import_and_check(files);
}

void draco(std::span<const std::byte> input) {
  std::string stream(reinterpret_cast<const char*>(input.data()), input.size());
  std::string text = fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],)"
      R"("extensionsUsed":["KHR_draco_mesh_compression"],)"
      R"("extensionsRequired":["KHR_draco_mesh_compression"],"buffers":[{{"byteLength":{0}}}],)"
      R"("bufferViews":[{{"buffer":0,"byteLength":{0}}}],"accessors":[)"
      R"({{"componentType":5126,"count":9,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}},)"
      R"({{"componentType":5126,"count":9,"type":"VEC3"}},)"
      R"({{"componentType":5125,"count":24,"type":"SCALAR"}}],"meshes":[{{"primitives":[)"
      R"({{"attributes":{{"POSITION":0,"NORMAL":1}},"indices":2,"extensions":{{)"
      R"("KHR_draco_mesh_compression":{{"bufferView":0,"attributes":{{"POSITION":0,"NORMAL":1}})"
      R"(}}}}}}]}}]}})",
      std::max<std::size_t>(stream.size(), 1));
  text.resize((text.size() + 3) / 4 * 4, ' ');
  stream.resize((stream.size() + 3) / 4 * 4);
  std::string out = "glTF";
  append_word(out, 2);
  append_word(out, 28 + text.size() + stream.size());
  append_word(out, text.size());
  out += "JSON" + text;
  append_word(out, stream.size());
  out += std::string("BIN\0", 4) + stream;
  const importers::MemoryFile files[] = {{"model.glb", out}};
  import_and_check(files);
}

void mesh(std::span<const std::byte> input) {
  const std::string bytes(reinterpret_cast<const char*>(input.data()), input.size());
  const importers::MemoryFile obj[] = {{"m.obj", bytes}, {"m.mtl", bytes}};
  import_and_check(obj);
  if (bytes.starts_with("ply")) return;
  const importers::MemoryFile stl[] = {{"m.stl", bytes}};
  import_and_check(stl);
}

void image(std::span<const std::byte> input) {
  constexpr std::uint64_t kMost = 1 << 22;
  image::DecodedImage out;
  const auto problem = image::is_gif(input) ? image::decode_gif(input, kMost, out)
                                            : image::decode_image(input, kMost, out);
  require(problem.code.has_value() == !problem.message.empty(), "a message with each code");
  if (problem.code) return;
  require(out.rgba.size() == std::size_t{4} * out.width * out.height, "as many texels as its size");
  require(out.rgba.size() <= kMost, "no more texels than allowed");
}

}  // namespace panwright::fuzz
