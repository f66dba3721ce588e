#include <fmt/core.h>

#include <cmath>

#include "base/text.h"
#include "terrain/internal/found.h"

namespace panwright::terrain {

namespace {

// PDS Standards Reference 3.8, appendix C: types and their other names.
std::optional<SampleType> sample_type(const std::string& name, std::uint64_t bits) {
  using K = SampleType::Kind;
  SampleType out;
  const bool real = name == "PC_REAL" || name == "IEEE_REAL" || name == "SUN_REAL" ||
                    name == "REAL" || name == "FLOAT" || name == "MAC_REAL";
  const bool vax = name == "VAX_REAL" || name == "VAXF" || name == "VAX_FLOAT";
  if (real || vax) {
    out.kind = vax ? K::vax_real : K::real;
    out.big_endian = name != "PC_REAL";
    out.bytes = static_cast<unsigned>(bits / 8);
    const bool good = bits == 32 || (bits == 64 && !vax);
    return good ? std::optional(out) : std::nullopt;
  }
  std::string_view rest = name;
  const auto take = [&](std::string_view word) {
    if (!rest.starts_with(word)) return false;
    rest.remove_prefix(word.size());
    return true;
  };
  bool little = take("LSB_") || take("PC_") || take("VAX_");
  if (!little) (void)(take("MSB_") || take("SUN_") || take("MAC_") || take("IEEE_"));
  const bool is_unsigned = take("UNSIGNED_");
  if (rest != "INTEGER" || (bits != 8 && bits != 16 && bits != 32)) return std::nullopt;
  out.kind = is_unsigned ? K::unsigned_integer : K::signed_integer;
  out.bytes = static_cast<unsigned>(bits / 8);
  out.big_endian = !little;
  return out;
}

class Pds3Reader {
 public:
  Pds3Reader(const Opening& opening, MappedFile file)
      : o_(opening), file_(std::move(file)), label_(read_label(text_of(file_))) {}

  Result<Found> read() {
    if (!label_.ended)
      return o_.fail("the label of the PDS3 file has no END, so it is damaged or cut short");
    found_.info.format = "PDS3";
    found_.info.files = {o_.name};
    found_.info.target = terrain::text_of(label_.root, "TARGET_NAME");
    if (!find_image() || !read_image() || !place_data()) return failed;
    read_voids();
    read_map();
    return std::move(found_);
  }

 private:
  bool find_image() {
    image_ = find_block(label_.root, "IMAGE");
    std::string name = "IMAGE";
    if (image_ == nullptr)
      for (const LabelItem& item : label_.root.items)
        if (item.block && item.name.ends_with("IMAGE")) {
          image_ = &item;
          name = item.name;
          break;
        }
    if (image_ == nullptr) {
      (void)o_.fail("the label has no IMAGE object, which elevations are read from");
      return false;
    }
    pointer_ = find_pointer(label_.root, name);
    if (const auto encoding = upper_case(terrain::text_of(*image_, "ENCODING_TYPE"));
        !encoding.empty() && encoding != "NONE") {
      (void)o_.fail(fmt::format("the image is compressed ({}), expected plain samples", encoding));
      return false;
    }
    return true;
  }

  bool read_image() {
    DemInfo& info = found_.info;
    RawLayout& layout = found_.layout;
    const auto size = [&](const char* key, std::uint32_t otherwise) {
      const auto value = count_of(*image_, key);
      return static_cast<std::uint32_t>(std::min<std::uint64_t>(value.value_or(otherwise), ~0u));
    };
    info.height = size("LINES", 0);
    info.width = size("LINE_SAMPLES", 0);
    info.bands = size("BANDS", 1);
    if (!o_.check_size(info)) return false;
    layout.prefix = size("LINE_PREFIX_BYTES", 0);
    layout.suffix = size("LINE_SUFFIX_BYTES", 0);
    const std::string type = upper_case(terrain::text_of(*image_, "SAMPLE_TYPE"));
    const std::uint64_t bits = size("SAMPLE_BITS", 0);
    const auto read = sample_type(type, bits);
    if (!read) {
      (void)o_.fail(
          fmt::format("SAMPLE_TYPE {} of {} bits is not read, expected integers of 8, 16 "
                      "or 32 bits, reals of 32 or 64, or VAX_REAL of 32",
                      in_quotes(type), bits));
      return false;
    }
    layout.type = *read;
    const std::string order = upper_case(terrain::text_of(*image_, "BAND_STORAGE_TYPE"));
    using Order = RawLayout::Order;
    if (order.starts_with("LINE")) layout.order = Order::lines;
    if (order.starts_with("SAMPLE")) layout.order = Order::samples;
    info.scale = number_of(*image_, "SCALING_FACTOR").value_or(1);
    info.offset = number_of(*image_, "OFFSET").value_or(0);
    if (const std::string unit = terrain::text_of(*image_, "UNIT"); !unit.empty()) {
      found_.unit = metres_of_unit(unit);
      if (found_.unit)
        info.unit_stated = true;
      else
        o_.note(fmt::format("UNIT = {} is no unit of length that is known", in_quotes(unit)));
    }
    return true;
  }

  // The file and the byte of the first sample.
  bool place_data() {
    std::string name;
    std::optional<std::uint64_t> number;
    bool bytes = false;
    if (pointer_ != nullptr)
      for (const LabelValue& value : pointer_->values) {
        const auto count = parse_double(value.text);
        if (count && *count >= 1 && *count < 1e15) {
          number = static_cast<std::uint64_t>(*count);
          bytes = value.unit.starts_with("byte");
        } else {
          name = value.text;
        }
      }
    if (pointer_ == nullptr || (name.empty() && !number)) {
      (void)o_.fail("the label does not say where its image is: it has no pointer ^IMAGE");
      return false;
    }
    const auto record = count_of(label_.root, "RECORD_BYTES");
    std::uint64_t start = 0;
    if (number && !bytes && *number > 1 && !record) {
      (void)o_.fail("^IMAGE counts records, and the label has no RECORD_BYTES");
      return false;
    }
    if (number) start = (*number - 1) * (bytes ? 1 : record.value_or(0));
    const bool attached = name.empty();
    if (o_.options.data_offset) start = *o_.options.data_offset;
    if (attached && start < label_.end) {
      (void)o_.fail(
          fmt::format("the image begins at byte {} by its pointer ^IMAGE, inside the label, which "
                      "ends at byte {}: the label was edited",
                      start, label_.end),
          fmt::format("--data-offset {} reads the samples from behind the label", label_.end));
      return false;
    }
    found_.layout.start = start;
    if (attached) {
      found_.data = std::move(file_);
      return true;
    }
    auto data = o_.beside(name, found_.info);
    if (!data) return false;
    found_.data = std::move(*data);
    return true;
  }

  void add_void(const char* key, VoidKind kind) {
    const LabelItem* item = find(*image_, key);
    if (item == nullptr) return;
    for (const LabelValue& value : item->values) {
      std::string_view text = value.text;
      if (const auto bits = pattern_of(text)) {
        found_.rules.patterns.emplace_back(*bits, kind);
      } else if (const auto number = parse_double(text)) {
        found_.rules.values.emplace_back(*number, kind);
        if (kind == VoidKind::missing) found_.info.missing = *number;
      } else if (upper_case(text) != "N/A" && upper_case(text) != "NULL") {
        o_.warn(fmt::format("{} = {} is neither a number nor a bit pattern; it is not used", key,
                            in_quotes(text)));
      }
    }
  }

  void read_voids() {
    using K = VoidKind;
    for (const char* key : {"MISSING_CONSTANT", "MISSING", "INVALID_CONSTANT", "UNKNOWN_CONSTANT",
                            "NOT_APPLICABLE_CONSTANT"})
      add_void(key, K::missing);
    add_void("CORE_NULL", K::null);
    add_void("CORE_LOW_REPR_SATURATION", K::low_representation);
    add_void("CORE_LOW_INSTR_SATURATION", K::low_instrument);
    add_void("CORE_HIGH_INSTR_SATURATION", K::high_instrument);
    add_void("CORE_HIGH_REPR_SATURATION", K::high_representation);
    for (const char* key : {"VALID_MINIMUM", "CORE_VALID_MINIMUM"}) {
      const LabelItem* item = find(*image_, key);
      if (item == nullptr || item->values.empty()) continue;
      // of ISIS: the least valid number is a bit pattern of a float
      if (const auto number = parse_double(item->values[0].text)) found_.rules.least = *number;
    }
    if (const auto most = number_of(*image_, "VALID_MAXIMUM")) found_.rules.largest = *most;
  }

  void read_map() {
    const LabelItem* map = find_block(label_.root, "IMAGE_MAP_PROJECTION");
    if (map == nullptr) return o_.warn("the label has no map projection: heights have no places");
    DemInfo& info = found_.info;
    Map& m = info.map;
    info.projection = terrain::text_of(*map, "MAP_PROJECTION_TYPE");
    info.frame = terrain::text_of(*map, "COORDINATE_SYSTEM_NAME");
    m.radius = metres_of(*map, "A_AXIS_RADIUS", 1000).value_or(0);
    m.polar_radius = metres_of(*map, "C_AXIS_RADIUS", 1000).value_or(m.radius);
    const std::string sense = upper_case(terrain::text_of(*map, "POSITIVE_LONGITUDE_DIRECTION"));
    m.positive_west = o_.options.positive_west.value_or(sense == "WEST");
    if (sense.empty() && !o_.options.positive_west)
      o_.note("the label does not say which way longitudes count: to the east is assumed",
              "--positive west");
    const double sign = m.positive_west ? -1 : 1;
    m.center_longitude = sign * number_of(*map, "CENTER_LONGITUDE").value_or(0);
    const double latitude = number_of(*map, "CENTER_LATITUDE").value_or(0);
    const std::string type = upper_case(info.projection);
    if (type.find("CYLINDRICAL") != type.npos || type.find("EQUIRECTANGULAR") != type.npos) {
      m.kind = Map::Kind::cylindrical;
      if (type.find("EQUIRECTANGULAR") != type.npos) m.standard_latitude = latitude;
    } else if (type.find("POLAR") != type.npos && type.find("STEREO") != type.npos) {
      m.kind = Map::Kind::polar;
      m.north = latitude > 0;
      m.standard_latitude = latitude;
    }
    if (number_of(*map, "MAP_PROJECTION_ROTATION").value_or(0) != 0) {
      o_.warn("the map is rotated (MAP_PROJECTION_ROTATION): its heights have no places");
      m.kind = Map::Kind::none;
    }
    if (const auto asked = o_.options.radius) m.radius = m.polar_radius = *asked;
    found_.unknown_radius = !(m.radius > 0);
    read_scale(*map, sign);
    if (const auto last = count_of(*map, "LINE_LAST_PIXEL");
        last && *last != info.height && count_of(*map, "LINE_FIRST_PIXEL").value_or(1) == 1)
      o_.warn(
          fmt::format("LINES is {} and LINE_LAST_PIXEL is {}: the map was cut, and its place "
                      "may be that of the whole",
                      info.height, *last));
  }

  void read_scale(const LabelItem& map, double sign) {
    Map& m = found_.info.map;
    const auto resolution = number_of(map, "MAP_RESOLUTION");
    const auto scale = metres_of(map, "MAP_SCALE", 1000);
    const double by_resolution =
        resolution && *resolution > 0 && m.radius > 0 ? m.radius * kDegree / *resolution : 0;
    // degrees are round numbers on cylindrical maps, metres on others
    const bool in_degrees = m.kind == Map::Kind::cylindrical && m.standard_latitude == 0;
    m.dx = in_degrees && by_resolution > 0 ? by_resolution
           : scale && *scale > 0           ? *scale
                                           : by_resolution;
    m.dy = m.dx;
    if (in_degrees && by_resolution > 0 && scale && std::fabs(*scale / m.dx - 1) > 1e-9) {
      const std::string words = fmt::format(
          "MAP_SCALE {} m differs from MAP_RESOLUTION {} pixels per degree, {:.4f} m; the latter "
          "is used: {:.1f} m across the map",
          *scale, *resolution, m.dx, std::fabs(*scale - m.dx) * found_.info.width);
      if (std::fabs(*scale / m.dx - 1) > 1e-3)
        o_.warn(words);
      else
        o_.note(words);
    }
    const auto s0 = number_of(map, "SAMPLE_PROJECTION_OFFSET");
    const auto l0 = number_of(map, "LINE_PROJECTION_OFFSET");
    if (!s0 || !l0 || !(m.dx > 0)) {
      if (m.kind != Map::Kind::none)
        o_.warn(
            "the label does not place its map (LINE_PROJECTION_OFFSET, MAP_SCALE): heights "
            "have no places");
      m.kind = Map::Kind::none;
      if (!(m.dx > 0)) m.dx = m.dy = 0;
      return;
    }
    // offsets are those of the projection's origin from the centre of pixel (1, 1)
    m.left = (-*s0 - 0.5) * m.dx;
    m.top = (*l0 + 0.5) * m.dy;
    if (scale && *scale > 0) use_local_radius(o_, m);
    const auto w = number_of(map, "WESTERNMOST_LONGITUDE"),
               e = number_of(map, "EASTERNMOST_LONGITUDE"), n = number_of(map, "MAXIMUM_LATITUDE"),
               s = number_of(map, "MINIMUM_LATITUDE");
    if (w && e && (*w > 180 || *e > 180)) m.domain = 360;
    if (w && e && n && s) found_.bounds = Bounds{sign * *w, sign * *e, *s, *n};
  }

  const Opening& o_;
  MappedFile file_;
  Label label_;
  Found found_;
  const LabelItem* image_ = nullptr;
  const LabelItem* pointer_ = nullptr;
};

}  // namespace

Result<Found> read_pds3(const Opening& opening, MappedFile file) {
  return Pds3Reader(opening, std::move(file)).read();
}

}  // namespace panwright::terrain
