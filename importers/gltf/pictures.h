// Pictures of a glTF file. Private to importers/gltf.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <tuple>

#include "importers/gltf/structs.h"
#include "importers/image.h"

namespace panwright::importers::gltf {

// What a surface takes from a picture.
enum class PictureUse : std::uint8_t { colour, normal, roughness };

// Reads pictures when they are asked for, each once.
class Pictures {
 public:
  Pictures(Document& document, const tinygltf::Model& model, scene::Scene& scene)
      : document_(document), model_(model), scene_(scene) {}

  // The scene's texture for a glTF texture; kNone where it cannot be read, which is reported once.
  std::int32_t texture(int index, PictureUse use);

  // The mean of a picture's channels, each 0 to 1, colour decoded from sRGB or not; 1 without a
  // picture.
  Vec4 mean(int index, bool srgb);

 private:
  const DecodedImage* picture(int index, std::size_t& image);
  std::optional<DecodedImage> load(std::size_t image);
  bool bytes_of(std::size_t image, const Json& json, std::string& name, SharedText& owner,
                std::span<const std::byte>& bytes);

  Document& document_;
  const tinygltf::Model& model_;
  scene::Scene& scene_;
  std::map<std::size_t, std::optional<DecodedImage>> images_;
  std::map<std::size_t, std::string> names_;
  std::map<std::pair<std::size_t, PictureUse>, std::int32_t> textures_;
  std::uint64_t decoded_ = 0;  // bytes
};

}  // namespace panwright::importers::gltf
