#include <fmt/core.h>

#include "base/text.h"
#include "terrain/internal/found.h"

namespace panwright::terrain {

namespace {

std::optional<SampleType> isis_sample_type(const std::string& name, bool big) {
  using K = SampleType::Kind;
  const struct {
    const char* name;
    K kind;
    unsigned bytes;
  } types[] = {{"UNSIGNEDBYTE", K::unsigned_integer, 1},
               {"SIGNEDBYTE", K::signed_integer, 1},
               {"UNSIGNEDWORD", K::unsigned_integer, 2},
               {"SIGNEDWORD", K::signed_integer, 2},
               {"UNSIGNEDINTEGER", K::unsigned_integer, 4},
               {"SIGNEDINTEGER", K::signed_integer, 4},
               {"REAL", K::real, 4},
               {"DOUBLE", K::real, 8}};
  for (const auto& type : types)
    if (name == type.name) return SampleType{type.kind, type.bytes, big};
  return std::nullopt;
}

void read_mapping(const Opening& o, const LabelItem& map, Found& found) {
  DemInfo& info = found.info;
  Map& m = info.map;
  info.projection = text_of(map, "PROJECTIONNAME");
  if (info.target.empty()) info.target = text_of(map, "TARGETNAME");
  m.radius = metres_of(map, "EQUATORIALRADIUS", 1).value_or(0);
  m.polar_radius = metres_of(map, "POLARRADIUS", 1).value_or(m.radius);
  if (const auto asked = o.options.radius) m.radius = m.polar_radius = *asked;
  found.unknown_radius = !(m.radius > 0);
  const std::string sense = upper_case(text_of(map, "LONGITUDEDIRECTION"));
  m.positive_west = o.options.positive_west.value_or(sense == "POSITIVEWEST");
  const double sign = m.positive_west ? -1 : 1;
  m.center_longitude = sign * number_of(map, "CENTERLONGITUDE").value_or(0);
  m.domain = number_of(map, "LONGITUDEDOMAIN").value_or(360) == 180 ? 180 : 360;
  const double latitude = number_of(map, "CENTERLATITUDE").value_or(0);
  const std::string type = upper_case(info.projection);
  if (type == "SIMPLECYLINDRICAL" || type == "EQUIRECTANGULAR") {
    m.kind = Map::Kind::cylindrical;
    if (type == "EQUIRECTANGULAR") m.standard_latitude = latitude;
  } else if (type == "POLARSTEREOGRAPHIC") {
    m.kind = Map::Kind::polar;
    m.north = latitude > 0;
    m.standard_latitude = latitude;
  }
  if (upper_case(text_of(map, "LATITUDETYPE")) == "PLANETOGRAPHIC" && m.polar_radius != m.radius)
    o.warn(
        "latitudes of the map are planetographic; those printed are planetocentric only on a "
        "sphere");
  const auto left = metres_of(map, "UPPERLEFTCORNERX", 1),
             top = metres_of(map, "UPPERLEFTCORNERY", 1);
  m.dx = m.dy = metres_of(map, "PIXELRESOLUTION", 1).value_or(0);
  if (!left || !top || !(m.dx > 0)) {
    o.warn(
        "the label does not place its map (UpperLeftCornerX, PixelResolution): heights have no "
        "places");
    m.kind = Map::Kind::none;
    if (!(m.dx > 0)) m.dx = m.dy = 1;
    return;
  }
  m.left = *left;
  m.top = *top;
  if (type == "EQUIRECTANGULAR") use_local_radius(o, m);
  const auto w = number_of(map, "MINIMUMLONGITUDE"), e = number_of(map, "MAXIMUMLONGITUDE"),
             s = number_of(map, "MINIMUMLATITUDE"), n = number_of(map, "MAXIMUMLATITUDE");
  if (w && e && s && n)
    found.bounds = m.positive_west ? Bounds{-*e, -*w, *s, *n} : Bounds{*w, *e, *s, *n};
}

}  // namespace

Result<Found> read_isis(const Opening& o, MappedFile file) {
  const Label label = read_label(text_of(file));
  const LabelItem* core = find_block(label.root, "CORE");
  if (core == nullptr || !label.ended)
    return o.fail("the label of the ISIS cube is damaged or cut short");
  Found found;
  DemInfo& info = found.info;
  RawLayout& layout = found.layout;
  info.format = "ISIS cube";
  info.files = {o.name};
  const auto size = [&](const char* key, std::uint64_t otherwise) {
    return static_cast<std::uint32_t>(
        std::min<std::uint64_t>(count_of(*core, key).value_or(otherwise), ~0u));
  };
  info.width = size("SAMPLES", 0);
  info.height = size("LINES", 0);
  info.bands = size("BANDS", 1);
  if (!o.check_size(info)) return failed;
  const std::string type = upper_case(text_of(*core, "TYPE"));
  const auto read = isis_sample_type(type, upper_case(text_of(*core, "BYTEORDER")) == "MSB");
  if (!read) return o.fail(fmt::format("Type {} of the cube is not known", in_quotes(type)));
  layout.type = *read;
  layout.start = count_of(*core, "STARTBYTE").value_or(1) - 1;
  const std::string format = upper_case(text_of(*core, "FORMAT"));
  if (format == "TILE") {
    layout.tile_width = size("TILESAMPLES", 0);
    layout.tile_height = size("TILELINES", 0);
    if (layout.tile_width == 0 || layout.tile_height == 0 || layout.tile_width > 1u << 20 ||
        layout.tile_height > 1u << 20)
      return o.fail("the cube has tiles of no size, or of more than 1048576 samples");
  } else if (format != "BANDSEQUENTIAL") {
    return o.fail(fmt::format("Format {} of the cube is not read, expected Tile or BandSequential",
                              in_quotes(format)));
  }
  info.scale = number_of(*core, "MULTIPLIER").value_or(1);
  info.offset = number_of(*core, "BASE").value_or(0);
  found.rules.add_isis(layout.type);
  if (const LabelItem* mapping = find_block(label.root, "MAPPING"))
    read_mapping(o, *mapping, found);
  else
    o.warn("the cube has no Mapping group: heights have no places");
  if (o.options.data_offset) layout.start = *o.options.data_offset;
  const LabelItem* pointer = find_pointer(label.root, "CORE");
  if (pointer != nullptr && !pointer->values.empty()) {
    auto data = o.beside(pointer->values[0].text, info);
    if (!data) return failed;
    found.data = std::move(*data);
    return found;
  }
  if (layout.start < label.end)
    return o.fail(
        fmt::format("the samples begin at byte {} by StartByte, inside the label, which "
                    "ends at byte {}",
                    layout.start, label.end));
  found.data = std::move(file);
  return found;
}

}  // namespace panwright::terrain
