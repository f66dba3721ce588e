#include <fmt/core.h>

#include <array>
#include <cmath>

#include "base/text.h"
#include "terrain/internal/found.h"

namespace panwright::terrain {

namespace {

// Content of the first KEYWORD[…] or KEYWORD(…), brackets matched; empty: none.
std::string_view content_of(std::string_view text, std::string_view keyword) {
  for (std::size_t at = text.find(keyword); at != text.npos; at = text.find(keyword, at + 1)) {
    const std::size_t open = at + keyword.size();
    if (open >= text.size() || (text[open] != '[' && text[open] != '(')) continue;
    if (at > 0 && text[at - 1] >= 'A' && text[at - 1] <= 'Z') continue;
    int depth = 0;
    for (std::size_t i = open; i < text.size(); ++i) {
      if (text[i] == '[' || text[i] == '(') ++depth;
      if ((text[i] == ']' || text[i] == ')') && --depth == 0)
        return text.substr(open + 1, i - open - 1);
    }
    return text.substr(open + 1);
  }
  return {};
}

// n-th part between commas outside quotes and brackets, without quotes and blanks.
std::string part_of(std::string_view text, std::size_t n) {
  std::size_t begin = 0;
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    const char c = i < text.size() ? text[i] : ',';
    if (c == '"') quoted = !quoted;
    if (!quoted && (c == '[' || c == '(')) ++depth;
    if (!quoted && (c == ']' || c == ')')) --depth;
    if (i < text.size() && (quoted || depth > 0 || c != ',')) continue;
    if (n-- == 0) {
      std::string out(text.substr(begin, i - begin));
      std::erase_if(out, [](char each) { return each == '"' || each == '\n'; });
      while (!out.empty() && out.front() == ' ') out.erase(out.begin());
      while (!out.empty() && out.back() == ' ') out.pop_back();
      return out;
    }
    begin = i + 1;
  }
  return {};
}

std::optional<double> number_at(std::string_view text, std::size_t n) {
  return parse_double(part_of(text, n));
}

// Names differ in blanks, underscores and letter case.
std::string plain_name(std::string_view name) {
  std::string out = upper_case(name);
  std::erase_if(out, [](char c) { return c == ' ' || c == '_'; });
  return out;
}

void read_parameters(std::string_view text, Map& map, WktPlace& place) {
  std::string_view rest = text;
  for (std::size_t at = rest.find("PARAMETER"); at != rest.npos; at = rest.find("PARAMETER")) {
    rest.remove_prefix(at);
    const std::string_view inside = content_of(rest, "PARAMETER");
    const std::string name = plain_name(part_of(inside, 0));
    const double value = number_at(inside, 1).value_or(0);
    if (name == "CENTRALMERIDIAN" || name == "LONGITUDEOFCENTER" ||
        name == "LONGITUDEOFNATURALORIGIN" || name == "STRAIGHTVERTICALLONGITUDEFROMPOLE" ||
        name == "LONGITUDEOFORIGIN")
      map.center_longitude = value;
    if (name == "STANDARDPARALLEL1" || name == "LATITUDEOFSTANDARDPARALLEL" ||
        name == "LATITUDEOF1STSTANDARDPARALLEL")
      map.standard_latitude = value;
    if (map.kind == Map::Kind::polar &&
        (name == "LATITUDEOFORIGIN" || name == "LATITUDEOFNATURALORIGIN")) {
      map.standard_latitude = value;
      map.north = value > 0;
    }
    if (name == "FALSEEASTING") place.false_easting = value;
    if (name == "FALSENORTHING") place.false_northing = value;
    rest.remove_prefix(9);
  }
}

}  // namespace

WktPlace read_wkt(std::string_view text, DemInfo& info) {
  WktPlace place;
  Map& map = info.map;
  std::string_view sphere = content_of(text, "SPHEROID");
  if (sphere.empty()) sphere = content_of(text, "ELLIPSOID");
  if (const auto radius = number_at(sphere, 1); radius && *radius > 0) {
    const double inverse = number_at(sphere, 2).value_or(0);
    map.radius = place.radius = *radius;
    map.polar_radius = inverse > 1 ? *radius * (1 - 1 / inverse) : *radius;
  }
  for (const char* keyword : {"GEOGCS", "GEOGCRS", "BASEGEOGCRS", "DATUM", "SPHEROID", "ELLIPSOID"})
    place.names += part_of(content_of(text, keyword), 0) + ' ';
  std::string method = part_of(content_of(text, "PROJECTION"), 0);
  if (method.empty()) method = part_of(content_of(text, "METHOD"), 0);
  const std::string name = plain_name(method);
  if (!method.empty()) info.projection = method;
  if (name.starts_with("EQUIRECTANGULAR") || name.starts_with("EQUIDISTANTCYLINDRICAL") ||
      name == "PLATECARREE" || name == "SIMPLECYLINDRICAL") {
    map.kind = Map::Kind::cylindrical;
  } else if (name.starts_with("POLARSTEREOGRAPHIC") || name == "STEREOGRAPHICNORTHPOLE" ||
             name == "STEREOGRAPHICSOUTHPOLE") {
    map.kind = Map::Kind::polar;
    map.north = name != "STEREOGRAPHICSOUTHPOLE";
    map.standard_latitude = map.north ? 90 : -90;
  } else if (method.empty() &&
             (!content_of(text, "GEOGCS").empty() || !content_of(text, "GEOGCRS").empty())) {
    place.degrees = true;
    if (info.projection.empty()) info.projection = "longitude and latitude";
  }
  read_parameters(text, map, place);
  if (map.kind == Map::Kind::polar && map.standard_latitude != 0)
    map.north = map.standard_latitude > 0;
  // the last unit is that of the map
  if (!place.degrees)
    if (const std::size_t at = text.rfind("UNIT"); at != text.npos)
      if (const auto unit = number_at(content_of(text.substr(at), "UNIT"), 1); unit && *unit >= 0.1)
        place.metres = *unit;
  return place;
}

void use_local_radius(const Opening& o, Map& m) {
  if (m.kind != Map::Kind::cylindrical || m.polar_radius == m.radius || m.standard_latitude == 0)
    return;
  const auto [s, c] = det::sincos(m.standard_latitude * kDegree);
  const double local =
      m.radius * m.polar_radius /
      std::sqrt(m.polar_radius * m.polar_radius * c * c + m.radius * m.radius * s * s);
  const double scale = m.radius / local;
  m.left *= scale;
  m.top *= scale;
  m.dx *= scale;
  m.dy *= scale;
  o.note(
      fmt::format("the map's metres are those of the ellipsoid's radius at latitude {}, {:.1f} m: "
                  "they are scaled by {:.7f}",
                  m.standard_latitude, local, scale));
}

void place_in_degrees(DemInfo& info, double west, double north, double dx, double dy) {
  Map& m = info.map;
  m.kind = Map::Kind::cylindrical;
  m.center_longitude = m.standard_latitude = 0;
  const double metres = m.radius * kDegree;
  m.left = west * metres;
  m.top = north * metres;
  m.dx = dx * metres;
  m.dy = dy * metres;
  if (west + dx * info.width > 180 + dx / 2) m.domain = 360;
}

}  // namespace panwright::terrain
