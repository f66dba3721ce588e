#include <fmt/core.h>

#include <cmath>
#include <map>

#include "base/text.h"
#include "image/tiff_samples.h"
#include "terrain/internal/found.h"

namespace panwright::terrain {

namespace {

// GeoTIFF Standard, OGC 19-008r4: keys and their codes.
enum Key : std::uint16_t {
  kModel = 1024,
  kRaster = 1025,
  kSemiMajor = 2057,
  kSemiMinor = 2058,
  kInverseFlattening = 2059,
  kTransform = 3075,
  kLinearUnit = 3076,
  kLinearUnitSize = 3077,
  kParallel1 = 3078,
  kOriginLongitude = 3080,
  kOriginLatitude = 3081,
  kFalseEasting = 3082,
  kFalseNorthing = 3083,
  kCenterLongitude = 3088,
  kPoleLongitude = 3095,
  kVerticalUnit = 4099,
};
constexpr double kIsPoint = 2, kGeographicModel = 2, kPolarStereographic = 15,
                 kEquirectangular = 17, kMetre = 9001, kUserDefined = 32767;

class TiffRows : public RowSource {
 public:
  TiffRows(MappedFile file, image::TiffHead head, std::uint32_t band, Decoder decoder,
           std::uint64_t memory, std::string name)
      : file_(std::move(file)),
        head_(std::move(head)),
        band_(band - 1),
        decoder_(std::move(decoder)),
        memory_(memory),
        name_(std::move(name)) {}

  bool read(std::uint32_t first, std::uint32_t count, const RowsReceiver& to, DiagnosticLog& log,
            const Job& job) const override {
    std::vector<double> values(head_.width);
    std::vector<VoidKind> voids(head_.width);
    std::uint32_t next = first;
    const auto problem =
        image::decode_tiff_numbers(file_.bytes(), head_, band_, first, count, memory_,
                                   [&](std::uint32_t row, std::span<const double> stored) {
                                     job.poll();
                                     values.assign(stored.begin(), stored.end());
                                     decoder_.judge(values, voids);
                                     next = row + 1;
                                     // what was mapped is not needed again soon
                                     if (row % 256 == 255) file_.release(file_.bytes());
                                     return to({row, 1, values, voids});
                                   });
    if (problem.code)
      log.report_file(Code("E9601"), name_, fmt::format("row {}: {}", next, problem.message));
    return !problem.code && next == first + count;
  }

 private:
  MappedFile file_;
  image::TiffHead head_;
  std::uint32_t band_;
  Decoder decoder_;
  std::uint64_t memory_;
  std::string name_;
};

class GeoTiffReader {
 public:
  GeoTiffReader(const Opening& opening, MappedFile file) : o_(opening), file_(std::move(file)) {}

  Result<Found> read() {
    if (const auto problem = image::read_tiff_head(file_.bytes(), head_); problem.code)
      return o_.fail(problem.message);
    DemInfo& info = found_.info;
    info.format = "GeoTIFF";
    info.files = {o_.name};
    info.width = head_.width;
    info.height = head_.height;
    info.bands = head_.bands;
    if (!o_.check_size(info)) return failed;
    using K = SampleType::Kind;
    using S = image::TiffHead::Sample;
    found_.layout.type = {head_.sample == S::real             ? K::real
                          : head_.sample == S::signed_integer ? K::signed_integer
                                                              : K::unsigned_integer,
                          head_.bits / 8, head_.big_endian};
    std::string none = head_.no_data;
    while (!none.empty() && none.back() == ' ') none.pop_back();
    if (const auto value = parse_double(none)) {
      found_.rules.values.emplace_back(*value, VoidKind::missing);
      info.missing = *value;
    }
    if (const auto scale = metadata("scale")) info.scale = *scale;
    if (const auto offset = metadata("offset")) info.offset = *offset;
    read_keys();
    read_unit();
    read_map();
    if (const auto asked = o_.options.missing)
      found_.rules.values.emplace_back(*asked, VoidKind::missing);
    found_.rows = std::make_shared<TiffRows>(std::move(file_), std::move(head_), info.band,
                                             Decoder(found_.layout.type, found_.rules),
                                             o_.options.memory, o_.name);
    return std::move(found_);
  }

 private:
  // Text of an item of GDAL's metadata with a role.
  std::string metadata_text(const char* role) const {
    const std::string& text = head_.gdal_metadata;
    const std::size_t at = text.find(fmt::format("role=\"{}\"", role));
    const std::size_t open = at == text.npos ? at : text.find('>', at);
    if (open == text.npos) return {};
    return text.substr(open + 1, text.find('<', open) - open - 1);
  }
  std::optional<double> metadata(const char* role) const {
    return parse_double(metadata_text(role));
  }

  void read_keys() {
    const auto& keys = head_.geo_keys;
    for (std::size_t i = 4; i + 3 < keys.size(); i += 4) {
      if (keys[i + 1] == 0) keys_[keys[i]] = keys[i + 3];
      if (keys[i + 1] == 34736 && keys[i + 3] < head_.geo_doubles.size())
        keys_[keys[i]] = head_.geo_doubles[keys[i + 3]];
    }
  }
  std::optional<double> key(Key name) const {
    const auto found = keys_.find(name);
    return found == keys_.end() ? std::nullopt : std::optional(found->second);
  }

  void read_unit() {
    std::string unit = metadata_text("unittype");
    while (!unit.empty() && !(unit.front() >= 'A' && unit.front() <= 'z')) unit.erase(0, 1);
    std::erase_if(unit, [](char c) { return c == '"' || c == ' '; });
    found_.unit = metres_of_unit(unit);
    if (!found_.unit && key(kVerticalUnit) == kMetre) found_.unit = 1;
    found_.info.unit_stated = found_.unit.has_value();
  }

  void read_map() {
    DemInfo& info = found_.info;
    Map& m = info.map;
    // a sphere may stand in the keys or only in a citation of well-known text
    const WktPlace cited = read_wkt(head_.geo_ascii, info);
    // citations of keys without well-known text are names too
    found_.cited = cited.names.empty() ? head_.geo_ascii : cited.names + head_.geo_ascii;
    found_.cited_radius = key(kSemiMajor).value_or(cited.radius);
    const double metres = key(kLinearUnit) == kUserDefined ? key(kLinearUnitSize).value_or(1) : 1;
    if (const auto radius = key(kSemiMajor); radius && *radius > 0) {
      m.radius = m.polar_radius = *radius;
      if (const auto minor = key(kSemiMinor); minor && *minor > 0) m.polar_radius = *minor;
      if (const auto inverse = key(kInverseFlattening); inverse && *inverse > 1)
        m.polar_radius = *radius * (1 - 1 / *inverse);
    }
    if (const auto asked = o_.options.radius) m.radius = m.polar_radius = *asked;
    found_.unknown_radius = !(m.radius > 0);
    const auto transform = key(kTransform);
    if (transform == kPolarStereographic) {
      m.kind = Map::Kind::polar;
      m.standard_latitude = key(kOriginLatitude).value_or(90);
      m.north = m.standard_latitude > 0;
      m.center_longitude = key(kPoleLongitude).value_or(key(kOriginLongitude).value_or(0));
      info.projection = "polar stereographic";
    } else if (transform == kEquirectangular) {
      m.kind = Map::Kind::cylindrical;
      m.standard_latitude = key(kParallel1).value_or(0);
      m.center_longitude = key(kCenterLongitude).value_or(key(kOriginLongitude).value_or(0));
      info.projection = "equirectangular";
    }
    double x = 0, y = 0, dx = 0, dy = 0;
    if (!place(x, y, dx, dy)) {
      m.kind = Map::Kind::none;
      m.dx = m.dy = 0;
      return o_.warn(
          "the TIFF has no place on a map (pixel scale and tie point): heights have none");
    }
    if (key(kRaster) == kIsPoint) {
      // the tie point is the centre of its pixel
      x -= dx / 2;
      y += dy / 2;
      o_.note("pixels are points (PixelIsPoint): the map begins half a pixel before the tie point");
    }
    const bool degrees = key(kModel) == kGeographicModel || (!transform && cited.degrees);
    if (degrees) {
      info.projection = "longitude and latitude";
      return place_in_degrees(info, x, y, dx, dy);
    }
    m.left = (x - key(kFalseEasting).value_or(cited.false_easting)) * metres;
    m.top = (y - key(kFalseNorthing).value_or(cited.false_northing)) * metres;
    m.dx = dx * metres;
    m.dy = dy * metres;
    if (m.kind == Map::Kind::none && m.radius > 0)
      o_.warn("the projection of the TIFF is not known: heights have places in metres alone");
  }

  // Outer corner of the first pixel as the tags give it, and the size of a pixel.
  bool place(double& x, double& y, double& dx, double& dy) const {
    const auto& tie = head_.tiepoint;
    const auto& scale = head_.pixel_scale;
    const auto& matrix = head_.transformation;
    if (scale.size() >= 2 && tie.size() >= 6) {
      dx = scale[0];
      dy = scale[1];
      x = tie[3] - tie[0] * dx;
      y = tie[4] + tie[1] * dy;
    } else if (matrix.size() >= 8 && matrix[1] == 0 && matrix[4] == 0) {
      dx = matrix[0];
      dy = -matrix[5];
      x = matrix[3];
      y = matrix[7];
    }
    return dx > 0 && dy > 0 && std::isfinite(x + y + dx + dy);
  }

  const Opening& o_;
  MappedFile file_;
  image::TiffHead head_;
  std::map<std::uint16_t, double> keys_;
  Found found_;
};

}  // namespace

Result<Found> read_geotiff(const Opening& opening, MappedFile file) {
  return GeoTiffReader(opening, std::move(file)).read();
}

}  // namespace panwright::terrain
