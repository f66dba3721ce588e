#include "tests/terrain/made_files.h"

#include <gtest/gtest.h>

#include <cmath>

#include "terrain/tile_writer.h"
#include "tests/support/process.h"

namespace panwright::terrain::testing_support {

const std::string kMoonMap =
    "OBJECT = IMAGE_MAP_PROJECTION\n MAP_PROJECTION_TYPE = \"SIMPLE CYLINDRICAL\"\n"
    " A_AXIS_RADIUS = 1737.4 <km>\n POSITIVE_LONGITUDE_DIRECTION = EAST\n CENTER_LATITUDE = 0\n"
    " CENTER_LONGITUDE = 180 <deg>\n MAP_RESOLUTION = 0.0111111111111111111 <pix/deg>\n"
    " LINE_PROJECTION_OFFSET = 1.0\n SAMPLE_PROJECTION_OFFSET = 1.5\nEND_OBJECT\n";

std::string pds3_label(const std::string& pointer, const std::string& more,
                       const std::string& map) {
  return "PDS_VERSION_ID = PDS3\r\n/* a comment = with words */\r\nRECORD_BYTES = 16\r\n^IMAGE = " +
         pointer + "\r\nOBJECT = IMAGE\r\n LINES = 3\r\n LINE_SAMPLES = 4\r\n" + more +
         "END_OBJECT = IMAGE\r\n" + map + "END\r\n";
}

std::string dsk_file(const std::vector<std::array<double, 3>>& vertices,
                     const std::vector<std::array<std::int32_t, 3>>& plates, bool big) {
  constexpr std::size_t kRecordBytes = 1024;
  // integers: head of 3, descriptor of 8, then the segment's; doubles: 34, then vertices
  std::vector<std::int32_t> whole{1000001, 4, 4};
  const auto nv = static_cast<std::int32_t>(vertices.size()),
             np = static_cast<std::int32_t>(plates.size());
  const std::vector<std::int32_t> descriptor{-1, -1, 11, 10 + 3 * np, 0, 34 + 3 * nv, 0, 0};
  whole.insert(whole.end(), descriptor.begin(), descriptor.end());
  const std::vector<std::int32_t> counts{nv, np, 1, 1, 1, 1, 1, 1, 1, 1};
  whole.insert(whole.end(), counts.begin(), counts.end());
  for (const auto& plate : plates) whole.insert(whole.end(), plate.begin(), plate.end());
  std::vector<double> reals(34, 0.0);
  reals[0] = 7, reals[1] = 2101955, reals[2] = 1, reals[3] = 2, reals[4] = 10105;
  for (const auto& vertex : vertices) reals.insert(reals.end(), vertex.begin(), vertex.end());

  const auto records = [](std::size_t words, std::size_t each) {
    return (words + each - 1) / each;
  };
  const auto double_records = static_cast<std::int32_t>(records(reals.size(), 128));
  const auto integer_records = static_cast<std::int32_t>(records(whole.size(), 256));
  std::string file(kRecordBytes, '\0');
  std::memcpy(file.data(), "DAS/DSK ", 8);
  std::memcpy(file.data() + 84, big ? "BIG-IEEE" : "LTL-IEEE", 8);
  std::vector<std::int32_t> directory(256, 0);
  directory[4] = 1, directory[5] = static_cast<std::int32_t>(reals.size());
  directory[6] = 1, directory[7] = static_cast<std::int32_t>(whole.size());
  directory[8] = 2;  // doubles come first
  directory[9] = double_records;
  directory[10] = integer_records;  // positive: the next type of the cycle
  for (const std::int32_t word : directory) file += bytes_of(word, big);
  std::string part;
  for (const double value : reals) part += bytes_of(value, big);
  part.resize(static_cast<std::size_t>(double_records) * kRecordBytes);
  file += part;
  part.clear();
  for (const std::int32_t value : whole) part += bytes_of(value, big);
  part.resize(static_cast<std::size_t>(integer_records) * kRecordBytes);
  return file + part;
}

Vec3 place_of(Kind kind, std::uint32_t x, std::uint32_t y, double z, std::uint32_t width,
              std::uint32_t height) {
  if (kind == Kind::plane) return {10.0 * x + 5, -10.0 * y - 5, z};
  double latitude = 0, longitude = 0;
  if (kind == Kind::cylindrical) {
    // 0.1 degrees a pixel, the middle of the map at 0, 0
    longitude = (x + 0.5 - width / 2.0) * 0.1 * kPi / 180;
    latitude = (height / 2.0 - y - 0.5) * 0.1 * kPi / 180;
  } else {
    // 100 m a pixel about the south pole, true there
    const double mx = (x + 0.5 - width / 2.0) * 100, my = (height / 2.0 - y - 0.5) * 100;
    const double rho = std::hypot(mx, my);
    latitude = 2 * std::atan(rho / (2 * kRadius)) - kPi / 2;
    longitude = std::atan2(mx, my);
  }
  const double r = kRadius + z;
  return {r * std::cos(latitude) * std::cos(longitude),
          r * std::cos(latitude) * std::sin(longitude), r * std::sin(latitude)};
}

std::string label_of(Kind kind, std::uint32_t width, std::uint32_t height) {
  const std::string size = "ENVI\nsamples = " + std::to_string(width) +
                           "\nlines = " + std::to_string(height) +
                           "\nbands = 1\ndata type = 4\nbyte order = 0\n";
  if (kind == Kind::plane) return size + "map info = {Local, 1, 1, 0, 0, 10, 10}\n";
  std::string text = "PDS_VERSION_ID = PDS3\nRECORD_TYPE = FIXED_LENGTH\nRECORD_BYTES = " +
                     std::to_string(4 * width) + "\nFILE_RECORDS = " + std::to_string(height) +
                     "\n^IMAGE = \"a.img\"\nOBJECT = IMAGE\n LINES = " + std::to_string(height) +
                     "\n LINE_SAMPLES = " + std::to_string(width) +
                     "\n SAMPLE_TYPE = PC_REAL\n SAMPLE_BITS = 32\n UNIT = METER\nEND_OBJECT = "
                     "IMAGE\nOBJECT = IMAGE_MAP_PROJECTION\n A_AXIS_RADIUS = 50 <km>\n "
                     "POSITIVE_LONGITUDE_DIRECTION = EAST\n CENTER_LONGITUDE = 0\n "
                     "LINE_PROJECTION_OFFSET = " +
                     std::to_string((height - 1) / 2.0) +
                     "\n SAMPLE_PROJECTION_OFFSET = " + std::to_string((width - 1) / 2.0) + "\n";
  text += kind == Kind::cylindrical
              ? " MAP_PROJECTION_TYPE = \"SIMPLE CYLINDRICAL\"\n CENTER_LATITUDE = 0\n "
                "MAP_RESOLUTION = 10 <pix/deg>\n"
              : " MAP_PROJECTION_TYPE = \"POLAR STEREOGRAPHIC\"\n CENTER_LATITUDE = -90\n "
                "MAP_SCALE = 100 <m/pix>\n";
  return text + "END_OBJECT = IMAGE_MAP_PROJECTION\nEND\n";
}

std::shared_ptr<const Tiles> tiles_of(Kind kind, const std::string& data,
                                      const std::string& label) {
  const bool plane = kind == Kind::plane;
  const support::TemporaryFolder folder;
  (void)folder.write(plane ? "a.dat" : "a.img", data);
  const std::string path = folder.write(plane ? "a.hdr" : "a.lbl", label);
  DiagnosticLog log;
  DemOptions reading;
  reading.unit = 1;
  reading.quantity = Quantity::height;
  const auto dem = Dem::open(path, reading, log);
  EXPECT_TRUE(dem) << to_text(log);
  if (!dem) return {};
  EXPECT_EQ(dem->info().map.is_placed(), !plane);
  EXPECT_TRUE(write_tiles({&*dem, 1}, folder / "a.pan", {}, log)) << to_text(log);
  auto tiles = Tiles::open(folder / "a.pan", log);
  EXPECT_TRUE(tiles) << to_text(log);
  return tiles ? std::make_shared<const Tiles>(*std::move(tiles)) : nullptr;
}

}  // namespace panwright::terrain::testing_support
