#include <fmt/core.h>

#include <map>

#include "base/text.h"
#include "terrain/internal/found.h"

namespace panwright::terrain {

namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == text.npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

// Members of a header; { } may span lines.
std::map<std::string, std::string> members_of(std::string_view text) {
  std::map<std::string, std::string> out;
  while (!text.empty() && out.size() < 1000) {
    std::size_t end = std::min(text.find('\n'), text.size());
    const std::size_t equals = text.substr(0, end).find('=');
    if (equals != text.npos) {
      std::string key(trimmed(text.substr(0, equals)));
      for (char& c : key)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
      std::string_view value = trimmed(text.substr(equals + 1, end - equals - 1));
      if (value.starts_with('{')) {
        const std::size_t open = text.find('{', equals);
        const std::size_t close = std::min(text.find('}', open), text.size());
        value = trimmed(text.substr(open + 1, close - open - 1));
        end = std::min(text.find('\n', close), text.size());
      }
      out.emplace(std::move(key), std::string(value));
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

std::vector<std::string> parts_of(std::string_view text) {
  std::vector<std::string> out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(','), text.size());
    out.emplace_back(trimmed(text.substr(0, end)));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

std::optional<SampleType> envi_sample_type(double code, bool big) {
  using K = SampleType::Kind;
  if (!(code >= 0 && code < 100)) return std::nullopt;
  switch (static_cast<int>(code)) {
    case 1:
      return SampleType{K::unsigned_integer, 1, big};
    case 2:
      return SampleType{K::signed_integer, 2, big};
    case 3:
      return SampleType{K::signed_integer, 4, big};
    case 4:
      return SampleType{K::real, 4, big};
    case 5:
      return SampleType{K::real, 8, big};
    case 12:
      return SampleType{K::unsigned_integer, 2, big};
    case 13:
      return SampleType{K::unsigned_integer, 4, big};
    case 14:
      return SampleType{K::signed_integer, 8, big};
    case 15:
      return SampleType{K::unsigned_integer, 8, big};
    default:
      return std::nullopt;
  }
}

class EnviReader {
 public:
  EnviReader(const Opening& opening, const MappedFile& file)
      : o_(opening), members_(members_of(text_of(file).substr(0, kMostLabel))) {}

  Result<Found> read() {
    DemInfo& info = found_.info;
    info.format = "ENVI";
    info.files = {o_.name};
    const auto size = [&](const char* key, double otherwise) {
      const double value = number(key).value_or(otherwise);
      return value >= 0 && value < 4294967295.0 ? static_cast<std::uint32_t>(value) : 0u;
    };
    info.width = size("samples", 0);
    info.height = size("lines", 0);
    info.bands = size("bands", 1);
    if (!o_.check_size(info)) return failed;
    const auto type =
        envi_sample_type(number("data type").value_or(0), number("byte order") == 1.0);
    if (!type)
      return o_.fail(
          fmt::format("data type {} of the header is not read, expected 1 to 5 or 12 to 15",
                      in_quotes(text("data type"))));
    if (number("file compression").value_or(0) != 0)
      return o_.fail("the data are compressed, expected plain samples");
    found_.layout.type = *type;
    using Order = RawLayout::Order;
    const std::string order = upper_case(text("interleave"));
    found_.layout.order = order == "BIL"   ? Order::lines
                          : order == "BIP" ? Order::samples
                                           : Order::bands;
    found_.layout.start = size("header offset", 0);
    if (o_.options.data_offset) found_.layout.start = *o_.options.data_offset;
    if (const auto none = number("data ignore value")) {
      found_.rules.values.emplace_back(*none, VoidKind::missing);
      info.missing = *none;
    }
    const auto of_band = [&](const char* key, double otherwise) {
      const auto values = parts_of(text(key));
      return values.size() >= info.band ? parse_double(values[info.band - 1]).value_or(otherwise)
                                        : otherwise;
    };
    info.scale = of_band("data gain values", 1);
    info.offset = of_band("data offset values", 0);
    read_map();
    auto data = data_file();
    if (!data) return failed;
    found_.data = std::move(*data);
    return std::move(found_);
  }

 private:
  std::string text(const char* key) const {
    const auto found = members_.find(key);
    return found == members_.end() ? std::string() : found->second;
  }
  std::optional<double> number(const char* key) const {
    std::string_view value = trimmed(text_view(key));
    return parse_double(value);
  }
  std::string_view text_view(const char* key) const {
    const auto found = members_.find(key);
    return found == members_.end() ? std::string_view() : std::string_view(found->second);
  }

  void read_map() {
    DemInfo& info = found_.info;
    Map& m = info.map;
    const WktPlace place = read_wkt(text_view("coordinate system string"), info);
    found_.cited = place.names;
    found_.cited_radius = place.radius;
    const auto map = parts_of(text_view("map info"));
    if (map.size() < 7)
      return o_.warn("the header has no map info: heights have no places", "--spacing METRES");
    if (info.projection.empty()) {
      info.projection = map[0];
      read_name(m);
    }
    double n[6] = {};
    for (std::size_t k = 0; k < 6; ++k) n[k] = parse_double(map[k + 1]).value_or(0);
    bool degrees = place.degrees || upper_case(map[0]).starts_with("GEOGRAPHIC");
    for (const std::string& part : map) {
      if (part.starts_with("rotation=") && parse_double(part.substr(9)).value_or(0) != 0) {
        o_.warn("the map is rotated: its heights have no places");
        m.kind = Map::Kind::none;
      }
      if (upper_case(part) == "UNITS=DEGREES") degrees = true;
    }
    if (const auto asked = o_.options.radius) m.radius = m.polar_radius = *asked;
    found_.unknown_radius = !(m.radius > 0);
    if (!(n[4] > 0) || !(n[5] > 0)) {
      o_.warn("the pixels of the map have no size: heights have no places");
      m.kind = Map::Kind::none;
      m.dx = m.dy = 0;
      return;
    }
    // the reference pixel counts from 1 at the outer corner of the first
    const double x = n[2] - (n[0] - 1) * n[4], y = n[3] + (n[1] - 1) * n[5];
    if (degrees) return place_in_degrees(info, x, y, n[4], n[5]);
    m.left = (x - place.false_easting) * place.metres;
    m.top = (y - place.false_northing) * place.metres;
    m.dx = n[4] * place.metres;
    m.dy = n[5] * place.metres;
  }

  // The projection of a map info without a coordinate system string.
  void read_name(Map& m) const {
    std::string name;
    for (const char c : upper_case(found_.info.projection))
      if (c >= 'A' && c <= 'Z') name += c;
    if (name == "LOCAL" || name == "ARBITRARY" || name == "PIXEL" || name.starts_with("GEOGRAPHIC"))
      return;
    if (name.starts_with("EQUIRECTANGULAR") || name.starts_with("EQUIDISTANTCYLINDRICAL") ||
        name == "PLATECARREE" || name == "SIMPLECYLINDRICAL") {
      m.kind = Map::Kind::cylindrical;
      return o_.warn(
          "the header has no coordinate system string: x = 0 is taken as longitude 0, and scales "
          "as "
          "true at the equator",
          "the parameters in WKT: coordinate system string = {PROJCS[…]}");
    }
    o_.warn(fmt::format("the projection {} is not read without a coordinate system string: heights "
                        "have places in metres alone",
                        in_quotes(found_.info.projection)),
            "the projection in WKT: coordinate system string = {PROJCS[…]}");
  }

  Result<MappedFile> data_file() {
    std::filesystem::path stem = o_.path;
    stem.replace_extension();
    std::error_code none;
    for (const char* extension : {"", ".dat", ".img", ".raw", ".bsq", ".bil", ".bip", ".bin"}) {
      const std::filesystem::path path = stem.string() + extension;
      if (std::filesystem::is_regular_file(path, none))
        return o_.beside(path.filename().string(), found_.info);
    }
    (void)o_.fail(
        fmt::format("the data of the header are missing: expected {} alone, or with "
                    ".dat, .img, .raw, .bsq, .bil, .bip or .bin",
                    in_quotes(stem.filename().string())));
    return failed;
  }

  const Opening& o_;
  std::map<std::string, std::string> members_;
  Found found_;
};

}  // namespace

Result<Found> read_envi(const Opening& opening, MappedFile file) {
  return EnviReader(opening, file).read();
}

}  // namespace panwright::terrain
