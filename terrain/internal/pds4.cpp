#include <fmt/core.h>

#include <cstring>
#include <pugixml.hpp>

#include "base/text.h"
#include "terrain/internal/found.h"

namespace panwright::terrain {

namespace {

using pugi::xml_node;

std::string_view local_name(const xml_node& node) {
  const std::string_view name = node.name();
  const std::size_t colon = name.find(':');
  return colon == name.npos ? name : name.substr(colon + 1);
}

// First element of a name below a node, whatever its namespace.
xml_node below(const xml_node& node, std::string_view name) {
  return node.find_node([&](const xml_node& each) { return local_name(each) == name; });
}
std::string text_below(const xml_node& node, std::string_view name) {
  std::string out = below(node, name).child_value();
  while (!out.empty() && (out.back() == ' ' || out.back() == '\n' || out.back() == '\r'))
    out.pop_back();
  while (!out.empty() && (out.front() == ' ' || out.front() == '\n' || out.front() == '\r'))
    out.erase(out.begin());
  return out;
}
std::optional<double> number_below(const xml_node& node, std::string_view name) {
  return parse_double(text_below(node, name));
}
std::optional<double> metres_below(const xml_node& node, std::string_view name) {
  const auto number = number_below(node, name);
  const std::string unit = below(node, name).attribute("unit").value();
  if (!number) return std::nullopt;
  const auto metres = metres_of_unit(unit);
  return metres ? std::optional(*number * *metres) : std::nullopt;
}

// "IEEE754LSBSingle", "SignedMSB2", "UnsignedByte".
std::optional<SampleType> pds4_sample_type(std::string_view name) {
  using K = SampleType::Kind;
  const bool big = name.find("MSB") != name.npos;
  if (name.starts_with("IEEE754")) {
    if (name.ends_with("Single")) return SampleType{K::real, 4, big};
    if (name.ends_with("Double")) return SampleType{K::real, 8, big};
    return std::nullopt;
  }
  const bool is_unsigned = name.starts_with("Unsigned");
  if (!is_unsigned && !name.starts_with("Signed")) return std::nullopt;
  const K kind = is_unsigned ? K::unsigned_integer : K::signed_integer;
  if (name.ends_with("Byte")) return SampleType{kind, 1, big};
  for (const unsigned bytes : {2u, 4u, 8u})
    if (name.ends_with(std::to_string(bytes))) return SampleType{kind, bytes, big};
  return std::nullopt;
}

class Pds4Reader {
 public:
  explicit Pds4Reader(const Opening& opening) : o_(opening) {}

  Result<Found> read(const MappedFile& file) {
    const std::string_view text = terrain::text_of(file);
    const auto parsed = document_.load_buffer(text.data(), text.size());
    if (!parsed)
      return o_.fail(fmt::format("the PDS4 label is not well-formed XML: {} at byte {}",
                                 parsed.description(), parsed.offset));
    found_.info.format = "PDS4";
    found_.info.files = {o_.name};
    array_ = document_.find_node([](const xml_node& each) {
      const std::string_view name = local_name(each);
      return name.starts_with("Array_2D") || name.starts_with("Array_3D");
    });
    if (!array_) return o_.fail("the PDS4 label has no Array_2D_Image or Array_3D_Image");
    if (!read_axes() || !read_elements()) return failed;
    read_voids();
    read_map();
    const std::string name = text_below(array_.parent(), "file_name");
    if (name.empty()) return o_.fail("the PDS4 label names no file (file_name)");
    auto data = o_.beside(name, found_.info);
    if (!data) return failed;
    found_.data = std::move(*data);
    return std::move(found_);
  }

 private:
  bool read_axes() {
    DemInfo& info = found_.info;
    double line = 0, sample = 0, band = 0;
    info.bands = 1;
    for (const xml_node& axis : array_.children()) {
      if (local_name(axis) != "Axis_Array") continue;
      const std::string name = upper_case(text_below(axis, "axis_name"));
      const double size = number_below(axis, "elements").value_or(0);
      const double order = number_below(axis, "sequence_number").value_or(0);
      const auto count = size >= 1 && size < 4294967295.0 ? static_cast<std::uint32_t>(size) : 0u;
      if (name == "LINE") info.height = count, line = order;
      if (name == "SAMPLE") info.width = count, sample = order;
      if (name == "BAND") info.bands = count, band = order;
    }
    if (!o_.check_size(info)) return false;
    using Order = RawLayout::Order;
    const std::string fastest = text_below(array_, "axis_index_order");
    if (!fastest.empty() && fastest != "Last Index Fastest") {
      (void)o_.fail(fmt::format("axis_index_order {} is not read, expected Last Index Fastest",
                                in_quotes(fastest)));
      return false;
    }
    if (line > sample) {
      (void)o_.fail("the lines of the array are columns: Sample must come after Line");
      return false;
    }
    found_.layout.order = band > sample ? Order::samples
                          : band > line ? Order::lines
                                        : Order::bands;
    if (upper_case(text_below(document_, "vertical_display_direction")) == "BOTTOM TO TOP") {
      (void)o_.fail("rows of the array run from the bottom of the map; expected Top to Bottom");
      return false;
    }
    return true;
  }

  bool read_elements() {
    const xml_node element = below(array_, "Element_Array");
    const std::string type = text_below(element, "data_type");
    const auto read = pds4_sample_type(type);
    if (!read) {
      (void)o_.fail(fmt::format("data_type {} is not read", in_quotes(type)));
      return false;
    }
    found_.layout.type = *read;
    found_.info.scale = number_below(element, "scaling_factor").value_or(1);
    found_.info.offset = number_below(element, "value_offset").value_or(0);
    if (const std::string unit = text_below(element, "unit"); !unit.empty()) {
      found_.unit = metres_of_unit(unit);
      found_.info.unit_stated = found_.unit.has_value();
    }
    const double offset = number_below(array_, "offset").value_or(0);
    found_.layout.start = offset >= 0 && offset < 1e15 ? static_cast<std::uint64_t>(offset) : 0;
    if (o_.options.data_offset) found_.layout.start = *o_.options.data_offset;
    return true;
  }

  void read_voids() {
    using K = VoidKind;
    const struct {
      const char* name;
      K kind;
    } constants[] = {{"missing_constant", K::missing},
                     {"invalid_constant", K::missing},
                     {"unknown_constant", K::missing},
                     {"not_applicable_constant", K::missing},
                     {"error_constant", K::missing},
                     {"saturated_constant", K::high_instrument},
                     {"high_instrument_saturation", K::high_instrument},
                     {"high_representation_saturation", K::high_representation},
                     {"low_instrument_saturation", K::low_instrument},
                     {"low_representation_saturation", K::low_representation}};
    const xml_node special = below(array_, "Special_Constants");
    for (const auto& constant : constants) {
      const std::string text = text_below(special, constant.name);
      if (text.empty()) continue;
      if (const auto bits = bits_of(text)) {
        found_.rules.patterns.emplace_back(*bits, constant.kind);
      } else if (const auto number = parse_double(text)) {
        found_.rules.values.emplace_back(*number, constant.kind);
        if (constant.kind == K::missing) found_.info.missing = *number;
      } else {
        o_.warn(fmt::format("{} {} is neither a number nor a bit pattern; it is not used",
                            constant.name, in_quotes(text)));
      }
    }
    if (const auto least = number_below(special, "valid_minimum")) found_.rules.least = *least;
    if (const auto most = number_below(special, "valid_maximum")) found_.rules.largest = *most;
  }
  // "16#FF7FFFFB#" and "0xFF7FFFFB".
  static std::optional<std::uint64_t> bits_of(std::string_view text) {
    if (text.starts_with("0x") || text.starts_with("0X"))
      return pattern_of("16#" + std::string(text.substr(2)) + "#");
    return pattern_of(text);
  }

  void read_map() {
    const xml_node cart = below(document_, "Cartography");
    DemInfo& info = found_.info;
    info.target = text_below(below(document_, "Target_Identification"), "name");
    if (!cart) return o_.warn("the label has no Cartography: heights have no places");
    Map& m = info.map;
    info.projection = text_below(cart, "map_projection_name");
    info.frame = text_below(cart, "coordinate_system_name");
    m.radius = metres_below(cart, "a_axis_radius").value_or(0);
    m.polar_radius = metres_below(cart, "c_axis_radius").value_or(m.radius);
    if (const auto asked = o_.options.radius) m.radius = m.polar_radius = *asked;
    found_.unknown_radius = !(m.radius > 0);
    m.positive_west = o_.options.positive_west.value_or(text_below(cart, "longitude_direction") ==
                                                        "Positive West");
    const double sign = m.positive_west ? -1 : 1;
    m.center_longitude = sign * number_below(cart, "longitude_of_central_meridian").value_or(0);
    const std::string type = upper_case(info.projection);
    if (type.find("CYLINDRICAL") != type.npos || type.find("EQUIRECTANGULAR") != type.npos) {
      m.kind = Map::Kind::cylindrical;
      m.standard_latitude = number_below(cart, "standard_parallel_1").value_or(0);
    } else if (type.find("POLAR") != type.npos && type.find("STEREO") != type.npos) {
      m.kind = Map::Kind::polar;
      m.standard_latitude = number_below(cart, "latitude_of_projection_origin").value_or(90);
      m.north = m.standard_latitude > 0;
    }
    const auto left = metres_below(cart, "upperleft_corner_x"),
               top = metres_below(cart, "upperleft_corner_y");
    m.dx = metres_below(cart, "pixel_resolution_x").value_or(0);
    m.dy = metres_below(cart, "pixel_resolution_y").value_or(m.dx);
    const auto w = number_below(cart, "west_bounding_coordinate"),
               e = number_below(cart, "east_bounding_coordinate"),
               s = number_below(cart, "south_bounding_coordinate"),
               n = number_below(cart, "north_bounding_coordinate");
    if (w && e && (*w > 180 || *e > 180)) m.domain = 360;
    if (w && e && s && n) found_.bounds = Bounds{sign * *w, sign * *e, *s, *n};
    if (!left || !top || !(m.dx > 0) || !(m.dy > 0)) {
      o_.warn(
          "the label does not place its map (upperleft_corner_x, pixel_resolution_x): heights "
          "have no places");
      m.kind = Map::Kind::none;
      if (!(m.dx > 0) || !(m.dy > 0)) m.dx = m.dy = 0;
      return;
    }
    m.left = *left;
    m.top = *top;
  }

  const Opening& o_;
  pugi::xml_document document_;
  xml_node array_;
  Found found_;
};

}  // namespace

Result<Found> read_pds4(const Opening& opening, MappedFile file) {
  return Pds4Reader(opening).read(file);
}

}  // namespace panwright::terrain
