// Textures: textures, maps of materials, decals.

#include <fmt/core.h>

#include "base/file.h"
#include "base/text.h"
#include "image/decode.h"
#include "pxn/reader/loader.h"

namespace panwright::pxn {

namespace attribute = schemas::attribute;
using schemas::ElementId;

namespace {

// Makes alpha of brightness, where a texture has no alpha.
void alpha_from_brightness(image::DecodedImage& image) {
  for (std::size_t i = 3; i < image.rgba.size(); i += 4)
    if (image.rgba[i] != 255) return;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4)
    image.rgba[i + 3] =
        static_cast<std::uint8_t>((image.rgba[i] + image.rgba[i + 1] + image.rgba[i + 2] + 1) / 3);
}

}  // namespace

std::optional<std::uint32_t> Loader::read_sphere_texture(Work& work, std::uint32_t element) {
  const xml::Document& document = work.file.document;
  Values& values = *work.file.values;
  const auto type = values.text(element, attribute::texture_type);
  const std::uint32_t data = child_of(document, element, ElementId::data);
  const std::uint32_t include = data == 0 ? 0 : child_of(document, data, ElementId::include_raw);
  if (include == 0) return std::nullopt;
  const auto raw = values.text(include, attribute::include_raw_type);
  if (!type || !raw) return std::nullopt;
  return texture_of(work, include, attribute::include_raw_file, TextureKind::color);
}

std::optional<std::uint32_t> Loader::texture_of(Work& work, std::uint32_t element,
                                                std::size_t attribute, TextureKind use) {
  const auto file = work.file.values->text(element, attribute);
  if (!file) return std::nullopt;
  const auto found = find(work, element, attribute, *file);
  if (!found) return std::nullopt;
  const std::pair key(found->key, use);
  const auto known = known_textures_.find(key);
  if (known != known_textures_.end()) return known->second;
  return known_textures_[key] = load_texture(work, element, attribute, *file, *found, use);
}

std::optional<std::uint32_t> Loader::load_texture(Work& work, std::uint32_t element,
                                                  std::size_t attribute, const std::string& file,
                                                  const FoundFile& found, TextureKind use) {
  const SourceSpan where = work.file.values->value_place(element, attribute);
  const auto bytes = files_.load(found, where, reporter_.log());
  if (!bytes) return std::nullopt;
  add_input(found, as_bytes(**bytes));
  const std::uint64_t left = options_.limits.texture_bytes - texture_bytes_;
  image::DecodedImage image;
  const image::ImageProblem problem = image::decode_image(as_bytes(**bytes), left, image);
  if (problem.code) {
    reporter_.report(*problem.code, where, work.file.document, element, [&] {
      return Reporter::Text(fmt::format("{}: {}", in_quotes(file), problem.message));
    });
    return std::nullopt;
  }
  texture_bytes_ += image.rgba.size();
  if (use == TextureKind::cutout) alpha_from_brightness(image);
  scene_.textures.push_back(
      {file, image.width, image.height, std::move(image.rgba), use == TextureKind::linear});
  return static_cast<std::uint32_t>(scene_.textures.size() - 1);
}

materials::Maps Loader::read_maps(Work& work, std::uint32_t element, const materials::Maps& base) {
  const xml::Document& document = work.file.document;
  Values& values = *work.file.values;
  materials::Maps maps = base;
  const auto read = [&](std::uint32_t holder, std::size_t which, TextureKind use,
                        std::int32_t& map) {
    if (!values.has(holder, which)) return;
    if (const auto index = texture_of(work, holder, which, use))
      map = static_cast<std::int32_t>(*index);
  };
  read(element, attribute::named_material_albedo_map, TextureKind::color, maps.albedo);
  read(element, attribute::named_material_normal_map, TextureKind::linear, maps.normal);
  if (maps.normal >= 0 && values.has(element, attribute::named_material_normal_map))
    if (const auto problem =
            image::normal_map_problem(scene_.textures[static_cast<std::size_t>(maps.normal)].rgba))
      reporter_.report(
          Code("W3003"), values.value_place(element, attribute::named_material_normal_map),
          document, element, [&] {
            return Reporter::Text(fmt::format(
                "{}: {}", in_quotes(scene_.textures[static_cast<std::size_t>(maps.normal)].name),
                *problem));
          });
  read(element, attribute::named_material_roughness_map, TextureKind::linear, maps.roughness);
  read(element, attribute::named_material_reflectance_map, TextureKind::color, maps.reflectance);
  values.numbers(element, attribute::named_material_map_repeat, std::span(&maps.repeat.x, 2));
  if (const std::uint32_t cutout = child_of(document, element, ElementId::cutout)) {
    read(cutout, attribute::cutout_image, TextureKind::cutout, maps.cutout);
    maps.threshold =
        values.real(cutout, attribute::cutout_threshold).value_or(materials::Maps{}.threshold);
  }
  return maps;
}

void Loader::read_decal(Work& work, std::uint32_t element) {
  Values& values = *work.file.values;
  PartDecal part_decal;
  scene::Decal& decal = part_decal.decal;
  const auto on = values.text(element, attribute::decal_on);
  const auto texture = texture_of(work, element, attribute::decal_image, TextureKind::color);
  const bool placed = values.numbers(element, attribute::decal_at, std::span(&decal.at.x, 3));
  double size[2] = {0, 0};
  const bool sized = values.numbers(element, attribute::decal_size, size);
  const auto direction = [&](std::size_t which, std::optional<Vec3>& out) {
    Vec3 v(0);
    if (!values.numbers(element, which, std::span(&v.x, 3))) return;
    if (v != Vec3(0)) {
      out = v;
      return;
    }
    reporter_.report(
        Code("E1202"), values.value_place(element, which), work.file.document, element,
        [&] { return Reporter::Text("a direction of length 0; expected any other length"); });
  };
  direction(attribute::decal_normal, decal.normal);
  direction(attribute::decal_up, decal.up);
  if (values.has(element, attribute::decal_name))
    decal.name = values.text(element, attribute::decal_name).value_or("");
  if (!on) return;
  part_decal.on = *on;
  part_decal.run = work.run;
  // one that is wrong stays, so that what it names is looked for
  const bool sound = texture && placed && sized;
  decal.texture = sound ? static_cast<std::int32_t>(*texture) : scene::kNone;
  decal.width = size[0];
  decal.height = size[1];
  work.part.decals.push_back(std::move(part_decal));
  add_item(work, ItemKind::decal, element, static_cast<std::uint32_t>(work.part.decals.size() - 1));
}

}  // namespace panwright::pxn
