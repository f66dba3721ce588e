#include "importers/gltf/textures.h"

#include <fmt/core.h>
#include <webp/decode.h>

#include <cmath>

#include "base/file.h"
#include "base/text.h"
#include "image/srgb.h"
#include "importers/gltf/base64.h"

namespace panwright::importers::gltf {

namespace {

bool is_webp(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text.size() >= 12 && text.starts_with("RIFF") && text.substr(8, 4) == "WEBP";
}

std::string decode_webp(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                        image::DecodedImage& out) {
  const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  int width = 0, height = 0;
  if (!WebPGetInfo(data, bytes.size(), &width, &height) || width <= 0 || height <= 0)
    return "the head of the WebP image is damaged";
  out.width = static_cast<std::uint32_t>(width);
  out.height = static_cast<std::uint32_t>(height);
  const std::uint64_t size = std::uint64_t{4} * out.width * out.height;
  if (out.width > image::kMaxTextureSide || out.height > image::kMaxTextureSide || size > max_bytes)
    return fmt::format("{} x {} pixels are over the limit", width, height);
  out.rgba.resize(size);
  if (!WebPDecodeRGBAInto(data, bytes.size(), out.rgba.data(), out.rgba.size(), width * 4))
    return "the WebP image is damaged";
  return {};
}

image::BakeSource source_of(const image::DecodedImage* image, bool srgb) {
  if (!image) return {};
  return {image->rgba, image->width, image->height, srgb};
}

}  // namespace

bool TextureReader::bytes_of(std::size_t image, const Json& json, std::string& name,
                             SharedText& owner, std::span<const std::byte>& bytes) {
  const std::string at = pointer("images", image);
  const auto lost = [&](Code code, std::string message) {
    document_.report(code, &json, at, std::move(message));
    return false;
  };
  const Json* label = json.find("name");
  name = label && !label->text.empty() ? label->text : fmt::format("image{}", image);
  if (const Json* view = json.find("bufferView")) {
    const View& data = document_.views[static_cast<std::size_t>(view->number)];
    if (!data.sound) return lost(Code("W6004"), "the image lies in a view that cannot be read");
    bytes = data.bytes;
    return true;
  }
  const Json* uri = json.find("uri");
  if (!uri) return lost(Code("W6004"), "the image has neither 'uri' nor 'bufferView'");
  if (is_data_uri(uri->text)) {
    auto data = data_of(uri->text);
    if (!data) return lost(Code("W6004"), "the data URI of the image is damaged");
    owner = std::make_shared<const std::string>(std::move(data->bytes));
  } else {
    if (images_.size() + document_.inputs.size() > document_.options.limits.files)
      return lost(Code("W6004"), "the model names too many files");
    NamedFile found = document_.find_named(*uri, at, false);
    if (found.outcome != Files::Outcome::found) {
      document_.report(found.outside ? Code("W6005") : Code("W6004"), &json, at, found.problem,
                       found.outside ? kRootHint : "");
      return false;
    }
    owner = std::move(found.bytes);
    name = uri->text;
  }
  bytes = as_bytes(*owner);
  return true;
}

std::optional<image::DecodedImage> TextureReader::load(std::size_t image) {
  const Json& json = document_.root.list("images")[image];
  SharedText owner;
  std::span<const std::byte> bytes;
  if (!json.is(Json::Kind::object) || !bytes_of(image, json, names_[image], owner, bytes))
    return std::nullopt;
  image::DecodedImage decoded;
  const std::uint64_t left = document_.options.limits.texture_bytes - decoded_;
  std::string problem;
  if (is_webp(bytes)) {
    problem = decode_webp(bytes, left, decoded);
  } else {
    const image::ImageProblem found = image::decode_image(bytes, left, decoded);
    if (found.code) problem = found.message;
  }
  if (!problem.empty()) {
    document_.report(Code("W6004"), &json, pointer("images", image),
                     fmt::format("the image cannot be used: {}", problem));
    return std::nullopt;
  }
  decoded_ += decoded.rgba.size();
  return decoded;
}

const image::DecodedImage* TextureReader::texture(int index, std::size_t& image) {
  if (index < 0 || !document_.options.textures) return nullptr;
  const tinygltf::Texture& texture = model_.textures[static_cast<std::size_t>(index)];
  int source = texture.source;
  const auto webp = texture.extensions.find("EXT_texture_webp");
  if (webp != texture.extensions.end() && webp->second.Has("source"))
    source = webp->second.Get("source").GetNumberAsInt();
  if (source < 0) {
    const auto basis = texture.extensions.find("KHR_texture_basisu");
    if (basis == texture.extensions.end() || !basis->second.Has("source")) return nullptr;
    source = basis->second.Get("source").GetNumberAsInt();
  }
  image = static_cast<std::size_t>(source);
  const auto known = images_.find(image);
  if (known == images_.end()) images_[image] = load(image);
  const std::optional<image::DecodedImage>& found = images_[image];
  return found ? &*found : nullptr;
}

const image::DecodedImage* TextureReader::texture(int index) {
  std::size_t image = 0;
  return texture(index, image);
}

std::string TextureReader::name_of(int index) {
  std::size_t image = 0;
  return texture(index, image) ? names_[image] : std::string();
}

std::int32_t TextureReader::texture(int index, TextureUse use) {
  std::size_t image = 0;
  const image::DecodedImage* found = texture(index, image);
  if (!found) return scene::kNone;
  const auto [place, is_new] =
      textures_.try_emplace({image, use}, static_cast<std::int32_t>(scene_.textures.size()));
  if (!is_new) return place->second;
  scene::Texture texture{names_[image], found->width, found->height, found->rgba,
                         use != TextureUse::color};
  if (use == TextureUse::roughness) {
    // green is a perceptual roughness: its square is the slope; ours stands in red
    for (std::size_t i = 0; i < texture.rgba.size(); i += 4) {
      const unsigned green = texture.rgba[i + 1];
      texture.rgba[i] = static_cast<std::uint8_t>((green * green + 127) / 255);
    }
    texture.name += ".roughness";
  }
  scene_.textures.push_back(std::move(texture));
  return place->second;
}

Vec4 TextureReader::mean(int index, bool srgb) {
  std::size_t image = 0;
  const image::DecodedImage* found = texture(index, image);
  if (!found || found->rgba.empty()) return Vec4(1);
  const auto [place, is_new] = means_.try_emplace({image, srgb}, Vec4(1));
  if (!is_new) return place->second;
  // 256 levels: exact counts, and one decoding for each
  std::array<std::array<std::uint64_t, 256>, 4> counts{};
  for (std::size_t i = 0; i < found->rgba.size(); ++i) ++counts[i % 4][found->rgba[i]];
  Vec4 sum(0);
  for (int k = 0; k < 4; ++k)
    for (std::size_t level = 0; level < 256; ++level) {
      const double value = static_cast<double>(level) / 255;
      sum[k] += static_cast<double>(counts[static_cast<std::size_t>(k)][level]) *
                (srgb && k < 3 ? image::linear_from_srgb(value) : value);
    }
  return place->second = sum / static_cast<double>(found->rgba.size() / 4);
}

bool TextureReader::is_even(int index, int channel) {
  std::size_t image = 0;
  const image::DecodedImage* found = texture(index, image);
  if (!found || found->rgba.empty()) return true;
  const auto [place, is_new] = even_.try_emplace({image, channel}, true);
  const auto first = static_cast<std::size_t>(channel);
  for (std::size_t i = first; is_new && place->second && i < found->rgba.size(); i += 4)
    place->second = found->rgba[i] == found->rgba[first];
  return place->second;
}

std::array<bool, 2> TextureReader::repeats(int index) const {
  const int sampler = model_.textures[static_cast<std::size_t>(index)].sampler;
  if (sampler < 0) return {true, true};
  const tinygltf::Sampler& found = model_.samplers[static_cast<std::size_t>(sampler)];
  return {found.wrapS == TINYGLTF_TEXTURE_WRAP_REPEAT, found.wrapT == TINYGLTF_TEXTURE_WRAP_REPEAT};
}

bool TextureReader::has_room(std::span<const image::BakeSource> sources,
                             std::size_t textures) const {
  const std::uint64_t size =
      std::uint64_t{4} * image::baked_width(sources) * image::baked_height(sources) * textures;
  return size > 0 && size <= document_.options.limits.texture_bytes - decoded_;
}

std::int32_t TextureReader::add(int index, const char* what, image::Baked& baked,
                                std::size_t texture, bool linear) {
  std::vector<std::uint8_t>& rgba = baked.textures[texture];
  decoded_ += rgba.size();
  scene_.textures.push_back(
      {name_of(index) + what, baked.width, baked.height, std::move(rgba), linear});
  return static_cast<std::int32_t>(scene_.textures.size() - 1);
}

std::optional<RecipeTextures> TextureReader::metal(const MetalRecipe& recipe) {
  const int base = recipe.base, metal = recipe.metal;
  const Vec3 factor = recipe.factor, dielectric = recipe.dielectric;
  const double metallic = recipe.metallic;
  const image::DecodedImage* color = texture(base);
  const image::DecodedImage* part = texture(metal);
  if ((base >= 0 && !color) || (metal >= 0 && !part)) return std::nullopt;
  // a metal and nothing else: its colour as it is
  if (!part && metallic == 1 && factor == Vec3(1))
    return RecipeTextures{scene::kNone, texture(base, TextureUse::color), scene::kNone};
  const auto [place, is_new] =
      made_.try_emplace({0.0, static_cast<double>(base), static_cast<double>(metal), factor.x,
                         factor.y, factor.z, metallic, dielectric.x, dielectric.y, dielectric.z});
  if (!is_new) return place->second;
  const image::BakeSource sources[] = {source_of(color, true), source_of(part, false)};
  // where all is equally metal, the colour's own texture is the albedo
  const bool two = part != nullptr;
  if (!has_room(sources, two ? 2 : 1)) return std::nullopt;
  constexpr bool kColors[] = {true, true};
  image::Baked made =
      image::baked(sources, std::span(kColors, two ? 2 : 1),
                   [&](std::span<const Vec4> from, std::span<Vec4> to) {
                     const double share = metallic * from[1].z;
                     to[0] = Vec4(glm::mix(dielectric, factor * Vec3(from[0]), share), from[0].w);
                     if (two) to[1] = Vec4(Vec3(from[0]) * (1 - share), from[0].w);
                   });
  RecipeTextures out;
  const int named = color ? base : metal;
  out.reflectance = add(named, ".reflectance", made, 0, false);
  if (two)
    out.albedo = add(named, ".albedo", made, 1, false);
  else if (metallic < 1)
    out.albedo = texture(base, TextureUse::color);
  return place->second = out;
}

std::optional<RecipeTextures> TextureReader::gloss(const GlossRecipe& recipe) {
  const int diffuse = recipe.diffuse, specular = recipe.specular;
  const Vec3 factor = recipe.factor;
  const double glossiness = recipe.glossiness;
  const image::DecodedImage* color = texture(diffuse);
  const image::DecodedImage* shine = texture(specular);
  if ((diffuse >= 0 && !color) || !shine) return std::nullopt;
  const auto [place, is_new] =
      made_.try_emplace({1.0, static_cast<double>(diffuse), static_cast<double>(specular), factor.x,
                         factor.y, factor.z, glossiness});
  if (!is_new) return place->second;
  const image::BakeSource sources[] = {source_of(color, true), source_of(shine, true)};
  if (!has_room(sources, 3)) return std::nullopt;
  constexpr bool kColors[] = {true, true, false};
  image::Baked made =
      image::baked(sources, kColors, [&](std::span<const Vec4> from, std::span<Vec4> to) {
        const Vec3 f0 = factor * Vec3(from[1]);
        const double left = 1 - std::max({f0.x, f0.y, f0.z});
        const double rough = 1 - glossiness * from[1].w;
        to[0] = Vec4(f0, from[0].w);
        to[1] = Vec4(Vec3(from[0]) * left, from[0].w);
        to[2] = Vec4(Vec3(rough * rough), 1);
      });
  RecipeTextures out;
  out.reflectance = add(specular, ".reflectance", made, 0, false);
  out.albedo = add(color ? diffuse : specular, ".albedo", made, 1, false);
  out.roughness = add(specular, ".roughness", made, 2, true);
  return place->second = out;
}

std::optional<std::int32_t> TextureReader::normals(int index, double scale) {
  const image::DecodedImage* image = texture(index);
  if (!image) return std::nullopt;
  const auto [place, is_new] = made_.try_emplace({2.0, static_cast<double>(index), scale});
  if (!is_new) return place->second ? std::optional(place->second->albedo) : std::nullopt;
  const image::BakeSource sources[] = {source_of(image, false)};
  if (!has_room(sources, 1)) return std::nullopt;
  constexpr bool kNumbers[] = {false};
  image::Baked made =
      image::baked(sources, kNumbers, [&](std::span<const Vec4> from, std::span<Vec4> to) {
        Vec3 normal = Vec3(from[0]) * 2.0 - Vec3(1);
        normal.x *= scale;
        normal.y *= scale;
        const double length = std::sqrt(glm::dot(normal, normal));
        if (length > 1e-6) normal /= length;
        to[0] = Vec4(normal * 0.5 + Vec3(0.5), 1);
      });
  RecipeTextures out;
  out.albedo = add(index, ".normals", made, 0, true);
  place->second = out;
  return out.albedo;
}

std::optional<std::int32_t> TextureReader::below_coat(int index, const Vec3& factor,
                                                      const materials::DiffuseCurve& curve) {
  const image::DecodedImage* image = texture(index);
  if (!image) return std::nullopt;
  const auto [place, is_new] =
      made_.try_emplace({3.0, static_cast<double>(index), factor.x, factor.y, factor.z,
                         curve.gain.x, curve.gain.y, curve.gain.z, curve.back.x});
  if (!is_new) return place->second ? std::optional(place->second->albedo) : std::nullopt;
  const image::BakeSource sources[] = {source_of(image, true)};
  if (!has_room(sources, 1)) return std::nullopt;
  constexpr bool kColors[] = {true};
  image::Baked made =
      image::baked(sources, kColors, [&](std::span<const Vec4> from, std::span<Vec4> to) {
        to[0] = Vec4(curve.inverse(factor * Vec3(from[0])), from[0].w);
      });
  RecipeTextures out;
  out.albedo = add(index, ".albedo", made, 0, false);
  place->second = out;
  return out.albedo;
}

Vec4 TextureReader::mean_of(std::int32_t texture) const {
  const scene::Texture& found = scene_.textures[static_cast<std::size_t>(texture)];
  std::array<std::array<std::uint64_t, 256>, 4> levels{};
  for (std::size_t i = 0; i < found.rgba.size(); ++i) ++levels[i % 4][found.rgba[i]];
  Vec4 sum(0);
  for (int k = 0; k < 4; ++k)
    for (std::size_t level = 0; level < 256; ++level) {
      const auto code = static_cast<std::uint8_t>(level);
      const auto count = levels[static_cast<std::size_t>(k)][level];
      sum[k] +=
          static_cast<double>(count) *
          (k < 3 && !found.linear ? image::srgb_decoded(code) : static_cast<double>(level) / 255);
    }
  return sum / static_cast<double>(std::max<std::size_t>(found.rgba.size() / 4, 1));
}

}  // namespace panwright::importers::gltf
