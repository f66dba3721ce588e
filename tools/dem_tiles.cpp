#include "tools/dem_tiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/number_rows.h"
#include "base/text.h"
#include "terrain/ground.h"
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
}

bool read_places(const std::vector<std::string>& texts, CommandContext& context,
                 std::vector<terrain::LatLon>& out) {
  for (const std::string& text : texts) {
    auto numbers = numbers_in(text);
    if (text.ends_with(".csv") || text.ends_with(".txt")) {
      context.files().will_read(text);
      const auto read = read_number_rows(text, 2, Code("E0262"), context.log());
      if (!read) return false;
      numbers = *read;
    } else if (!numbers || numbers->size() != 2) {
      context.log().report(Code("E0201"), {},
                           fmt::format("--at is {}, expected two numbers, or a file with as many "
                                       "in each line (.csv)",
                                       in_quotes(text)));
      return false;
    }
    for (std::size_t i = 0; i + 1 < numbers->size(); i += 2)
      out.push_back({(*numbers)[i], (*numbers)[i + 1]});
  }
  return true;
}

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

void report_points(const std::vector<terrain::LatLon>& places,
                   const std::vector<terrain::GroundPoint>& points, CommandContext& context) {
  Json list = Json::array();
  const bool json = context.options().json;
  if (!json)
    print("\n{:>11} {:>11} {:>14} {:>9}  normal\n", "latitude", "longitude", "height", "slope");
  for (std::size_t i = 0; i < places.size(); ++i) {
    const terrain::GroundPoint& p = points[i];
    if (!json && p)
      print("{:>11.6f} {:>11.6f} {:>14.4f} {:>9.4f}  {:.6f} {:.6f} {:.6f}\n", places[i].latitude,
            places[i].longitude, p.height, p.slope / kDegree, p.normal.x, p.normal.y, p.normal.z);
    else if (!json)
      print("{:>11.6f} {:>11.6f} {:>14}\n", places[i].latitude, places[i].longitude, "none");
    if (!json) continue;
    Json one = {{"latitude", places[i].latitude}, {"longitude", places[i].longitude}};
    if (p)
      one.update({{"height", p.height},
                  {"slope_deg", p.slope / kDegree},
                  {"normal", {p.normal.x, p.normal.y, p.normal.z}},
                  {"position", {p.position.x, p.position.y, p.position.z}},
                  {"chart", p.chart}});
    list.push_back(std::move(one));
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

void show_terrain(const std::string& file, const std::vector<std::string>& places,
                  CommandContext& context) {
  std::vector<terrain::LatLon> wanted;
  if (!read_places(places, context, wanted)) return;
  auto tiles = terrain::Tiles::open(file, context.log());
  if (!tiles) return;
  if (places.empty()) return report(*tiles, context);
  const terrain::Ground ground(std::make_shared<const terrain::Tiles>(*std::move(tiles)));
  std::vector<terrain::GroundPoint> points(wanted.size());
  context.step("ask");
  const auto done = run_job(context.job(), context.log(), [&] {
    ground.at(wanted, points, context.job());
    return true;
  });
  if (!done) return;
  report(ground.tiles(), context);
  report_points(wanted, points, context);
  warn_of_places(ground.tiles(), wanted, points, context.log());
  for (std::uint32_t i = 0; i < ground.tiles().records().size(); ++i)
    if (ground.tiles().is_damaged(i))
      context.log().report_file(Code("E9611"), file,
                                terrain::tile_words(ground.tiles(), i) +
                                    " does not match its hash: it has no ground here");
}

void check_terrain(const std::string& file, DiagnosticLog& log, const Job& job) {
  DiagnosticLog unread;
  auto model = pan::Model::open(file, unread);
  if (!model) return;
  const auto tiles = terrain::Tiles::of(std::make_shared<const pan::Model>(*std::move(model)), log);
  if (tiles && *tiles) (void)(*tiles)->check(log, job);
}

}  // namespace panwright::tools
