// Lamps, and the scene of the top file.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "base/text.h"
#include "pxn/reader/loader.h"
#include "pxn/reader/shapes.h"

namespace panwright::pxn {

namespace attribute = schemas::attribute;
using schemas::ElementId;

namespace {

// What a lamp of its type has, and others have not; empty: all is well.
std::string lamp_problem(const Values& values, std::uint32_t element, std::string_view type,
                         double radius) {
  const bool spot = type == "spot";
  if (!spot && (values.has(element, attribute::lamp_half_angle) ||
                values.has(element, attribute::lamp_exponent)))
    return "has a half_angle or an exponent, which only a spot has";
  if (type == "point" && values.has(element, attribute::lamp_direction))
    return "is a point and has a direction: it lights all of them";
  if (type == "disc" && radius == 0) return "is a disc without a radius";
  return {};
}

std::string joined(std::span<const double> numbers) {
  return fmt::format("{}", fmt::join(numbers, " "));
}

}  // namespace

void Loader::read_lamp(Work& work, std::uint32_t element) {
  const xml::Document& document = work.file.document;
  Values& values = *work.file.values;
  const auto name = values.text(element, attribute::lamp_name);
  const auto type = values.text(element, attribute::lamp_type);
  bool good = true;
  const auto vector = [&](std::size_t which, Vec3& out) {
    const bool read = values.numbers(element, which, std::span(&out.x, 3));
    good = good && (read || !values.has(element, which));
    return read;
  };
  const auto real = [&](std::size_t which, double standard) {
    const auto value = values.real(element, which);
    good = good && (value || !values.has(element, which));
    return value.value_or(standard);
  };
  scene::Lamp lamp;
  vector(attribute::lamp_at, lamp.position);
  vector(attribute::lamp_direction, lamp.axis);
  const bool intense = vector(attribute::lamp_intensity, lamp.intensity);
  Vec3 power(0);
  vector(attribute::lamp_power, power);
  lamp.half_angle = real(attribute::lamp_half_angle, 30 * kDegree);
  lamp.exponent = real(attribute::lamp_exponent, 0);
  lamp.radius = real(attribute::lamp_radius, 0);
  Vec2 pulse(0);
  if (values.numbers(element, attribute::lamp_pulse, std::span(&pulse.x, 2))) lamp.pulse = pulse;
  good = good && (lamp.pulse || !values.has(element, attribute::lamp_pulse));
  lamp.on = values.text_or_default(element, attribute::lamp_state) != "off";
  const bool powered = values.has(element, attribute::lamp_power);
  if (!name || !type || !good || intense == powered) return;  // reported
  lamp.name = *name;
  std::string problem = lamp_problem(values, element, *type, lamp.radius);
  if (problem.empty() && lamp.pulse && !(lamp.pulse->x < lamp.pulse->y))
    problem = "has a pulse that does not end after its begin";
  const auto axis = unit_vector(lamp.axis);
  if (problem.empty() && !axis) problem = "has a direction of length 0";
  if (!problem.empty()) {
    reporter_.report(Code("E1108"), document.tag_span(element), document, element, [&] {
      return Reporter::Text(fmt::format("lamp {} {}", in_quotes(*name), problem));
    });
    return;
  }
  lamp.axis = *axis;
  using Kind = scene::Lamp::Kind;
  lamp.kind = *type == "point" ? Kind::point : *type == "disc" ? Kind::disc : Kind::spot;
  if (*type == "led") {
    lamp.half_angle = kPi / 2;
    lamp.exponent = 1;
  }
  if (!intense) lamp.intensity = power / scene::steradians(lamp);
  if (lamp.kind != Kind::spot) lamp.half_angle = lamp.exponent = 0;
  work.part.lamps.push_back(std::move(lamp));
  add_item(work, ItemKind::lamp, element, static_cast<std::uint32_t>(work.part.lamps.size() - 1));
}

void Loader::read_scene(File& file, std::uint32_t element) {
  const xml::Document& document = file.document;
  Values& values = *file.values;
  if (file.level != 0) {
    reporter_.report(Code("N1314"), document.tag_span(element), document, element, [&] {
      return Reporter::Text("the scene of an included file is not used; the top file's holds");
    });
    return;
  }
  Part no_part;
  Work work{file, no_part, &file.scope};
  const auto add = [&](std::uint32_t at, std::string_view name, std::string value) {
    const auto& [line, column] = file.positions[at];
    scene_.settings.push_back(
        {std::string(name), std::move(value), {file.found.path, line, column}});
  };
  // numbers of an attribute as settings take them; empty: there are none
  const auto numbers = [&](std::uint32_t at, std::size_t which, std::size_t count) -> std::string {
    std::array<double, 4> out{};
    const std::span<double> all = std::span(out).first(count);
    if (count == 1) {
      const auto value = values.real(at, which);
      return value ? fmt::format("{}", *value) : std::string();
    }
    return values.numbers(at, which, all) ? joined(all) : std::string();
  };
  const auto file_at = [&](std::uint32_t at, std::size_t which) -> std::string {
    const auto path = values.has(at, which) ? values.text(at, which) : std::nullopt;
    const auto found = path ? find(work, at, which, *path) : std::nullopt;
    return found ? found->path : std::string();
  };
  const auto given = [&](std::uint32_t at, std::string_view name, std::string value) {
    if (!value.empty()) add(at, name, std::move(value));
  };
  if (values.has(element, attribute::scene_date))
    given(element, "date", values.text(element, attribute::scene_date).value_or(""));
  if (values.has(element, attribute::scene_orbit))
    given(element, "orbit", values.text(element, attribute::scene_orbit).value_or(""));
  const std::uint32_t end = document.elements[element].next;
  for (std::uint32_t c = element + 1; c < end; c = document.elements[c].next) {
    if (document.elements[c].id == ElementId::sun) {
      given(c, "sun", numbers(c, attribute::sun_direction, 3));
      given(c, "sun-distance", numbers(c, attribute::sun_distance, 1));
      given(c, "sun-irradiance", numbers(c, attribute::sun_irradiance, 3));
      given(c, "limb-darkening", numbers(c, attribute::sun_limb_darkening, 1));
      if (values.text_or_default(c, attribute::sun_visible) == "on") add(c, "sky", "sun");
    } else if (document.elements[c].id == ElementId::planet) {
      const auto body = values.text(c, attribute::planet_body);
      std::string text = numbers(c, attribute::planet_at, 3);
      const bool placed = values.has(c, attribute::planet_at);
      if (!body || (placed && text.empty())) continue;  // reported
      const auto part = [&](std::string_view key, const std::string& value) {
        if (!value.empty()) text += fmt::format(" {}{}", key, value);
      };
      if (placed) part("", numbers(c, attribute::planet_quat, 4));
      part("radius=", numbers(c, attribute::planet_radius, 3));
      part("albedo=", numbers(c, attribute::planet_albedo, 3));
      if (values.has(c, attribute::planet_law))
        part("law=", values.text(c, attribute::planet_law).value_or(""));
      if (values.has(c, attribute::planet_air))
        part("air=", values.text(c, attribute::planet_air).value_or(""));
      part("map=", file_at(c, attribute::planet_map));
      part("clouds=", file_at(c, attribute::planet_clouds));
      part("night=", file_at(c, attribute::planet_night));
      add(c, "planet", *body + "=" + text);
    } else if (document.elements[c].id == ElementId::stars) {
      given(c, "stars", numbers(c, attribute::stars_to, 1));
      given(c, "star-catalogue", file_at(c, attribute::stars_catalogue));
    }
  }
}

}  // namespace panwright::pxn
