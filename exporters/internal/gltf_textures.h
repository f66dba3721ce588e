// Textures of an exported file. Private to exporters.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "image/texture_bake.h"
#include "pan/model.h"

namespace panwright::exporters {

// Pool of textures, each once, packed as PNG.
class TexturePool {
 public:
  struct Packed {
    std::string name;
    std::string png;
  };

  // Encoding of RGB in the file: colours are sRGB codes, numbers are linear.
  enum class Channel : std::uint8_t { color, number };

  // Both outlive the pool.
  TexturePool(const pan::Model& model, const Job& job) : model_(model), job_(job) {}

  // Returns the index of a pan's texture in the file. Codes are converted if the pan's encoding
  // differs.
  std::size_t copied(std::int32_t texture, Channel channel);

  // Returns the index of a computed texture. rgba: as of Baked. Equal bytes of one name share an
  // index.
  std::size_t added(std::string name, std::uint32_t width, std::uint32_t height,
                    std::vector<std::uint8_t> rgba);

  // A texture of the pan; −1: one that is 1 everywhere.
  image::BakeSource source(std::int32_t texture) const;

  // Returns all textures, in the order of their indices. Cost: O(texels).
  std::vector<Packed> packed() const;

 private:
  struct Image {
    std::string name;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::int32_t texture = -1;  // of the pan, as it is; −1: rgba
    Channel channel = Channel::color;
    std::vector<std::uint8_t> rgba;
  };

  std::vector<std::uint8_t> recoded(const Image& image) const;

  const pan::Model& model_;
  const Job& job_;
  std::vector<Image> images_;
  std::map<std::pair<std::int32_t, Channel>, std::size_t> copies_;
};

// Returns the nearest texel of a texture at (u, v), 0 to 1, v downwards; RGBA decoded, 0 to 1.
Vec4 nearest_texel(const image::BakeSource& source, double u, double v);

}  // namespace panwright::exporters
