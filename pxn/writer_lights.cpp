#include "pxn/text/writer_lights.h"

#include <cstddef>
#include <iterator>
#include <string_view>

namespace panwright::pxn {

namespace {

struct Member {
  std::string_view setting, attribute;
};
constexpr Member kSunMembers[] = {{"sun", "direction"},
                                  {"sun-distance", "distance"},
                                  {"sun-irradiance", "irradiance"},
                                  {"limb-darkening", "limb_darkening"},
                                  {"sky", "visible"}};
constexpr Member kStarMembers[] = {{"stars", "to"}, {"star-catalogue", "catalogue"}};

const std::string* value_of(const std::vector<scene::Setting>& settings, std::string_view name) {
  for (const scene::Setting& setting : settings)
    if (setting.name == name) return &setting.value;
  return nullptr;
}

template <std::size_t N>
void write_members(std::string_view tag, const Member (&members)[N],
                   const std::vector<scene::Setting>& settings, ElementWriter& out) {
  bool open = false;
  for (const Member& member : members) {
    const std::string* const value = value_of(settings, member.setting);
    if (value == nullptr) continue;
    if (!open) out.open(tag);
    open = true;
    out.attribute(member.attribute, member.setting == "sky" ? "on" : std::string_view(*value));
  }
  if (open) out.close(tag);
}

// "NAME=[X Y Z [QW QX QY QZ]] [radius=…] [albedo=…] [law=…] [air=…] [map=…] [clouds=…] [night=…]"
void write_planet(std::string_view text, ElementWriter& out) {
  const auto cut = [&](std::string_view mark) {
    const std::size_t at = text.find(mark);
    const std::string_view value =
        at == text.npos ? std::string_view() : text.substr(at + mark.size());
    text = text.substr(0, at);
    return value;
  };
  const std::size_t equals = text.find('=');
  const std::string_view name = text.substr(0, equals);
  text.remove_prefix(equals + 1);
  const std::string_view night = cut(" night="), clouds = cut(" clouds="), map = cut(" map="),
                         air = cut(" air="), law = cut(" law="), albedo = cut(" albedo="),
                         radius = cut(" radius=");
  std::size_t third = text.npos;  // the space behind the third number
  for (std::size_t at = 0, count = 0; at < text.size() && count < 3; ++at)
    if (text[at] == ' ' && ++count == 3) third = at;
  out.open("planet");
  out.attribute("body", name);
  if (!text.empty()) out.attribute("at", text.substr(0, third));
  if (third != text.npos) out.attribute("quat", text.substr(third + 1));
  const auto part = [&](std::string_view attribute, std::string_view value) {
    if (!value.empty()) out.attribute(attribute, value);
  };
  part("radius", radius);
  part("albedo", albedo);
  part("law", law);
  part("air", air);
  part("map", map);
  part("clouds", clouds);
  part("night", night);
  out.close("planet");
}

}  // namespace

void write_lamp(const scene::Lamp& lamp, const std::string& name, ElementWriter& out) {
  using Kind = scene::Lamp::Kind;
  out.open("lamp");
  out.attribute("name", name);
  out.attribute("type", lamp.kind == Kind::spot    ? "spot"
                        : lamp.kind == Kind::point ? "point"
                                                   : "disc");
  if (lamp.position != Vec3(0)) out.attribute("at", lamp.position);
  if (lamp.kind != Kind::point && lamp.axis != Vec3(0, 0, 1)) out.attribute("direction", lamp.axis);
  out.attribute("intensity", lamp.intensity);
  if (lamp.kind == Kind::spot) {
    out.attribute("half_angle", lamp.half_angle);
    if (lamp.exponent != 0) out.attribute("exponent", lamp.exponent);
  }
  if (lamp.radius != 0) out.attribute("radius", lamp.radius);
  if (lamp.pulse) out.numbers("pulse", std::span(&lamp.pulse->x, 2));
  if (!lamp.on) out.attribute("state", "off");
  out.close("lamp");
}

void write_settings(const std::vector<scene::Setting>& settings, ElementWriter& out) {
  if (settings.empty()) return;
  out.open("scene");
  if (const std::string* const date = value_of(settings, "date")) out.attribute("date", *date);
  if (const std::string* const orbit = value_of(settings, "orbit")) out.attribute("orbit", *orbit);
  write_members("sun", kSunMembers, settings, out);
  for (const scene::Setting& setting : settings)
    if (setting.name == "planet") write_planet(setting.value, out);
  write_members("stars", kStarMembers, settings, out);
  out.close("scene");
}

}  // namespace panwright::pxn
