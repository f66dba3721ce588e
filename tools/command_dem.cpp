#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/hash.h"
#include "base/text.h"
#include "image/png.h"
#include "terrain/shape.h"
#include "terrain/survey.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/dem_tiles.h"
#include "tools/print.h"
#include "workspace/open.h"
#include "workspace/shape_scene.h"

namespace panwright::tools {

namespace command_dem {
namespace {

using Json = nlohmann::ordered_json;
using terrain::LatLon;
using terrain::Quantity;

struct Options {
  CommonOptions common;
  std::vector<std::string> files;
  TerrainQuestions questions;
  std::string output, unit, values, positive, place, light = "315 45";
  double error = 0;
  std::optional<double> radius, spacing, missing, data_offset;
  std::uint32_t band = 1, size = 1024;
};

void declare_all(Arguments& arguments, Options& options) {
  arguments
      .add("files", options.files,
           "Elevation file, its label, a shape model, or terrain of a pan file (docs/terrain.md); "
           "several for terrain, the first where they overlap")
      .required()
      .type("FILE…");
  arguments.add("-o,--output", options.output, "Hillshade (.png) or terrain (.pan) to write")
      .type("FILE");
  arguments
      .add("--error", options.error,
           "Metres by which stored heights of terrain may differ from the file's (default 0: exact "
           "floats)")
      .type("METRES")
      .range(0, 1e6);
  arguments
      .add("--at", options.questions.places,
           "Place to tell height, normal and slope of, of terrain, and a pose and a Sun there: "
           "latitude and longitude, degrees (of a plane y and x, metres), metres above the ground "
           "(default 0), or a file with one place a line (.csv); may be repeated")
      .one_value()
      .numbers()
      .type("\"LAT LON [UP]\"|FILE");
  arguments
      .add("--sight", options.questions.sights,
           "Line of sight over terrain: two places, each with metres above its ground, or a file "
           "with one line of sight a line (.csv); may be repeated")
      .one_value()
      .numbers()
      .type("\"LAT LON UP LAT LON UP\"|FILE");
  arguments
      .add("--range", options.questions.ranges,
           "Distance to terrain from a place, metres above its ground, along an azimuth from north "
           "clockwise and an elevation, degrees, or a file (.csv); may be repeated")
      .one_value()
      .numbers()
      .type("\"LAT LON UP AZ EL\"|FILE");
  arguments.add("--size", options.size, "Longest side of the hillshade, pixels (default 1024)")
      .type("PIXELS")
      .range(16, 16384);
  arguments
      .add("--light", options.light,
           "Azimuth and elevation of the light of the hillshade, degrees, from the top of the map "
           "clockwise, or at --at from the north (default \"315 45\")")
      .type("\"AZ EL\"")
      .numbers();
  arguments.add("--unit", options.unit, "Unit of heights or vertices: m, km, or metres of a number")
      .type("UNIT");
  arguments
      .add("--values", options.values,
           "Meaning of numbers: heights over the sphere, radii, or plain ones, no elevations")
      .type("MEANING")
      .one_of({"height", "radius", "plain"});
  arguments.add("--radius", options.radius, "Radius of the body's sphere, metres")
      .type("METRES")
      .finite()
      .positive();
  arguments.add("--spacing", options.spacing, "Metres between pixels, of files without a map")
      .type("METRES")
      .finite()
      .positive();
  arguments.add("--void", options.missing, "One more stored value that stands for no height")
      .type("VALUE");
  arguments.add("--positive", options.positive, "Direction in which longitudes count")
      .type("SENSE")
      .one_of({"east", "west"});
  arguments
      .add("--place", options.place,
           "Place a map whose label contradicts itself by its offsets or bounds")
      .type("BY")
      .one_of({"offsets", "bounds"});
  arguments
      .add("--data-offset", options.data_offset, "Bytes before the first sample of the data file")
      .type("BYTES")
      .range(0, 1e15);
  arguments.add("--band", options.band, "Band to read, from 1 (default 1)").type("N");
  declare(arguments, options.common);
}

std::optional<double> unit_of(const std::string& given, DiagnosticLog& log) {
  if (given.empty()) return std::nullopt;
  if (given == "m") return 1;
  if (given == "km") return 1000;
  const auto metres = parse_double(given);
  if (!metres || !(*metres > 0) || *metres > 1e9)
    log.report(Code("E0201"), {},
               fmt::format("--unit is {}, expected m, km, or metres above 0", in_quotes(given)));
  return metres;
}

terrain::DemOptions dem_options(const Options& options, DiagnosticLog& log) {
  terrain::DemOptions out;
  out.band = options.band;
  out.unit = unit_of(options.unit, log);
  if (options.values == "height") out.quantity = Quantity::height;
  if (options.values == "radius") out.quantity = Quantity::radius;
  if (options.values == "plain") out.quantity = Quantity::plain;
  out.radius = options.radius;
  out.spacing = options.spacing;
  out.missing = options.missing;
  if (!options.positive.empty()) out.positive_west = options.positive == "west";
  if (!options.place.empty()) out.place_by_bounds = options.place == "bounds";
  if (options.data_offset) out.data_offset = static_cast<std::uint64_t>(*options.data_offset);
  return out;
}

terrain::SurveyOptions survey_options(const Options& options, DiagnosticLog& log) {
  terrain::SurveyOptions out;
  if (!options.output.empty()) out.hillshade = options.size;
  const std::size_t space = options.light.find_first_of(" ,");
  const auto azimuth = parse_double(options.light.substr(0, space));
  const auto elevation =
      space == std::string::npos ? std::nullopt : parse_double(options.light.substr(space + 1));
  if (azimuth && elevation && std::fabs(*azimuth) <= 360 && *elevation > 0 && *elevation <= 90) {
    out.sun_azimuth = *azimuth;
    out.sun_elevation = *elevation;
  } else {
    log.report(Code("E0201"), {},
               fmt::format("--light is {}, expected an azimuth and an elevation above 0 to 90 "
                           "degrees",
                           in_quotes(options.light)));
  }
  return out;
}

const char* quantity_name(Quantity quantity) {
  return quantity == Quantity::plain ? "plain" : quantity == Quantity::radius ? "radius" : "height";
}

class DemReport {
 public:
  DemReport(const terrain::Dem& dem, const terrain::Survey& survey, bool json, Json& out)
      : info_(dem.info()), map_(info_.map), s_(survey), json_(json), out_(out) {}

  void run() {
    file();
    place();
    heights();
    slopes();
  }

 private:
  template <class... Args>
  void say(fmt::format_string<Args...> text, Args&&... args) const {
    if (!json_) print("{}\n", fmt::format(text, std::forward<Args>(args)...));
  }
  const char* metre() const { return info_.quantity == Quantity::plain ? "" : " m"; }

  void file() {
    out_["kind"] = "raster";
    out_["format"] = info_.format;
    out_["files"] = info_.files;
    out_["width"] = info_.width;
    out_["height"] = info_.height;
    out_["bands"] = info_.bands;
    out_["band"] = info_.band;
    out_["sample"] = info_.sample;
    out_["values"] = quantity_name(info_.quantity);
    out_["unit"] = info_.unit;
    out_["unit_stated"] = info_.unit_stated;
    out_["scale"] = info_.scale;
    out_["offset"] = info_.offset;
    say("{}: {} x {} posts{}, {}", info_.format, info_.width, info_.height,
        info_.bands > 1 ? fmt::format(", band {} of {}", info_.band, info_.bands) : "",
        info_.sample);
    std::string meaning = info_.quantity == Quantity::plain    ? "numbers, no elevations"
                          : info_.quantity == Quantity::radius ? "radii"
                                                               : "heights";
    if (!info_.unit.empty())
      meaning += fmt::format(" in {}{}", info_.unit, info_.unit_stated ? "" : " (not stated)");
    if (info_.scale != 1 || info_.offset != 0)
      meaning += fmt::format(", stored x {} + {}", info_.scale, info_.offset);
    say("values           {}", meaning);
  }

  void place() {
    if (!info_.target.empty()) out_["target"] = info_.target;
    if (!info_.frame.empty()) out_["frame"] = info_.frame;
    out_["projection"] = info_.projection;
    out_["placed"] = map_.is_placed();
    out_["pixel_m"] = {map_.dx, map_.dy};
    out_["corner_m"] = {map_.left, map_.top};
    if (!info_.target.empty() || !info_.frame.empty())
      say("body             {}{}{}", info_.target, info_.frame.empty() ? "" : ", ", info_.frame);
    if (!map_.is_placed() && (map_.dx == 0 || map_.dy == 0))
      return say("place            none: pixels of unknown size");
    if (!map_.is_placed())
      return say("place            none: pixels of {} x {} m", map_.dx, map_.dy);
    out_["radius_m"] = map_.radius;
    out_["polar_radius_m"] = map_.polar_radius;
    out_["positive_longitude"] = map_.positive_west ? "west" : "east";
    out_["longitude_domain"] = map_.domain;
    out_["center_longitude_deg"] = map_.center_longitude;
    say("sphere           {} m{}", map_.radius,
        map_.polar_radius != map_.radius ? fmt::format(" (poles {} m)", map_.polar_radius) : "");
    say("projection       {}, {} x {} m a pixel; outer corner of the first at ({:.10g}, {:.10g}) m",
        info_.projection, map_.dx, map_.dy, map_.left, map_.top);
    say("longitudes       the file counts them to the {}; here to the east, in {}",
        map_.positive_west ? "west" : "east", map_.domain == 360 ? "0 to 360" : "-180 to 180");
    const double w = info_.width, h = info_.height;
    const struct {
      const char* name;
      double column, row;
    } points[] = {{"upper_left", 0, 0},
                  {"upper_right", w, 0},
                  {"lower_left", 0, h},
                  {"lower_right", w, h},
                  {"center", w / 2, h / 2}};
    Json corners;
    for (const auto& point : points) {
      const LatLon at = map_.at(point.column, point.row);
      corners[point.name] = {at.latitude, at.longitude};
      say("  {:<14} {:>10.5f} {:>11.5f}", point.name, at.latitude, at.longitude);
    }
    out_["corners_deg"] = std::move(corners);
  }

  void extreme(const char* name, const terrain::Extreme& of) {
    Json& out = out_[name];
    out = {{"column", of.column}, {"row", of.row}, {"posts", of.posts}};
    std::string place;
    if (map_.is_placed()) {
      const LatLon at = map_.at(of.column + 0.5, of.row + 0.5);
      out["latitude"] = at.latitude;
      out["longitude"] = at.longitude;
      place = fmt::format(", {:.5f} {:.5f}", at.latitude, at.longitude);
    }
    say("{:<16} {:.10g}{} at column {}, row {}{}", name, of.height, metre(), of.column, of.row,
        place);
  }

  void heights() {
    const auto number = [&](double value) { return s_.valid > 0 ? Json(value) : Json(nullptr); };
    out_["min"] = number(s_.least.height);
    out_["max"] = number(s_.largest.height);
    out_["mean"] = number(s_.mean);
    out_["deviation"] = number(s_.deviation);
    out_["valid"] = s_.valid;
    out_["voids"] = s_.void_posts();
    Json kinds = Json::object();
    std::string words;
    for (std::size_t k = 1; k < terrain::kVoidKinds; ++k) {
      if (s_.voids[k] == 0) continue;
      const char* name = terrain::void_name(static_cast<terrain::VoidKind>(k));
      kinds[name] = s_.voids[k];
      words += fmt::format("{}{} {}", words.empty() ? "" : ", ", s_.voids[k], name);
    }
    out_["voids_by_kind"] = std::move(kinds);
    if (info_.missing) out_["missing_constant"] = *info_.missing;
    if (s_.valid > 0) {
      extreme("lowest", s_.least);
      extreme("highest", s_.largest);
      say("mean             {:.10g}{}, standard deviation {:.6g}{}", s_.mean, metre(), s_.deviation,
          metre());
    }
    say("void             {} of {} posts{}", s_.void_posts(), s_.void_posts() + s_.valid,
        words.empty() ? "" : ": " + words);
  }

  void slopes() {
    Json list = Json::array();
    if (!s_.slopes.empty())
      say("\nslope along rows and columns, degrees\n    metres     RMS  median");
    for (const auto& each : s_.slopes) {
      list.push_back({{"posts", each.posts},
                      {"metres", each.metres},
                      {"rms_deg", each.rms},
                      {"median_deg", each.median},
                      {"pairs", each.pairs}});
      say("{:>10.5g} {:>7.3f} {:>7.3f}", each.metres, each.rms, each.median);
    }
    out_["slopes"] = std::move(list);
    if (s_.slope_rows > 1) say("of every row whose number is a multiple of {}", s_.slope_rows);
    out_["slope_rows"] = s_.slope_rows;
  }

  const terrain::DemInfo& info_;
  const terrain::Map& map_;
  const terrain::Survey& s_;
  bool json_;
  Json& out_;
};

void report_shape(const terrain::Shape& shape, const std::string& file, bool json, Json& out) {
  const terrain::ShapeSurvey s = terrain::survey_shape(shape);
  out["kind"] = "shape";
  out["format"] = shape.format;
  out["files"] = {file};
  out["unit"] = shape.unit;
  out["unit_stated"] = shape.unit_stated;
  if (!shape.body.empty()) out["target"] = shape.body;
  if (!shape.frame.empty()) out["frame"] = shape.frame;
  out["vertices"] = shape.vertices.size();
  out["plates"] = shape.plates.size();
  out["min"] = s.least.radius;
  out["max"] = s.largest.radius;
  for (const auto& [name, at] : {std::pair{"lowest", &s.least}, {"highest", &s.largest}})
    out[name] = {{"latitude", at->place.latitude}, {"longitude", at->place.longitude}};
  const Vec3 size = s.high - s.low;
  out["size_m"] = {size.x, size.y, size.z};
  out["area_m2"] = s.area;
  out["volume_m3"] = s.volume;
  out["centroid_m"] = {s.centroid.x, s.centroid.y, s.centroid.z};
  out["open_edges"] = s.open_edges;
  out["flat_plates"] = s.flat_plates;
  if (json) return;
  print("{}: {} vertices, {} plates, in {}{}\n", shape.format, shape.vertices.size(),
        shape.plates.size(), shape.unit, shape.unit_stated ? "" : " (not stated)");
  if (!shape.body.empty()) print("body             {}, frame {} (NAIF)\n", shape.body, shape.frame);
  print("size             {:.6g} x {:.6g} x {:.6g} m\n", size.x, size.y, size.z);
  print("lowest           {:.8g} m from the origin, {:.4f} {:.4f}\n", s.least.radius,
        s.least.place.latitude, s.least.place.longitude);
  print("highest          {:.8g} m, {:.4f} {:.4f}\n", s.largest.radius, s.largest.place.latitude,
        s.largest.place.longitude);
  print(
      "area             {:.6g} m2, volume {:.6g} m3, its centroid at ({:.4g}, {:.4g}, {:.4g}) m\n",
      s.area, s.volume, s.centroid.x, s.centroid.y, s.centroid.z);
  print("edges            {}\n", s.open_edges == 0
                                     ? std::string("closed")
                                     : counted(s.open_edges, "edge") + " not of two plates");
}

bool write_png(const std::string& path, std::uint32_t width, std::uint32_t height,
               const std::vector<std::uint8_t>& pixels, CommandContext& context,
               const std::string& detail) {
  image::PngOptions png;
  png.channels = 3;
  if (!write_file(path, as_bytes(image::png_file(width, height, pixels, png)), context.log()))
    return false;
  context.wrote(path, detail);
  return true;
}

// A model of the shape, for images.
void write_shape(const terrain::Shape& shape, const Options& options, CommandContext& context) {
  const std::string& file = options.files.front();
  const std::filesystem::path path(file);
  scene::Scene scene = workspace::shape_scene(shape, path.stem().string());
  const auto mapped = MappedFile::open(path, context.log());
  if (!mapped) return;
  scene.inputs.push_back(
      {path.filename().string(), hash128(mapped->bytes()), mapped->bytes().size()});
  context.step("write");
  workspace::OpenOptions open;
  open.prune = false;
  workspace::WriteOptions write;
  write.output = options.output;
  write.origin = fmt::format(" unit={}", shape.unit);
  if (workspace::write_pan(scene, open, write, context.log(), context.job()))
    context.wrote(options.output, counted(scene.instances.size(), "small body"));
}

void run_shape(const Options& options, CommandContext& context) {
  terrain::ShapeOptions shape_options;
  shape_options.unit = unit_of(options.unit, context.log());
  const auto shape = terrain::read_shape(options.files.front(), shape_options, context.log());
  if (!shape) return;
  report_shape(*shape, options.files.front(), options.common.json, context.result());
  if (options.output.empty()) return;
  if (options.output.ends_with(".pan")) return write_shape(*shape, options, context);
  const std::uint32_t side = std::max(16u, options.size / 3);
  write_png(options.output, 3 * side, side, terrain::draw_shape(*shape, side), context,
            "from +x, +y and +z");
}

int run(const Options& options, const Host& host) {
  CommandContext context("dem", options.common, host);
  DiagnosticLog& log = context.log();
  const auto reading = dem_options(options, log);
  const auto surveying = survey_options(options, log);
  if (log.has_errors()) return context.finish();
  const std::string& output = options.output;
  const std::string& file = options.files.front();
  const bool tiles = output.ends_with(".pan"), of_tiles = file.ends_with(".pan");
  if (!output.empty() && !tiles && !output.ends_with(".png") && !output.ends_with(".PNG"))
    log.report_file(Code("E0202"), output,
                    "expected a name ending in .png, a hillshade, or .pan, terrain");
  if (options.files.size() > 1 && !tiles)
    log.report(Code("E0201"), {}, "several files make one terrain: -o NAME.pan");
  if (of_tiles && !output.empty())
    log.report(Code("E0201"), {},
               "-o needs an elevation file: terrain of a pan file is shown only");
  if (!of_tiles && options.questions.any())
    log.report(Code("E0201"), {},
               "--at, --sight and --range need terrain of a pan file: -o NAME.pan makes it");
  if (log.has_errors() || (!output.empty() && !context.files().will_write(output, "-o", log)))
    return context.finish();
  if (options.files.size() > 1 && terrain::is_shape(file))
    log.report(Code("E0201"), {}, "a shape model is one file, expected no other beside it");
  if (log.has_errors()) return context.finish();
  for (const std::string& each : options.files)
    if (!require_file(each, log)) return context.finish();
  if (of_tiles) {
    TerrainQuestions questions = options.questions;
    questions.light = kDegree * Vec2(surveying.sun_azimuth, surveying.sun_elevation);
    show_terrain(file, questions, context);
    return context.finish();
  }
  if (terrain::is_shape(file)) {
    run_shape(options, context);
    return context.finish();
  }
  if (tiles) {
    write_terrain(options.files, reading, output, options.error, context);
    return context.finish();
  }
  const Job& job = context.job();
  context.step("read");
  const auto dem = terrain::Dem::open(file, reading, log, job);
  if (!dem) return context.finish();
  const auto survey = terrain::survey(*dem, surveying, log, job);
  if (!survey) return context.finish();
  DemReport(*dem, *survey, options.common.json, context.result()).run();
  if (options.output.empty() || survey->valid == 0) return context.finish();
  context.step("write");
  context.result()["exaggeration"] = survey->exaggeration;
  write_png(options.output, survey->shade_width, survey->shade_height, survey->shade, context,
            fmt::format("{} x {} pixels of {} posts a side, heights x {}", survey->shade_width,
                        survey->shade_height, survey->block, survey->exaggeration));
  return context.finish();
}

}  // namespace
}  // namespace command_dem

Command dem_command() {
  return command("dem",
                 "Show elevation files and shape models; draw a hillshade; store them as terrain",
                 command_dem::declare_all, command_dem::run);
}

}  // namespace panwright::tools
