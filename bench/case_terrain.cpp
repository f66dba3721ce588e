// Elevation files of known heights: how fast their rows are read, and how far they are from the
// heights that were written.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>

#include "bench/bench.h"
#include "terrain/survey.h"

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

const bool kAdded = add_case({"terrain", "elevation files: rows and statistics", run_terrain});

}  // namespace
}  // namespace panwright::bench::case_terrain
