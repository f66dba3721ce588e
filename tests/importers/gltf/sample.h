// Small glTF files made by hand.
#pragma once

#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "importers/import.h"

namespace panwright::importers {

constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123,
              kUnsignedInt = 5125, kFloat = 5126;

// File under construction: JSON, and the bytes of its one buffer.
struct Sample {
  nlohmann::json json = {{"asset", {{"version", "2.0"}}}};
  std::string bytes;

  // Appends numbers to the buffer at a multiple of 4 and makes a view of them.
  template <class T>
  int view(const std::vector<T>& numbers, int stride = 0) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    const std::size_t at = bytes.size(), size = numbers.size() * sizeof(T);
    bytes.resize(at + size);
    std::memcpy(bytes.data() + at, numbers.data(), size);
    nlohmann::json view = {{"buffer", 0}, {"byteOffset", at}, {"byteLength", size}};
    if (stride > 0) view["byteStride"] = stride;
    json["bufferViews"].push_back(view);
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }
  int accessor(int view, int component, std::size_t count, const char* type,
               bool normalised = false);
  // A view with an accessor over the whole of it.
  template <class T>
  int numbers(const std::vector<T>& list, int component, const char* type, int width) {
    return accessor(view(list), component, list.size() / static_cast<std::size_t>(width), type);
  }
  // Adds a mesh of one primitive and a node with it to the only scene. Returns the primitive.
  nlohmann::json& add_mesh(nlohmann::json primitive);

  std::string glb() const;
  std::string gltf() const;  // the buffer as a data URI
};

// One triangle (0,0,0) (1,0,0) (0,1,0) at a node.
Sample triangle();

struct Loaded {
  Result<Imported> imported = failed;
  DiagnosticLog log{1000};
  std::string text() const { return to_text(log); }
};

Loaded load(std::string bytes, const Options& options = {}, std::vector<MemoryFile> more = {});

// The only mesh, or that of an instance.
const geometry::Mesh& mesh_of(const Imported& imported, std::size_t instance = 0);

// Corners of all instances in the frame of the scene, in order.
std::vector<Vec3> corners_of(const Imported& imported);

}  // namespace panwright::importers
