// Elevation files of known heights: how fast their rows are read, and how far they are from the
// heights that were written.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>

#include "base/parallel.h"
#include "bench/bench.h"
#include "terrain/ground.h"
#include "terrain/survey.h"
#include "terrain/tile_writer.h"

namespace panwright::bench::case_terrain {

namespace {

double height_at(std::uint32_t column, std::uint32_t row) {
  return 1500 * std::sin(0.003 * column) * std::cos(0.002 * row) +
         3 * std::sin(0.7 * column + 0.3 * row);
}

struct Format {
  const char* name;
  const char* type;  // of PDS3; null: an ISIS cube of tiles
  unsigned bytes;
  bool big_endian;
  double step;  // metres of a stored number
};
constexpr Format kFormats[] = {{"PDS3 float", "PC_REAL", 4, false, 1},
                               {"PDS3 float, big-endian", "IEEE_REAL", 4, true, 1},
                               {"PDS3 16 bits", "LSB_INTEGER", 2, false, 0.5},
                               {"ISIS float, tiles", nullptr, 4, false, 1}};
constexpr std::uint32_t kTile = 128;

template <class T>
void append(std::string& to, T value, bool big) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof value);
  if (big) std::reverse(bytes, bytes + sizeof value);
  to.append(bytes, sizeof value);
}

void add_post(std::string& to, const Format& format, double height) {
  if (format.bytes == 4)
    append(to, static_cast<float>(height), format.big_endian);
  else
    append(to, static_cast<std::int16_t>(std::lround(height / format.step)), format.big_endian);
}

// Writes a file of a global map; returns the one to open.
std::filesystem::path write(const std::filesystem::path& folder, const Format& format,
                            std::uint32_t width, std::uint32_t height) {
  const std::filesystem::path path = folder / "heights.lbl", data = folder / "heights.img";
  std::ofstream out(data, std::ios::binary);
  std::string part;
  if (format.type != nullptr) {
    std::ofstream(path) << fmt::format(
        "PDS_VERSION_ID = PDS3\n^IMAGE = \"heights.img\"\nOBJECT = IMAGE\n LINES = {}\n"
        " LINE_SAMPLES = {}\n SAMPLE_TYPE = {}\n SAMPLE_BITS = {}\n UNIT = METER\n SCALING_FACTOR "
        "= {}\n"
        " OFFSET = 1737400\nEND_OBJECT\nOBJECT = IMAGE_MAP_PROJECTION\n"
        " MAP_PROJECTION_TYPE = \"SIMPLE CYLINDRICAL\"\n A_AXIS_RADIUS = 1737.4\n"
        " POSITIVE_LONGITUDE_DIRECTION = EAST\n CENTER_LONGITUDE = 180\n MAP_RESOLUTION = {}\n"
        " LINE_PROJECTION_OFFSET = {}\n SAMPLE_PROJECTION_OFFSET = {}\nEND_OBJECT\nEND\n",
        height, width, format.type, 8 * format.bytes, format.step, width / 360.0,
        height / 2.0 - 0.5, width / 2.0 - 0.5);
    for (std::uint32_t row = 0; row < height; ++row) {
      part.clear();
      for (std::uint32_t column = 0; column < width; ++column)
        add_post(part, format, height_at(column, row));
      out << part;
    }
    return path;
  }
  std::string label = fmt::format(
      "Object = IsisCube\n Object = Core\n  StartByte = 4097\n  Format = Tile\n  TileSamples = {}\n"
      "  TileLines = {}\n  Group = Dimensions\n   Samples = {}\n   Lines = {}\n   Bands = 1\n  "
      "End_Group\n"
      "  Group = Pixels\n   Type = Real\n   ByteOrder = Lsb\n   Base = 0\n   Multiplier = 1\n  "
      "End_Group\n"
      " End_Object\n Group = Mapping\n  ProjectionName = SimpleCylindrical\n  CenterLongitude = "
      "180\n"
      "  EquatorialRadius = 1737400 <meters>\n  LongitudeDirection = PositiveEast\n"
      "  UpperLeftCornerX = {} <meters>\n  UpperLeftCornerY = {} <meters>\n  PixelResolution = {} "
      "<meters>\n"
      " End_Group\nEnd_Object\nEnd\n",
      kTile, kTile, width, height, -1737400 * kPi, 1737400 * kPi * height / width,
      2 * 1737400 * kPi / width);
  label.resize(4096);
  out << label;
  for (std::uint32_t y = 0; y < height; y += kTile)
    for (std::uint32_t x = 0; x < width; x += kTile) {
      part.clear();
      for (std::uint32_t row = y; row < y + kTile; ++row)
        for (std::uint32_t column = x; column < x + kTile; ++column)
          add_post(part, format, height_at(column, row));
      out << part;
    }
  return data;
}

void run_terrain(Context& context) {
  // multiples of the tile
  const std::uint32_t width = context.quick() ? 512 : 8192, height = width / 2;
  for (const Format& format : kFormats) {
    const auto path = write(context.scratch(), format, width, height);
    DiagnosticLog log;
    const auto dem = terrain::Dem::open(path, {}, log);
    if (!dem) return context.note("a file cannot be read: " + to_text(log));
    double worst = 0;
    (void)dem->read(
        0, height,
        [&](const terrain::Rows& rows) {
          for (std::size_t i = 0; i < rows.heights.size(); ++i)
            worst = std::max(
                worst, std::fabs(rows.heights[i] -
                                 height_at(static_cast<std::uint32_t>(i % width),
                                           rows.first + static_cast<std::uint32_t>(i / width))));
          return true;
        },
        log);
    const double megabytes = double(width) * height * format.bytes / 1e6;
    Row row;
    row.case_name = "terrain";
    row.speed_unit = "MB/s";
    row.error = worst;
    row.error_unit = "m";
    row.reference = "heights that were written";
    row.reference_error = 1e-12;
    // half a stored step
    row.must_error = format.bytes == 4 ? 6.2e-5 : 0.25 + 1e-9;
    row.setting = fmt::format("{}, {} x {}: rows", format.name, width, height);
    set_rate(row,
             timed(
                 [&] {
                   (void)dem->read(
                       0, height, [](const terrain::Rows&) { return true; }, log);
                 },
                 context.runs()),
             megabytes);
    context.add(row);
    row.setting = fmt::format("{}, {} x {}: statistics and hillshade", format.name, width, height);
    set_rate(row,
             timed([&] { (void)terrain::survey(*dem, {1024}, log); }, std::min(context.runs(), 3)),
             megabytes);
    context.add(row);
  }
}

// Terrain of a pan file: made, checked, asked. The errors are of heights at posts.
void run_tiles(Context& context) {
  const std::uint32_t width = context.quick() ? 1024 : 4096, height = width / 2;
  const auto path = write(context.scratch(), kFormats[0], width, height);
  const auto pan = context.scratch() / "ground.pan";
  DiagnosticLog log;
  const auto dem = terrain::Dem::open(path, {}, log);
  if (!dem) return context.note("a file cannot be read: " + to_text(log));
  const double megaposts = double(width) * height / 1e6;
  for (const double error : {0.0, 0.05}) {
    Row row;
    row.case_name = "terrain_tiles";
    row.setting = fmt::format("{} x {}: {}", width, height,
                              error > 0 ? "written as codes" : "written as floats");
    row.speed_unit = "Mposts/s";
    row.error_unit = "m";
    row.reference = "heights of the file";
    row.reference_error = 1e-12;
    row.must_error = error > 0 ? error : 6.2e-5;
    set_rate(row,
             timed(
                 [&] {
                   const auto report = terrain::write_tiles({&*dem, 1}, pan, {error}, log);
                   row.error = report ? report->error : 1e9;
                 },
                 1),
             megaposts);
    context.add(row);
  }
  auto tiles = terrain::Tiles::open(pan, log);
  if (!tiles) return context.note("no terrain: " + to_text(log));
  const terrain::Ground ground(std::make_shared<const terrain::Tiles>(*std::move(tiles)));
  Row row;
  row.case_name = "terrain_tiles";
  row.error_unit = "m";
  row.reference_error = 1e-12;
  row.setting = "all tiles checked";
  row.speed_unit = "MB/s";
  row.reference = "their hashes";
  row.must_error = 0;
  set_rate(row, timed([&] { row.error = ground.tiles().check(log) ? 0 : 1; }, context.runs()),
           double(std::filesystem::file_size(pan)) / 1e6);
  context.add(row);

  const std::size_t count = context.quick() ? 10'000 : 1'000'000;
  std::vector<terrain::LatLon> places(count);
  std::vector<double> want(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto x = static_cast<std::uint32_t>(i * 7919 % width),
               y = static_cast<std::uint32_t>(i * 104729 % (height - 2) + 1);
    places[i] = dem->info().map.at(x + 0.5, y + 0.5);
    want[i] = height_at(x, y);
  }
  std::vector<terrain::GroundPoint> points(count);
  row.setting = "heights, normals, slopes at places";
  row.speed_unit = "Mplaces/s";
  row.reference = "heights at posts";
  row.must_error = 0.03125 + 6.2e-5;  // half a stored step, and the file's floats
  set_rate(row, timed([&] { ground.at(places, points); }, context.runs()), double(count) / 1e6);
  row.error = 0;
  for (std::size_t i = 0; i < count; ++i)
    row.error = std::max(row.error, points[i] ? std::fabs(points[i].height - want[i]) : 1e9);
  context.add(row);
}

const bool kTilesAdded =
    add_case({"terrain_tiles", "terrain of a pan file: made, checked, asked", run_tiles});
const bool kAdded = add_case({"terrain", "elevation files: rows and statistics", run_terrain});

}  // namespace
}  // namespace panwright::bench::case_terrain
