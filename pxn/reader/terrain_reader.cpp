// The terrain of the top file.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "pxn/reader/loader.h"

namespace panwright::pxn {

namespace attribute = schemas::attribute;
using schemas::ElementId;

void Loader::read_terrain(File& file, std::uint32_t element) {
  const xml::Document& document = file.document;
  const auto leave_out = [&](Code code, const char* why) {
    reporter_.report(code, document.tag_span(element), document, element,
                     [&] { return Reporter::Text(why); });
  };
  if (file.level != 0)
    return leave_out(Code("N1314"),
                     "the terrain of an included file is not used; the top file's holds");
  if (options_.terrain == nullptr)
    return leave_out(Code("W9620"), "terrain is left out: compile and render make it");
  Part no_part;
  Work work{file, no_part, &file.scope};
  const auto source = [&](std::uint32_t at) {
    return scene::Source{file.found.path, file.positions[at].first, file.positions[at].second};
  };
  TerrainText out;
  out.source = source(element);
  out.error = file.values->real_or_default(element, attribute::terrain_error);
  const std::uint32_t end = document.elements[element].next;
  for (std::uint32_t c = element + 1; c < end; c = document.elements[c].next) {
    if (document.elements[c].id == ElementId::albedo) {
      if (auto albedo = read_albedo(work, c)) {
        albedo->source = source(c);
        out.albedo.push_back(*std::move(albedo));
      }
      continue;
    }
    if (document.elements[c].id != ElementId::dem) continue;
    auto dem = read_dem(work, c);
    if (!dem) continue;  // reported
    dem->source = source(c);
    out.dems.push_back(*std::move(dem));
  }
  out.material = ground_material(file, element);
  *options_.terrain = std::move(out);
}

std::optional<materials::Material> Loader::ground_material(File& file, std::uint32_t element) {
  if (!file.values->has(element, attribute::terrain_material)) return std::nullopt;
  Definition* const found =
      look_up(file, element, attribute::terrain_material, file.materials, "material");
  const auto index = found == nullptr ? std::nullopt : material_of(*found);
  if (!index) return std::nullopt;
  const NamedMaterial& named = materials_[*index];
  materials::Material material = materials::resolved(named.fields, named.place, reporter_.log());
  material.name = named.name;
  if (material.maps.any() || material.cells) {
    reporter_.report(Code("N1405"), file.values->value_place(element, attribute::terrain_material),
                     file.document, element, [] {
                       return Reporter::Text(
                           "terrain has no texture coordinates: maps and cells of its material "
                           "are left out",
                           "<albedo> is a map of the ground");
                     });
    material.maps = {};
    material.cells.reset();
    materials::fit(material);
  }
  return material;
}

std::optional<AlbedoText> Loader::read_albedo(Work& work, std::uint32_t element) {
  Values& values = *work.file.values;
  const std::size_t before = reporter_.log().errors();
  AlbedoText out;
  const auto path = values.text(element, attribute::albedo_file);
  const auto found = path ? find(work, element, attribute::albedo_file, *path) : std::nullopt;
  if (!found) return std::nullopt;
  out.file = found->path;
  std::array<double, 3> three{};
  if (values.numbers(element, attribute::albedo_bands, three) &&
      !whole(work, element, attribute::albedo_bands, "bands", three, out.bands))
    return std::nullopt;
  out.scale = values.real_or_default(element, attribute::albedo_scale);
  if (values.numbers(element, attribute::albedo_reflectance, three)) out.reflectance = three;
  out.radius = values.real(element, attribute::albedo_radius);
  out.spacing = values.real(element, attribute::albedo_spacing);
  out.no_value = values.real(element, attribute::albedo_void);
  if (reporter_.log().errors() > before) return std::nullopt;
  return out;
}

bool Loader::whole(Work& work, std::uint32_t element, std::size_t attribute, const char* what,
                   std::span<const double> numbers, std::span<std::uint32_t> out) {
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    out[k] = static_cast<std::uint32_t>(numbers[k]);
    if (numbers[k] == std::floor(numbers[k])) continue;
    reporter_.report(
        Code("E1202"), work.file.values->value_place(element, attribute), work.file.document,
        element, [&] {
          return Reporter::Text(fmt::format("{} are whole numbers, found {}", what, numbers[k]));
        });
    return false;
  }
  return true;
}

std::optional<DemText> Loader::read_dem(Work& work, std::uint32_t element) {
  Values& values = *work.file.values;
  const std::size_t before = reporter_.log().errors();
  DemText out;
  const auto path = values.text(element, attribute::dem_file);
  const auto found = path ? find(work, element, attribute::dem_file, *path) : std::nullopt;
  if (!found) return std::nullopt;
  out.file = found->path;
  if (values.has(element, attribute::dem_unit))
    if (const auto unit = values.text(element, attribute::dem_unit))
      out.unit = *unit == "km" ? 1000 : 1;
  if (values.has(element, attribute::dem_values))
    if (const auto meaning = values.text(element, attribute::dem_values))
      out.radii = *meaning == "radius";
  out.radius = values.real(element, attribute::dem_radius);
  out.spacing = values.real(element, attribute::dem_spacing);
  out.no_height = values.real(element, attribute::dem_void);
  std::array<double, 4> four{};
  if (values.numbers(element, attribute::dem_pixels, four)) {
    out.pixels.emplace();
    if (!whole(work, element, attribute::dem_pixels, "pixels", four, *out.pixels))
      return std::nullopt;
  }
  if (values.numbers(element, attribute::dem_bounds, four)) {
    out.bounds = four;
    if (!(four[0] < four[2] && four[1] < four[3])) {
      reporter_.report(Code("E1202"), values.value_place(element, attribute::dem_bounds),
                       work.file.document, element, [&] {
                         return Reporter::Text(
                             "bounds are south, west, north and east: the first two must be below "
                             "the others");
                       });
      return std::nullopt;
    }
  }
  out.reduce =
      static_cast<std::uint32_t>(values.integer_or_default(element, attribute::dem_reduce));
  out.raise = values.real_or_default(element, attribute::dem_raise);
  out.blend = values.real_or_default(element, attribute::dem_blend);
  if (reporter_.log().errors() > before) return std::nullopt;
  return out;
}

}  // namespace panwright::pxn
