#include "terrain/dem.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "terrain/internal/found.h"

namespace panwright::terrain {

namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kProbed = 64;  // rows that are looked at before

// Limits of plausible slopes, as tangents of the RMS between neighbours.
constexpr double kFlat = 2e-3, kSteep = 2;

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

// A file of a name in a folder, in any letter case.
std::optional<fs::path> in_folder(const fs::path& folder, const std::string& name) {
  std::error_code none;
  if (fs::is_regular_file(folder / name, none)) return folder / name;
  const std::string wanted = lower(name);
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder, none))
    if (lower(entry.path().filename().string()) == wanted) found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found.empty() ? std::nullopt : std::optional(found.front());
}

enum class FileKind { pds3, pds4, isis, tiff, envi, image, other };

FileKind kind_of(std::string_view bytes) {
  if (starts_with_any(bytes, {std::string_view("II*\0", 4), std::string_view("MM\0*", 4),
                              std::string_view("II+\0", 4), std::string_view("MM\0+", 4)}))
    return FileKind::tiff;
  if (starts_with_any(bytes, {"\x89PNG", "\xff\xd8\xff"})) return FileKind::image;
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  const std::string_view text = first == bytes.npos ? std::string_view() : bytes.substr(first);
  if (text.starts_with("ENVI")) return FileKind::envi;
  const std::string head = upper_case(text.substr(0, 4096));
  if (text.starts_with("<?xml") || text.starts_with("<Product"))
    return head.find("PDS.NASA.GOV/PDS4") != head.npos ? FileKind::pds4 : FileKind::other;
  if (head.starts_with("OBJECT") && head.find("ISISCUBE") < 64) return FileKind::isis;
  // before its version a PDS3 label may have others
  if (head.find("PDS_VERSION_ID") < 512) return FileKind::pds3;
  return FileKind::other;
}

// The label beside a file of bare samples.
std::optional<fs::path> label_of(const fs::path& data) {
  const std::string stem = data.stem().string();
  for (const char* extension : {".lbl", ".xml"})
    if (auto found =
            in_folder(data.parent_path().empty() ? "." : data.parent_path(), stem + extension))
      return data.parent_path().empty() ? found->filename() : *found;
  for (const std::string& name : {data.filename().string() + ".hdr", stem + ".hdr"})
    if (auto found = in_folder(data.parent_path().empty() ? "." : data.parent_path(), name))
      return data.parent_path().empty() ? found->filename() : *found;
  return std::nullopt;
}

Result<Found> read_found(const Opening& opening, bool may_look_beside, fs::path& label) {
  auto file = MappedFile::open(opening.path, opening.log);
  if (!file) return failed;
  switch (kind_of(text_of(*file))) {
    case FileKind::pds3:
      return read_pds3(opening, std::move(*file));
    case FileKind::pds4:
      return read_pds4(opening, std::move(*file));
    case FileKind::isis:
      return read_isis(opening, std::move(*file));
    case FileKind::tiff:
      return read_geotiff(opening, std::move(*file));
    case FileKind::envi:
      return read_envi(opening, std::move(*file));
    case FileKind::image:
      // heights in images have no scale
      if (opening.options.quantity == Quantity::plain) return read_image(opening, std::move(*file));
      break;
    case FileKind::other:
      break;
  }
  if (may_look_beside)
    if (auto found = label_of(opening.path)) {
      label = std::move(*found);
      return failed;
    }
  if (!opening.options.gdal) return opening.fail("the file is of no known kind");
  return read_gdal(opening);
}

// What the rows that are looked at before show, in stored numbers times scale, plus offset.
struct Probe {
  std::uint64_t count = 0;
  double least = 0, largest = 0;
  double slope = 0;  // RMS difference of neighbours

  bool lies_about(double radius) const {
    return count > 0 && radius > 0 && least > 0.5 * radius && largest < 1.5 * radius;
  }
};

bool probe_rows(const RowSource& rows, const DemInfo& info, Probe& out, DiagnosticLog& log,
                const Job& job) {
  double squares = 0;
  std::uint64_t pairs = 0;
  const auto take = [&](const Rows& band) {
    for (std::size_t i = 0; i < band.heights.size(); ++i) {
      if (band.voids[i] != VoidKind::none) continue;
      const double value = band.heights[i] * info.scale + info.offset;
      out.least = out.count == 0 ? value : std::min(out.least, value);
      out.largest = out.count == 0 ? value : std::max(out.largest, value);
      ++out.count;
      if (i % info.width == 0 || band.voids[i - 1] != VoidKind::none) continue;
      const double step = (band.heights[i] - band.heights[i - 1]) * info.scale;
      squares += step * step;
      ++pairs;
    }
    return true;
  };
  // neighbouring rows in four places: tiles and strips are decoded whole
  const std::uint32_t parts = info.height <= kProbed ? 1 : 4;
  for (std::uint32_t k = 0; k < parts; ++k) {
    const std::uint32_t count = std::min(kProbed / parts, info.height);
    const auto first = static_cast<std::uint32_t>(
        parts == 1 ? 0 : std::uint64_t{info.height - count} * k / (parts - 1));
    if (!rows.read(first, parts == 1 ? info.height : count, take, log, job)) return false;
  }
  out.slope = pairs > 0 ? std::sqrt(squares / double(pairs)) : 0;
  return true;
}

// The meaning of numbers: their unit, and radius or height.
class Settler {
 public:
  Settler(const Opening& opening, Found& found, const Probe& probe)
      : o_(opening), found_(found), info_(found.info), probe_(probe) {}

  bool settle() {
    info_.quantity = o_.options.quantity.value_or(Quantity::height);
    if (info_.quantity == Quantity::plain) {
      if (!info_.unit_stated) info_.unit.clear();
      return true;
    }
    if (o_.options.unit) found_.unit = o_.options.unit;
    const double r = info_.map.radius;
    if (!found_.unit && !guess_unit()) return false;
    info_.unit = *found_.unit == 1000 ? "km"
                 : *found_.unit == 1  ? "m"
                                      : fmt::format("{} m", *found_.unit);
    if (o_.options.quantity) return true;
    const double unit = *found_.unit;
    const bool by_offset = r > 0 && std::fabs(info_.offset * unit / r - 1) < 0.2;
    if (by_offset || lies_about(r / unit)) {
      info_.quantity = Quantity::radius;
      return true;
    }
    return check_heights();
  }

 private:
  bool doubt(const std::string& message, const std::string& hint) const {
    o_.log.report_file(Code("E9602"), o_.name, message, hint);
    return false;
  }
  bool lies_about(double radius) const { return probe_.lies_about(radius); }

  std::string range() const {
    return fmt::format("{:.6g} to {:.6g}", probe_.least, probe_.largest);
  }

  // RMS slope between neighbours where numbers are metres; steep where places are not known.
  double slope_in_metres() const {
    const Map& map = info_.map;
    return map.is_placed() ? probe_.slope / (0.5 * (map.dx + map.dy)) : 1;
  }
  // Kilometres from the centre: heights of as many metres have slopes, and these have none.
  bool are_radii_in_km() const {
    const double km = info_.map.radius / 1000;
    return lies_about(km) && probe_.least > 0.95 * km && probe_.largest < 1.05 * km &&
           slope_in_metres() < kFlat;
  }

  bool guess_unit() {
    const double r = info_.map.radius;
    const bool near_m = r > 0 && (std::fabs(info_.offset / r - 1) < 0.2 || lies_about(r));
    const bool near_km =
        r > 0 && (std::fabs(info_.offset * 1000 / r - 1) < 0.2 || are_radii_in_km());
    if (near_m != near_km) {
      found_.unit = near_m ? 1 : 1000;
      o_.note(fmt::format("the unit is not stated: numbers are the radius of the body in {}",
                          near_m ? "metres" : "kilometres"));
      return true;
    }
    if (probe_.count == 0) {
      found_.unit = 1;
      return true;
    }
    const double slope = slope_in_metres();
    if (slope < kFlat && slope * 1000 < kSteep)
      return doubt(
          fmt::format("the unit of heights is not stated, and {} may be metres (slopes of "
                      "{:.2g} degrees) or kilometres (of {:.2g} degrees)",
                      range(), std::atan(slope) / kDegree, std::atan(1000 * slope) / kDegree),
          "--unit m or --unit km; --values plain where they are no heights");
    found_.unit = 1;
    o_.note("the unit of heights is not stated: metres are assumed", "--unit km");
    return true;
  }

  // Heights that another unit explains better, or that are radii of another body.
  bool check_heights() const {
    const double r = info_.map.radius, unit = *found_.unit;
    if (probe_.count == 0 || !(r > 0)) return true;
    const double most = std::max(std::fabs(probe_.least), std::fabs(probe_.largest)) * unit;
    if (info_.unit_stated && unit == 1 && are_radii_in_km())
      return doubt(fmt::format("the file states metres as its unit, and {} are radii of a body of "
                               "{} m in kilometres",
                               range(), r),
                   "--unit km, or --unit m with --values height");
    if (most > 0.5 * r)
      return doubt(
          fmt::format("numbers from {} are neither heights over a sphere of {} m nor radii "
                      "near it",
                      range(), r),
          "--values height or --values radius; --radius METRES where the body is another");
    return true;
  }

  const Opening& o_;
  Found& found_;
  DemInfo& info_;
  const Probe& probe_;
};

// Edges of a part of the map, degrees: of its border, `inset` pixels within.
Bounds bounds_of(const DemInfo& info, const Map& map, double inset) {
  Bounds out{1e9, -1e9, 1e9, -1e9};
  const double w = info.width - inset, h = info.height - inset;
  const LatLon middle = map.at(info.width / 2.0, info.height / 2.0);
  constexpr int kSteps = 64;
  const auto add = [&](double column, double row) {
    LatLon p = map.at(column, row);
    if (map.kind == Map::Kind::cylindrical)
      p.longitude = map.center_longitude +
                    map.point(column, row).x /
                        (map.radius * det::cos(map.standard_latitude * kDegree)) / kDegree;
    else
      p.longitude -= 360 * std::round((p.longitude - middle.longitude) / 360);
    out.west = std::min(out.west, p.longitude);
    out.east = std::max(out.east, p.longitude);
    out.south = std::min(out.south, p.latitude);
    out.north = std::max(out.north, p.latitude);
  };
  for (int k = 0; k <= kSteps; ++k) {
    const double t = double(k) / kSteps;
    add(inset + t * (w - inset), inset);
    add(inset + t * (w - inset), h);
    add(inset, inset + t * (h - inset));
    add(w, inset + t * (h - inset));
  }
  return out;
}

// Largest distance of the stated edges from those of the map moved by (x, y) pixels, in pixels.
// Bounds may be those of pixels or of their centres.
double misfit(const DemInfo& info, const Bounds& stated, double x, double y) {
  Map map = info.map;
  map.left += x * map.dx;
  map.top -= y * map.dy;
  double best = 1e9;
  for (const double inset : {0.0, 0.5}) {
    const Bounds b = bounds_of(info, map, inset);
    const double latitude = 0.5 * (b.south + b.north) * kDegree;
    const double across = map.radius * kDegree * det::cos(latitude) / map.dx *
                          (map.kind == Map::Kind::cylindrical
                               ? det::cos(map.standard_latitude * kDegree) / det::cos(latitude)
                               : 1);
    const double down = map.radius * kDegree / map.dy;
    const auto turn = [](double degrees) { return degrees - 360 * std::round(degrees / 360); };
    best = std::min(best, std::max({std::fabs(turn(b.west - stated.west)) * across,
                                    std::fabs(turn(b.east - stated.east)) * across,
                                    std::fabs(b.south - stated.south) * down,
                                    std::fabs(b.north - stated.north) * down}));
  }
  return best;
}

// Compares the map's place with the edges that its label states. False: in doubt.
bool check_place(const Opening& o, Found& found) {
  DemInfo& info = found.info;
  if (!found.bounds || !info.map.is_placed()) return true;
  if (info.map.kind == Map::Kind::polar) {
    // a border around the pole has no west and east
    const Vec2 pole = info.map.pixel({info.map.north ? 90.0 : -90.0, 0}, info.width);
    if (pole.x > -1 && pole.x < info.width + 1 && pole.y > -1 && pole.y < info.height + 1)
      return true;
  }
  constexpr double kGood = 0.1, kBad = 0.4;
  if (misfit(info, *found.bounds, 0, 0) < kBad) return true;
  constexpr double kShifts[] = {-1, -0.5, 0, 0.5, 1};
  double best = kGood, at_x = 0, at_y = 0;
  for (const double x : kShifts)
    for (const double y : kShifts)
      if (const double fit = misfit(info, *found.bounds, x, y); fit < best)
        best = fit, at_x = x, at_y = y;
  if (best >= kGood) return true;  // bounds of another extent
  if (o.options.place_by_bounds.value_or(false)) {
    info.map.left += at_x * info.map.dx;
    info.map.top -= at_y * info.map.dy;
    o.note(
        fmt::format("the map is moved by ({:+}, {:+}) pixels, to its stated bounds", at_x, at_y));
    return true;
  }
  if (o.options.place_by_bounds.has_value()) return true;
  o.log.report_file(
      Code("E9602"), o.name,
      fmt::format("the place of the map is in doubt: its offsets put it {:+} columns and {:+} rows "
                  "of pixels from its stated bounds (a habit of some writers)",
                  -at_x, -at_y),
      "--place bounds or --place offsets");
  return false;
}

// Bodies by name: equatorial radius, metres (IAU 2015).
constexpr struct {
  std::string_view name;
  double radius;
} kBodies[] = {
    {"MERCURY", 2440530},  {"VENUS", 6051800}, {"EARTH", 6378137},  {"MOON", 1738100},
    {"LUNA", 1738100},     {"MARS", 3396190},  {"WGS", 6378137},    {"PHOBOS", 13000},
    {"DEIMOS", 7800},      {"IO", 1829400},    {"EUROPA", 1562600}, {"GANYMEDE", 2631200},
    {"CALLISTO", 2410300}, {"TITAN", 2575150}, {"CERES", 487300},   {"PLUTO", 1188300}};

// Whether a name stands in a text as a word; digits and underscores end words.
bool has_word(std::string_view text, std::string_view word) {
  const auto letter = [](char c) { return c >= 'A' && c <= 'Z'; };
  for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !letter(text[at - 1])) && (end == text.size() || !letter(text[end])))
      return true;
  }
  return false;
}

// Compares the map's radius with the bodies that the file names. False: in doubt.
bool check_body(const Opening& o, Found& found) {
  Map& map = found.info.map;
  if (map.kind == Map::Kind::none || !(map.radius > 0)) return true;
  const std::string cited = upper_case(found.cited);
  const bool local = cited.find("LOCALRADIUS") != cited.npos;
  if (o.options.radius) {
    // its metres were made with the local radius
    const double scale =
        local && found.cited_radius > 0 ? *o.options.radius / found.cited_radius : 1;
    for (double* each : {&map.left, &map.top, &map.dx, &map.dy}) *each *= scale;
    return true;
  }
  const auto doubt = [&](const std::string& problem, double radius) {
    o.log.report_file(Code("E9602"), o.name, problem,
                      fmt::format("--radius METRES, as {} of the body", radius));
    return false;
  };
  if (local)
    return doubt(fmt::format("the sphere of the map, {} m, is the radius of an ellipsoid at one "
                             "latitude (localRadius), not that of the body",
                             map.radius),
                 has_word(cited, "MARS") ? 3396190 : map.radius);
  const std::string target = upper_case(found.info.target);
  for (const auto& body : kBodies) {
    const std::string_view named = has_word(target, body.name) ? "TARGET" : "";
    if (named.empty() && !(target.empty() && has_word(cited, body.name))) continue;
    constexpr double kMost = 0.05;  // of small moons' radii, which authors choose
    if (std::fabs(map.radius / body.radius - 1) < kMost) continue;
    return doubt(fmt::format("the file names {}, whose radius is {} m, and its map has a radius of "
                             "{} m, that of another body",
                             body.name, body.radius, map.radius),
                 body.radius);
  }
  for (const auto& body : kBodies)
    if (!target.empty() && has_word(cited, body.name) &&
        std::fabs(map.radius / body.radius - 1) < 1e-3 && !has_word(target, body.name) &&
        std::ranges::any_of(kBodies, [&](const auto& b) { return has_word(target, b.name); }))
      return doubt(
          fmt::format("the file is of {}, and its map of {}", found.info.target, body.name),
          map.radius);
  return true;
}

std::string sample_words(const Found& found) { return found.layout.type.words(); }

bool check_data(const Opening& o, Found& found) {
  if (!found.data) return true;
  if (o.options.missing) found.rules.values.emplace_back(*o.options.missing, VoidKind::missing);
  RawLayout& layout = found.layout;
  layout.width = found.info.width;
  layout.height = found.info.height;
  layout.bands = found.info.bands;
  const std::uint64_t end = layout.end(), size = found.data->bytes().size();
  if (end != 0 && end <= size) {
    found.rows = raw_source(std::move(*found.data), layout, found.info.band, found.rules);
    return true;
  }
  (void)o.fail(
      fmt::format("{} x {} x {} samples need {} bytes, and {} has {}: it was cut short, or "
                  "the label is that of another file",
                  found.info.width, found.info.height, found.info.bands, end,
                  in_quotes(found.info.files.back()), size));
  return false;
}

}  // namespace

const char* void_name(VoidKind kind) {
  constexpr const char* kNames[kVoidKinds] = {"none",
                                              "missing",
                                              "null",
                                              "low_instrument",
                                              "low_representation",
                                              "high_instrument",
                                              "high_representation",
                                              "out_of_range",
                                              "not_finite",
                                              "undeclared"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::string_view text_of(const MappedFile& file) {
  return {reinterpret_cast<const char*>(file.bytes().data()), file.bytes().size()};
}

Result<MappedFile> Opening::beside(std::string_view file_name, DemInfo& info) const {
  // labels may name folders of other systems
  const std::size_t slash = file_name.find_last_of("/\\");
  const std::string base(slash == file_name.npos ? file_name : file_name.substr(slash + 1));
  const fs::path folder = path.parent_path().empty() ? fs::path(".") : path.parent_path();
  const auto found = in_folder(folder, base);
  if (!found) {
    (void)fail(fmt::format("the label names {}, which is not in its folder", in_quotes(file_name)));
    return failed;
  }
  const fs::path shown = path.parent_path().empty() ? found->filename() : *found;
  info.files.push_back(shown.string());
  return MappedFile::open(shown, log);
}

bool Opening::check_size(DemInfo& info) const {
  constexpr std::uint32_t kMostWidth = 1u << 24;
  if (info.width == 0 || info.height == 0 || info.bands == 0 || info.width > kMostWidth) {
    (void)fail(fmt::format("the size is {} x {} in {} bands, expected 1 to {} columns, and rows",
                           info.width, info.height, info.bands, kMostWidth));
    return false;
  }
  if (options.band >= 1 && options.band <= info.bands) {
    info.band = options.band;
    return true;
  }
  (void)fail(fmt::format("band {} is asked for, and the file has {}", options.band, info.bands));
  return false;
}

Result<Dem> Dem::open(const fs::path& path, const DemOptions& options, DiagnosticLog& log,
                      const Job& job) {
  try {
    Opening opening{path, path.string(), options, log, job};
    fs::path label;
    auto found = read_found(opening, true, label);
    if (!found && !label.empty()) {
      opening.path = label;
      opening.name = label.string();
      found = read_found(opening, false, label);
    }
    if (!found || !check_data(opening, *found)) return failed;
    DemInfo& info = found->info;
    info.sample = sample_words(*found);
    if (found->unknown_radius && info.map.kind != Map::Kind::none) {
      log.report_file(Code("E9602"), opening.name, "the file has a map and no radius of its body",
                      "--radius METRES, as 1737400 of the Moon");
      return failed;
    }
    if (!check_body(opening, *found)) return failed;
    if (options.spacing && info.map.kind == Map::Kind::none)
      info.map.dx = info.map.dy = *options.spacing;
    Probe probe;
    if (!probe_rows(*found->rows, info, probe, log, job)) return failed;
    if (!Settler(opening, *found, probe).settle() || !check_place(opening, *found)) return failed;
    Dem out;
    const double unit = info.quantity == Quantity::plain ? 1 : found->unit.value_or(1);
    out.factor_ = info.scale * unit;
    // one number: adding radii to heights of floats would round them
    const bool radius_in_offset =
        info.map.radius > 0 && std::fabs(info.offset * unit / info.map.radius - 1) < 0.2;
    out.shift_ = info.offset * unit;
    if (info.quantity == Quantity::radius ||
        (info.quantity == Quantity::height && radius_in_offset))
      out.shift_ -= info.map.radius;
    out.info_ = std::move(info);
    out.source_ = std::move(found->rows);
    return out;
  } catch (const Cancelled&) {
    log.report_file(Code("E0001"), path.string(), "reading was stopped");
    return failed;
  }
}

bool Dem::read(std::uint32_t first, std::uint32_t count, const RowsReceiver& to, DiagnosticLog& log,
               const Job& job) const {
  std::vector<double> heights;
  try {
    return source_->read(
        first, count,
        [&](const Rows& rows) {
          heights.resize(rows.heights.size());
          for (std::size_t i = 0; i < heights.size(); ++i)
            heights[i] = rows.heights[i] * factor_ + shift_;
          return to({rows.first, rows.count, heights, rows.voids});
        },
        log, job);
  } catch (const Cancelled&) {
    log.report_file(Code("E0001"), info_.files.front(), "reading was stopped");
    return false;
  }
}

}  // namespace panwright::terrain
