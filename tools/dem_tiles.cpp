#include "tools/dem_tiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text.h"
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

void show_terrain(const std::string& file, CommandContext& context) {
  const auto tiles = terrain::Tiles::open(file, context.log());
  if (tiles) report(*tiles, context);
}

void check_terrain(const std::string& file, DiagnosticLog& log, const Job& job) {
  DiagnosticLog unread;
  auto model = pan::Model::open(file, unread);
  if (!model) return;
  const auto tiles = terrain::Tiles::of(std::make_shared<const pan::Model>(*std::move(model)), log);
  if (tiles && *tiles) (void)(*tiles)->check(log, job);
}

}  // namespace panwright::tools
