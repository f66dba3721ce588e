#include "tests/importers/gltf/sample.h"

namespace panwright::importers {

namespace {

std::string base64(const std::string& bytes) {
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k <= bytes.size() ? kAlphabet[bits >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

void append_word(std::string& out, std::size_t word) {
  for (int i = 0; i < 4; ++i) out += static_cast<char>(word >> (8 * i) & 255);
}

}  // namespace

int Sample::accessor(int view, int component, std::size_t count, const char* type,
                     bool normalised) {
  nlohmann::json one = {{"componentType", component}, {"count", count}, {"type", type}};
  if (view >= 0) one["bufferView"] = view;
  if (normalised) one["normalized"] = true;
  json["accessors"].push_back(one);
  return static_cast<int>(json["accessors"].size()) - 1;
}

nlohmann::json& Sample::add_mesh(nlohmann::json primitive) {
  json["meshes"].push_back({{"primitives", {primitive}}});
  json["nodes"].push_back({{"mesh", json["meshes"].size() - 1}});
  if (!json.contains("scenes")) json["scenes"] = {{{"nodes", nlohmann::json::array()}}};
  json["scenes"][0]["nodes"].push_back(json["nodes"].size() - 1);
  return json["meshes"].back()["primitives"][0];
}

std::string Sample::glb() const {
  nlohmann::json whole = json;
  if (!bytes.empty() && !whole.contains("buffers"))
    whole["buffers"] = {{{"byteLength", bytes.size()}}};
  std::string text = whole.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string binary = bytes;
  binary.resize((binary.size() + 3) / 4 * 4);
  std::string out = "glTF";
  append_word(out, 2);
  append_word(out, 12 + 8 + text.size() + (binary.empty() ? 0 : 8 + binary.size()));
  append_word(out, text.size());
  out += "JSON" + text;
  if (binary.empty()) return out;
  append_word(out, binary.size());
  return out + std::string("BIN\0", 4) + binary;
}

std::string Sample::gltf() const {
  nlohmann::json whole = json;
  if (!bytes.empty() && !whole.contains("buffers"))
    whole["buffers"] = {{{"byteLength", bytes.size()},
                         {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
  return whole.dump(1);
}

Sample triangle() {
  Sample sample;
  const int positions =
      sample.numbers(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, kFloat, "VEC3", 3);
  sample.json["accessors"][0]["min"] = {0, 0, 0};
  sample.json["accessors"][0]["max"] = {1, 1, 0};
  sample.add_mesh({{"attributes", {{"POSITION", positions}}}});
  return sample;
}

Loaded load(std::string bytes, const Options& options, std::vector<MemoryFile> more) {
  Loaded out;
  std::vector<MemoryFile> files = {{"model.gltf", std::move(bytes)}};
  for (MemoryFile& file : more) files.push_back(std::move(file));
  out.imported = import_memory(files, options, out.log);
  return out;
}

const geometry::Mesh& mesh_of(const Imported& imported, std::size_t instance) {
  const auto shape = static_cast<std::size_t>(imported.scene.instances.at(instance).shape);
  return *std::get<geometry::MeshShape>(imported.scene.shapes.at(shape));
}

std::vector<Vec3> corners_of(const Imported& imported) {
  std::vector<Vec3> out;
  const std::vector<Mat4> world = scene::world_from_nodes(imported.scene);
  for (std::size_t i = 0; i < imported.scene.instances.size(); ++i) {
    const geometry::Mesh& mesh = mesh_of(imported, i);
    const Mat4& m = world[static_cast<std::size_t>(imported.scene.instances[i].node)];
    for (const geometry::Triangle& t : mesh.triangles)
      for (const std::uint32_t index : t) out.push_back(Vec3(m * Vec4(mesh.positions[index], 1)));
  }
  return out;
}

}  // namespace panwright::importers
