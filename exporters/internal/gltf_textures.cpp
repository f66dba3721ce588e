#include "exporters/internal/gltf_textures.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "image/png.h"
#include "image/srgb.h"

namespace panwright::exporters {

namespace {

std::size_t place_of(double at, std::uint32_t size) {
  return std::min(static_cast<std::size_t>(at * size), static_cast<std::size_t>(size) - 1);
}

}  // namespace

Vec4 nearest_texel(const image::BakeSource& source, double u, double v) {
  if (source.rgba.empty()) return Vec4(1);
  const std::size_t x = place_of(u, source.width), y = place_of(v, source.height);
  const std::uint8_t* code = &source.rgba[4 * (y * source.width + x)];
  const auto value = [&](std::uint8_t c) {
    return source.srgb ? image::srgb_decoded(c) : c / 255.0;
  };
  return {value(code[0]), value(code[1]), value(code[2]), code[3] / 255.0};
}

image::BakeSource TexturePool::source(std::int32_t texture) const {
  if (texture < 0) return {};
  const auto index = static_cast<std::size_t>(texture);
  const pan::layout::Texture& record = model_.textures()[index];
  return {model_.texels(index), record.width, record.height,
          (record.flags & pan::layout::kTextureLinear) == 0};
}

std::size_t TexturePool::copied(std::int32_t texture, Channel channel) {
  const auto [known, is_new] = copies_.try_emplace({texture, channel}, images_.size());
  if (!is_new) return known->second;
  const image::BakeSource from = source(texture);
  images_.push_back({std::string(model_.texture_name(static_cast<std::size_t>(texture))),
                     from.width,
                     from.height,
                     texture,
                     channel,
                     {}});
  return known->second;
}

std::size_t TexturePool::added(std::string name, std::uint32_t width, std::uint32_t height,
                               std::vector<std::uint8_t> rgba) {
  for (std::size_t i = 0; i < images_.size(); ++i)
    if (images_[i].name == name && images_[i].rgba == rgba && images_[i].width == width) return i;
  images_.push_back({std::move(name), width, height, -1, Channel::color, std::move(rgba)});
  return images_.size() - 1;
}

std::vector<std::uint8_t> TexturePool::recoded(const Image& image) const {
  const image::BakeSource from = source(image.texture);
  std::vector<std::uint8_t> out(from.rgba.begin(), from.rgba.end());
  if (from.srgb == (image.channel == Channel::color)) return out;
  std::array<std::uint8_t, 256> table;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto code = static_cast<std::uint8_t>(i);
    table[i] = from.srgb ? static_cast<std::uint8_t>(255 * image::srgb_decoded(code) + 0.5)
                         : image::srgb_code(static_cast<double>(i) / 255);
  }
  for (std::size_t i = 0; i < out.size(); ++i)
    if (i % 4 != 3) out[i] = table[out[i]];
  return out;
}

std::vector<TexturePool::Packed> TexturePool::packed() const {
  std::vector<Packed> out(images_.size());
  parallel_for(
      images_.size(),
      [&](std::size_t i) {
        const Image& image = images_[i];
        out[i].name = image.name;
        out[i].png = image.texture < 0 ? image::png_file(image.width, image.height, image.rgba)
                                       : image::png_file(image.width, image.height, recoded(image));
      },
      job_);
  return out;
}

}  // namespace panwright::exporters
