#include <fstream>
#include <nlohmann/json.hpp>

#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#define TINYGLTF_NO_INCLUDE_JSON
#include "importers/gltf/structs.h"

#include <fmt/core.h>

namespace panwright::importers::gltf {

namespace {

// What stands in the place of something that cannot be read.
std::string_view filler(std::string_view collection) {
  if (collection == "meshes") return R"({"primitives":[]})";
  if (collection == "skins") return R"({"joints":[]})";
  return "{}";
}

void append_mesh(const Json& mesh, std::string& text) {
  Json whole = mesh;
  if (Json* primitives = whole.find("primitives"))
    for (Json& primitive : primitives->items)
      if (!primitive.find("attributes")) {
        // keeps its place
        primitive = Json{};
        primitive.kind = Json::Kind::object;
        primitive.keys.push_back("attributes");
        primitive.items.emplace_back().kind = Json::Kind::object;
      }
  append_json(whole, text);
}

void append_collection(const Document& document, std::string_view name, std::string& text) {
  const std::vector<Json>& items = document.root.list(name);
  if (items.empty()) return;
  text += fmt::format(",\"{}\":[", name);
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) text += ',';
    // a node or texture without a part of it is still one
    const bool lost = items[i].broken && (name == "skins" || name == "meshes");
    if (lost || !items[i].is(Json::Kind::object))
      text += filler(name);
    else if (name == "meshes")
      append_mesh(items[i], text);
    else
      append_json(items[i], text);
  }
  text += ']';
}

// tinygltf looks the accessors of primitives up, no more.
void append_placeholders(const Document& document, std::string& text) {
  if (document.accessors.empty()) return;
  text += R"(,"bufferViews":[{"buffer":0,"byteLength":1}],"accessors":[)";
  for (std::size_t i = 0; i < document.accessors.size(); ++i) {
    if (i > 0) text += ',';
    text += R"({"bufferView":0,"componentType":5126,"count":1,"type":"SCALAR"})";
  }
  text += ']';
}

bool no_image(tinygltf::Image*, const int, std::string*, std::string*, int, int,
              const unsigned char*, int, void*) {
  return true;
}

}  // namespace

bool structs_of(const Document& document, tinygltf::Model& model, std::string& problem) {
  std::string text = R"({"asset":{"version":"2.0"})";
  for (const char* name :
       {"nodes", "meshes", "materials", "textures", "samplers", "skins", "scenes"})
    append_collection(document, name, text);
  append_placeholders(document, text);
  text += '}';
  tinygltf::TinyGLTF reader;
  reader.SetImageLoader(no_image, nullptr);
  std::string warnings;
  if (!reader.LoadASCIIFromString(&model, &problem, &warnings, text.data(),
                                  static_cast<unsigned>(text.size()), ""))
    return false;
  if (const Json* asset = document.root.find("asset"))
    if (const Json* generator = asset->find("generator")) model.asset.generator = generator->text;
  return true;
}

}  // namespace panwright::importers::gltf
