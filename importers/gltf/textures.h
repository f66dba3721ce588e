// Textures of a glTF file. Private to importers/gltf.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <tuple>

#include "image/decode.h"
#include "image/texture_bake.h"
#include "importers/gltf/structs.h"
#include "materials/gltf_surface.h"

namespace panwright::importers::gltf {

// Use of a texture by a surface.
enum class TextureUse : std::uint8_t { color, normal, roughness };

// A metal whose colour or metallic part comes from textures; glTF's textures, −1: none.
struct MetalRecipe {
  int base = -1;   // colour
  int metal = -1;  // metallic part, in blue
  Vec3 factor{1};  // of the colour
  double metallic = 1;
  Vec3 dielectric{0.04};  // reflectance of dielectric parts
};

// A surface whose specular colour comes from a texture; glTF's textures, −1: none.
struct GlossRecipe {
  int diffuse = -1;
  int specular = -1;  // its colour; glossiness in alpha
  Vec3 factor{1};     // of the specular colour
  double glossiness = 1;
};

// Computed textures of a recipe; kNone: none is needed.
struct RecipeTextures {
  std::int32_t albedo = scene::kNone;  // without factors of the diffuse colour
  std::int32_t reflectance = scene::kNone;
  std::int32_t roughness = scene::kNone;  // the slope itself
};

// Reader of textures on demand, each once.
class TextureReader {
 public:
  TextureReader(Document& document, const tinygltf::Model& model, scene::Scene& scene)
      : document_(document), model_(model), scene_(scene) {}

  // Returns the scene's texture for a glTF texture; kNone if unreadable, which is reported once.
  std::int32_t texture(int index, TextureUse use);

  // Returns the mean of a texture's channels, each 0 to 1, with or without decoding of sRGB colour;
  // 1 without a texture.
  Vec4 mean(int index, bool srgb);

  // Returns true if a texture is constant in one channel; true without a texture.
  bool is_even(int index, int channel);

  // Returns true along u and v if a texture's sampler repeats.
  std::array<bool, 2> repeats(int index) const;

  // Computes textures, once for equal recipes. None if textures are missing, or over the limit of
  // texture bytes.
  std::optional<RecipeTextures> metal(const MetalRecipe& recipe);
  std::optional<RecipeTextures> gloss(const GlossRecipe& recipe);

  // Returns the texture of normals with slopes multiplied by a factor.
  std::optional<std::int32_t> normals(int index, double scale);
  // Returns the texture of diffuse colours below a coat of ours, factor included.
  std::optional<std::int32_t> below_coat(int index, const Vec3& factor,
                                         const materials::DiffuseCurve& curve);

  // Returns the mean of a texture of the scene, decoded.
  Vec4 mean_of(std::int32_t texture) const;

 private:
  const image::DecodedImage* texture(int index, std::size_t& image);
  const image::DecodedImage* texture(int index);
  bool has_room(std::span<const image::BakeSource> sources, std::size_t textures) const;
  std::int32_t add(int index, const char* what, image::Baked& baked, std::size_t texture,
                   bool linear);
  std::string name_of(int index);
  std::optional<image::DecodedImage> load(std::size_t image);
  bool bytes_of(std::size_t image, const Json& json, std::string& name, SharedText& owner,
                std::span<const std::byte>& bytes);

  Document& document_;
  const tinygltf::Model& model_;
  scene::Scene& scene_;
  std::map<std::size_t, std::optional<image::DecodedImage>> images_;
  std::map<std::size_t, std::string> names_;
  std::map<std::pair<std::size_t, TextureUse>, std::int32_t> textures_;
  std::map<std::vector<double>, std::optional<RecipeTextures>> made_;  // by their recipes
  std::map<std::pair<std::size_t, bool>, Vec4> means_;                 // by image and decoding
  std::map<std::pair<std::size_t, int>, bool> even_;                   // by image and channel
  std::uint64_t decoded_ = 0;  // bytes, computed textures included
};

}  // namespace panwright::importers::gltf
