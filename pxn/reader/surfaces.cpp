#include "pxn/reader/surfaces.h"

#include <fmt/core.h>

#include "base/text.h"
#include "materials/kept_fits.h"
#include "mli/preset.h"
#include "pxn/reader/presets.h"

namespace panwright::pxn {

Surface Surfaces::named(std::int32_t index) const {
  const NamedMaterial& material = loader_.material(index);
  return {material.fields, material.name, material.back, material.place};
}

std::int32_t Surfaces::material(const Surface& surface) {
  const auto [known, added] =
      by_fields_.emplace(std::pair(surface.name, key_of(surface.fields)), 0);
  if (!added) return known->second;
  materials::Material material =
      materials::resolved(surface.fields, surface.place, reporter_.log(), options_.cache);
  const auto next = static_cast<std::int32_t>(scene_.materials.size());
  const auto [same, is_new] = by_value_.emplace(std::pair(surface.name, key_of(material)), next);
  known->second = same->second;
  if (is_new) {
    material.name = !surface.name.empty()           ? surface.name
                    : surface.place.file == kNoFile ? "default"
                                                    : fmt::format("material{}", ++unnamed_);
    scene_.materials.push_back(std::move(material));
  }
  return same->second;
}

Surface Surfaces::library(std::string_view name) {
  Surface surface;
  surface.name = name;
  surface.fields = find_preset(name)->fields;
  return surface;
}

std::int32_t Surfaces::usual_material(std::string_view foil_preset) {
  for (const mli::Preset& known : mli::presets())
    if (known.name == foil_preset) return material(library(known.material));
  return material({});
}

std::int32_t Surfaces::cad_material(std::uint32_t model_index, const ImportedModel& model,
                                    std::int32_t index) {
  const auto [known, added] = cad_materials_.emplace(std::pair(model_index, index), 0);
  if (!added) return known->second;
  known->second = static_cast<std::int32_t>(scene_.materials.size());
  materials::Material copy = model.imported.scene.materials[static_cast<std::size_t>(index)];
  for (std::int32_t* map : {&copy.maps.albedo, &copy.maps.normal, &copy.maps.roughness,
                            &copy.maps.reflectance, &copy.maps.cutout})
    if (*map >= 0) *map = model.textures[static_cast<std::size_t>(*map)];
  scene_.materials.push_back(std::move(copy));
  return known->second;
}

std::int32_t Surfaces::back_of(const geometry::Shape* shape, std::int32_t front,
                               const BackMaterial& back, const std::function<SourceSpan()>& where) {
  if (back.named < 0 && back.library.empty()) return scene::kNone;
  const materials::Material outside = scene_.materials[static_cast<std::size_t>(front)];
  const bool has_holes = outside.maps.cutout >= 0;
  if (shape && !has_holes && geometry::is_closed(*shape)) return scene::kNone;
  Surface inside = back.named >= 0 ? named(back.named) : library(back.library);
  materials::Maps maps = inside.fields.maps.value_or(materials::Maps{});
  if (has_holes && maps.cutout < 0 && (!maps.any() || maps.repeat == outside.maps.repeat)) {
    maps.cutout = outside.maps.cutout;
    maps.threshold = outside.maps.threshold;
    maps.repeat = outside.maps.repeat;
    inside.fields.maps = maps;
  }
  const std::int32_t index = material(inside);
  if (index == front) return scene::kNone;
  const materials::Material& made = scene_.materials[static_cast<std::size_t>(index)];
  if (scene::same_holes(outside, made)) return index;
  if (unlike_.emplace(front, index).second)
    reporter_.log().report(Code("W1410"), where(),
                           fmt::format("the holes of {} are not those of its back {}; the back "
                                       "looks as the front does",
                                       in_quotes(outside.name), in_quotes(made.name)),
                           "leave out <cutout> of the back, which then has the holes of the front");
  return scene::kNone;
}

}  // namespace panwright::pxn
