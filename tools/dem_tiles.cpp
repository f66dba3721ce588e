#include "tools/dem_tiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/number_rows.h"
#include "base/text.h"
#include "terrain/ground.h"
#include "terrain/sights.h"
#include "terrain/tile_writer.h"
#include "terrain/tiles.h"
#include "tools/print.h"

namespace panwright::tools {

namespace {

using Json = nlohmann::ordered_json;
using terrain::ChartRecord;
using terrain::Map;
using terrain::TileForm;

const char* projection_name(const ChartRecord& chart) {
  switch (static_cast<Map::Kind>(chart.kind)) {
    case Map::Kind::cylindrical:
      return "cylindrical";
    case Map::Kind::polar:
      return "polar stereographic";
    default:
      return "plane";
  }
}

Json chart_json(const ChartRecord& chart, std::uint64_t voids) {
  return {{"target", std::string(terrain::field_text(chart.body))},
          {"frame", std::string(terrain::field_text(chart.frame))},
          {"projection", projection_name(chart)},
          {"width", chart.width},
          {"height", chart.height},
          {"pixel_m", {chart.dx, chart.dy}},
          {"radius_m", chart.radius},
          {"levels", chart.levels},
          {"tiles", chart.tile_count},
          {"step_m", chart.step},
          {"error_m", chart.error},
          {"min", chart.low},
          {"max", chart.high},
          {"void_tiles", voids}};
}

void print_chart(std::size_t i, const ChartRecord& chart, std::uint64_t voids) {
  const std::string body(terrain::field_text(chart.body));
  print("chart {:<10} {}{} x {} posts, {}, {:.6g} x {:.6g} m apart\n", i,
        body.empty() ? "" : body + ": ", chart.width, chart.height, projection_name(chart),
        chart.dx, chart.dy);
  print(
      "  heights        {:.10g} to {:.10g} m, {}\n", chart.low, chart.high,
      chart.step > 0 ? fmt::format("in steps of {:.10g} m", chart.step) : std::string("as floats"));
  print("  error          {:.3g} m at most between stored heights and their source\n", chart.error);
  print("  tiles          {} in {} levels{}\n", chart.tile_count, chart.levels,
        voids > 0 ? fmt::format(", {} of them void", voids) : "");
}

void report_albedo(const terrain::Tiles& tiles, CommandContext& context) {
  if (tiles.albedo().empty()) return;
  Json list = Json::array();
  for (const terrain::AlbedoRecord& map : tiles.albedo().maps()) {
    const double largest = map.unit * (terrain::kNoAlbedo - 1);
    list.push_back({{"width", map.width},
                    {"height", map.height},
                    {"bands", map.channels},
                    {"pixel_m", {map.dx, map.dy}},
                    {"mean", map.mean},
                    {"largest", largest}});
    if (!context.options().json)
      print(
          "albedo map {:<5} {} x {} pixels, {}, {:.6g} x {:.6g} m; the ground's colour times "
          "{:.4g} in the mean, {:.4g} at most\n",
          list.size() - 1, map.width, map.height, map.channels == 3 ? "RGB" : "grey", map.dx,
          map.dy, map.mean, largest);
  }
  context.result()["albedo"] = std::move(list);
}

void report(const terrain::Tiles& tiles, CommandContext& context) {
  Json& out = context.result();
  const bool json = context.options().json;
  out["kind"] = "terrain";
  out["format"] = "pan";
  out["files"] = {tiles.name()};
  out["unit"] = "m";
  out["unit_stated"] = true;
  double low = tiles.charts().front().low, high = tiles.charts().front().high;
  for (const ChartRecord& chart : tiles.charts()) {
    low = std::min(low, chart.low);
    high = std::max(high, chart.high);
  }
  out["min"] = low;
  out["max"] = high;
  out["bytes"] = tiles.model().bytes().size();
  if (!json) print("{}: {}\n", tiles.name(), counted(tiles.model().bytes().size(), "byte"));
  Json charts = Json::array();
  for (std::size_t i = 0; i < tiles.charts().size(); ++i) {
    const ChartRecord& chart = tiles.charts()[i];
    const auto records = tiles.records().subspan(chart.first_tile, chart.tile_count);
    const auto voids = static_cast<std::uint64_t>(
        std::ranges::count(records, std::uint32_t(TileForm::nothing), &terrain::TileRecord::form));
    charts.push_back(chart_json(chart, voids));
    if (!json) print_chart(i, chart, voids);
  }
  out["charts"] = std::move(charts);
  report_albedo(tiles, context);
}

// Rows of numbers of all texts of an option; each is such a row, or a file of rows. A text may have
// `more` numbers behind, which are 0 elsewhere.
bool read_rows(const std::vector<std::string>& texts, const char* option, std::size_t columns,
               std::size_t more, CommandContext& context, std::vector<double>& out) {
  for (const std::string& text : texts) {
    auto numbers = numbers_in(text);
    std::size_t own = columns;
    if (text.ends_with(".csv") || text.ends_with(".txt")) {
      context.files().will_read(text);
      const auto read = read_number_rows(text, columns, Code("E0262"), context.log());
      if (!read) return false;
      numbers = *read;
    } else if (!numbers || (numbers->size() != columns && numbers->size() != columns + more)) {
      context.log().report(
          Code("E0201"), {},
          fmt::format("{} is {}, expected {}{} numbers, or a file with {} in each line (.csv)",
                      option, in_quotes(text), columns,
                      more > 0 ? fmt::format(" or {}", columns + more) : "", columns));
      return false;
    } else {
      own = numbers->size();
    }
    for (std::size_t i = 0; i + own <= numbers->size(); i += own) {
      const auto row = numbers->begin() + static_cast<std::ptrdiff_t>(i);
      out.insert(out.end(), row, row + static_cast<std::ptrdiff_t>(own));
      out.resize(out.size() + columns + more - own);
    }
  }
  return true;
}

// A place of --at, and metres over its ground.
struct Place {
  terrain::LatLon at;
  double above = 0;
};

// Latitudes and longitudes of a chart's posts, or y and x of a plane.
std::string extent_of(const ChartRecord& chart) {
  const Map map = terrain::map_of(chart);
  const double right = chart.width - 0.5, bottom = chart.height - 0.5;
  if (!map.is_placed()) {
    const Vec2 low = map.point(0.5, bottom), high = map.point(right, 0.5);
    return fmt::format("y {:.8g} to {:.8g} m, x {:.8g} to {:.8g} m", low.y, high.y, low.x, high.x);
  }
  if (map.kind == Map::Kind::polar) {
    const auto corner = map.at(0.5, 0.5);
    return fmt::format("around the {} pole, a corner at latitude {:.6g}",
                       map.north ? "north" : "south", corner.latitude);
  }
  if (chart.flags & terrain::kChartWraps)
    return fmt::format("latitudes {:.6g} to {:.6g}, all longitudes", map.at(0.5, bottom).latitude,
                       map.at(0.5, 0.5).latitude);
  return fmt::format("latitudes {:.6g} to {:.6g}, longitudes {:.6g} to {:.6g}",
                     map.at(0.5, bottom).latitude, map.at(0.5, 0.5).latitude,
                     map.at(0.5, 0.5).longitude, map.at(right, 0.5).longitude);
}

bool is_inside(const ChartRecord& chart, const terrain::LatLon& place) {
  const Map map = terrain::map_of(chart);
  Vec2 pixel((place.longitude - map.left) / map.dx, (map.top - place.latitude) / map.dy);
  if (map.is_placed()) pixel = map.pixel(place, chart.width);
  return pixel.x >= 0.5 && pixel.x <= chart.width - 0.5 && pixel.y >= 0.5 &&
         pixel.y <= chart.height - 0.5;
}

// One warning for the places outside of all charts, one for those in voids.
void warn_of_places(const terrain::Tiles& tiles, const std::vector<terrain::LatLon>& places,
                    const std::vector<terrain::GroundPoint>& points, DiagnosticLog& log) {
  std::vector<std::size_t> outside, voids;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (points[i]) continue;
    const bool held = std::ranges::any_of(
        tiles.charts(), [&](const ChartRecord& chart) { return is_inside(chart, places[i]); });
    (held ? voids : outside).push_back(i);
  }
  const auto warn = [&](const std::vector<std::size_t>& at, const std::string& why) {
    if (at.empty()) return;
    const terrain::LatLon& first = places[at.front()];
    log.report_file(
        Code("W9670"), tiles.name(),
        fmt::format(
            "{}{:.8g} {:.8g} {}",
            at.size() > 1 ? fmt::format("{} places have no ground, the first: ", at.size()) : "",
            first.latitude, first.longitude, why));
  };
  const std::size_t charts = tiles.charts().size();
  warn(outside, fmt::format("is outside of the terrain, {}{}", extent_of(tiles.charts().front()),
                            charts > 1 ? fmt::format(" and {} more charts", charts - 1) : ""));
  warn(voids, "is in a void");
}

void report_points(const terrain::Ground& ground, const std::vector<Place>& places,
                   const std::vector<terrain::GroundPoint>& points, const Vec2& light,
                   CommandContext& context) {
  constexpr std::size_t kMostPoses = 16;
  Json list = Json::array();
  const bool json = context.options().json;
  if (!json)
    print("\n{:>11} {:>11} {:>14} {:>9}  normal\n", "latitude", "longitude", "height", "slope");
  for (std::size_t i = 0; i < places.size(); ++i) {
    const terrain::LatLon& place = places[i].at;
    const terrain::GroundPoint& p = points[i];
    // z up, y to the north
    const terrain::LocalAxes axes = terrain::local_axes(ground, place);
    const Quat q = glm::normalize(glm::quat_cast(Mat3(axes.east, axes.north, axes.up)));
    const Vec3 at = p.position + places[i].above * axes.up;
    const Vec3 sun = terrain::direction_at(axes, light.x, light.y);
    if (json) {
      Json one = {{"latitude", place.latitude}, {"longitude", place.longitude}};
      if (p)
        one.update({{"height", p.height},
                    {"slope_deg", p.slope / kDegree},
                    {"normal", {p.normal.x, p.normal.y, p.normal.z}},
                    {"position", {at.x, at.y, at.z}},
                    {"upright", {q.w, q.x, q.y, q.z}},
                    {"sun", {sun.x, sun.y, sun.z}},
                    {"chart", p.chart}});
      list.push_back(std::move(one));
    } else if (!p) {
      print("{:>11.6f} {:>11.6f} {:>14}\n", place.latitude, place.longitude, "none");
    } else {
      print("{:>11.6f} {:>11.6f} {:>14.4f} {:>9.4f}  {:.6f} {:.6f} {:.6f}\n", place.latitude,
            place.longitude, p.height, p.slope / kDegree, p.normal.x, p.normal.y, p.normal.z);
      if (places.size() > kMostPoses) continue;
      print(
          "  upright there: --pose NAME=\"{:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} "
          "{:.10g}\"\n",
          at.x, at.y, at.z, q.w, q.x, q.y, q.z);
      print("  light of azimuth {:g}, elevation {:g}: --sun \"{:.6f} {:.6f} {:.6f}\"\n",
            light.x / kDegree, light.y / kDegree, sun.x, sun.y, sun.z);
    }
  }
  if (json) context.result()["points"] = std::move(list);
}

}  // namespace

void write_terrain(const std::vector<std::string>& files, const terrain::DemOptions& reading,
                   const std::string& output, double error, CommandContext& context) {
  DiagnosticLog& log = context.log();
  context.step("write");
  std::vector<terrain::Dem> dems;
  for (const std::string& file : files) {
    auto dem = terrain::Dem::open(file, reading, log, context.job());
    if (!dem) return;
    dems.push_back(*std::move(dem));
  }
  const auto written =
      terrain::write_tiles(dems, output, terrain::TilesOptions{error}, log, context.job());
  if (!written) return;
  const auto tiles = terrain::Tiles::open(output, log);
  if (!tiles) return;
  report(*tiles, context);
  context.wrote(output, counted(written->tiles, "tile"));
}

namespace {

constexpr double kSlack = 1e-4;  // metres from both ends that do not count

// Questions of lines of sight and ranges, and their answers.
class Looking {
 public:
  Looking(const terrain::Ground& ground, CommandContext& context)
      : ground_(ground), context_(context), json_(context.options().json) {}

  void sights(const std::vector<double>& rows) {
    Json list = Json::array();
    if (!json_ && !rows.empty()) print("\n");
    for (std::size_t i = 0; i + 6 <= rows.size(); i += 6) {
      const auto from = point(&rows[i]), to = point(&rows[i + 3]);
      Json one = {{"asked", std::vector<double>(&rows[i], &rows[i] + 6)}};
      std::string words = "no ground";
      if (from && to) {
        const Vec3 line = *to - *from;
        const double length = glm::length(line);
        const auto hit = length > 2 * kSlack
                             ? ground_.nearest(*from, line / length, kSlack, length - kSlack)
                             : std::nullopt;
        one["open"] = !hit;
        one["distance"] = length;
        words = fmt::format("open, {:.10g} m", length);
        if (hit) words = "blocked by " + met(*hit, one);
      }
      if (!json_) print("{} to {}: {}\n", asked(&rows[i], 3), asked(&rows[i + 3], 3), words);
      list.push_back(std::move(one));
    }
    if (json_ && !list.empty()) context_.result()["sights"] = std::move(list);
  }

  void ranges(const std::vector<double>& rows) {
    Json list = Json::array();
    if (!json_ && !rows.empty()) print("\n");
    for (std::size_t i = 0; i + 5 <= rows.size(); i += 5) {
      const auto from = point(&rows[i]);
      Json one = {{"asked", std::vector<double>(&rows[i], &rows[i] + 5)}};
      std::string words = from ? "nothing" : "no ground";
      if (from) {
        const Vec3 along =
            terrain::direction_at(terrain::local_axes(ground_, {rows[i], rows[i + 1]}),
                                  rows[i + 3] * kDegree, rows[i + 4] * kDegree);
        if (const auto hit = ground_.nearest(*from, along, kSlack)) words = met(*hit, one);
      }
      if (!json_) print("{} along {}: {}\n", asked(&rows[i], 3), asked(&rows[i + 3], 2), words);
      list.push_back(std::move(one));
    }
    if (json_ && !list.empty()) context_.result()["ranges"] = std::move(list);
  }

 private:
  std::optional<Vec3> point(const double* row) const {
    return terrain::point_above(ground_, {row[0], row[1]}, row[2]);
  }
  static std::string asked(const double* row, std::size_t count) {
    return fmt::format("{}", fmt::join(std::span(row, count), " "));
  }

  // Ground that a ray meets, in words and JSON.
  std::string met(const terrain::GroundHit& hit, Json& one) const {
    const Vec3& p = hit.point.position;
    terrain::LatLon place{p.y, p.x};
    if (ground_.tiles().map(0).is_placed())
      place = {det::atan2(p.z, std::hypot(p.x, p.y)) / kDegree, det::atan2(p.y, p.x) / kDegree};
    one["range"] = hit.distance;
    one["latitude"] = place.latitude;
    one["longitude"] = place.longitude;
    one["height"] = hit.point.height;
    return fmt::format("the ground at {:.8g} {:.8g}, {:.10g} m away, {:.8g} m high", place.latitude,
                       place.longitude, hit.distance, hit.point.height);
  }

  const terrain::Ground& ground_;
  CommandContext& context_;
  bool json_;
};

}  // namespace

void show_terrain(const std::string& file, const TerrainQuestions& questions,
                  CommandContext& context) {
  std::vector<double> numbers, sights, ranges;
  if (!read_rows(questions.places, "--at", 2, 1, context, numbers) ||
      !read_rows(questions.sights, "--sight", 6, 0, context, sights) ||
      !read_rows(questions.ranges, "--range", 5, 0, context, ranges))
    return;
  auto tiles = terrain::Tiles::open(file, context.log());
  if (!tiles) return;
  if (!questions.any()) return report(*tiles, context);
  const terrain::Ground ground(std::make_shared<const terrain::Tiles>(*std::move(tiles)));
  std::vector<Place> places;
  std::vector<terrain::LatLon> wanted;
  for (std::size_t i = 0; i + 3 <= numbers.size(); i += 3) {
    places.push_back({{numbers[i], numbers[i + 1]}, numbers[i + 2]});
    wanted.push_back(places.back().at);
  }
  std::vector<terrain::GroundPoint> points(wanted.size());
  context.step("ask");
  const auto done = run_job(context.job(), context.log(), [&] {
    ground.at(wanted, points, context.job());
    return true;
  });
  if (!done) return;
  report(ground.tiles(), context);
  if (!wanted.empty()) report_points(ground, places, points, questions.light, context);
  warn_of_places(ground.tiles(), wanted, points, context.log());
  Looking looking(ground, context);
  looking.sights(sights);
  looking.ranges(ranges);
  ground.tiles().report_damaged(context.log());
}

void check_terrain(const std::string& file, DiagnosticLog& log, const Job& job) {
  DiagnosticLog unread;
  auto model = pan::Model::open(file, unread);
  if (!model) return;
  const auto tiles = terrain::Tiles::of(std::make_shared<const pan::Model>(*std::move(model)), log);
  if (tiles && *tiles) (void)(*tiles)->check(log, job);
}

}  // namespace panwright::tools
