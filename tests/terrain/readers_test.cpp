// Readers of elevation files against files made here: types, layouts, voids, meanings, damage.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "terrain/dem.h"
#include "tests/support/process.h"
#include "tests/terrain/made_files.h"

namespace panwright::terrain::readers_test {
namespace {

using support::TemporaryFolder;
using testing_support::bytes_of;
using testing_support::kMoonMap;
using testing_support::pds3_label;

struct Read {
  bool good = false;
  DemInfo info;
  std::vector<double> posts;
  std::vector<VoidKind> voids;
  std::string log;
};

Read read(const std::string& path, const DemOptions& options = {}) {
  Read out;
  DiagnosticLog log;
  const auto dem = Dem::open(path, options, log);
  if (dem) {
    out.info = dem->info();
    out.good = dem->read(
        0, out.info.height,
        [&](const Rows& rows) {
          out.posts.insert(out.posts.end(), rows.heights.begin(), rows.heights.end());
          out.voids.insert(out.voids.end(), rows.voids.begin(), rows.voids.end());
          return true;
        },
        log);
  }
  out.log = to_text(log);
  EXPECT_NE(out.good, log.has_errors());
  return out;
}

// Heights of the 4 x 3 posts: 0, 100 … 1100.
std::vector<double> ramp() {
  std::vector<double> out;
  for (int k = 0; k < 12; ++k) out.push_back(100.0 * k);
  return out;
}

template <class T>
void expect_type(const char* name, bool big) {
  const TemporaryFolder folder;
  std::string data;
  for (const double value : ramp()) {
    const double stored = sizeof(T) == 1 ? value / 100 : value;
    data += bytes_of(static_cast<T>(stored), big);
  }
  const std::string scale = sizeof(T) == 1 ? " SCALING_FACTOR = 100\n" : "";
  const std::string path = folder.write(
      "a.lbl", pds3_label("\"A.IMG\"",
                          fmt::format(" SAMPLE_TYPE = {}\n SAMPLE_BITS = {}\n UNIT = METER\n{}",
                                      name, 8 * sizeof(T), scale),
                          kMoonMap));
  (void)folder.write("a.img", data);
  const Read file = read(path);
  EXPECT_EQ(file.posts, ramp()) << name << file.log;
}

TEST(Pds3, SampleTypes) {
  expect_type<std::int16_t>("LSB_INTEGER", false);
  expect_type<std::int16_t>("PC_INTEGER", false);
  expect_type<std::int16_t>("VAX_INTEGER", false);
  expect_type<std::int16_t>("MSB_INTEGER", true);
  expect_type<std::int16_t>("SUN_INTEGER", true);
  expect_type<std::int16_t>("INTEGER", true);
  expect_type<std::uint16_t>("LSB_UNSIGNED_INTEGER", false);
  expect_type<std::uint16_t>("UNSIGNED_INTEGER", true);
  expect_type<std::int32_t>("MSB_INTEGER", true);
  expect_type<std::uint32_t>("PC_UNSIGNED_INTEGER", false);
  expect_type<std::uint8_t>("UNSIGNED_INTEGER", true);
  expect_type<std::int8_t>("LSB_INTEGER", false);
  expect_type<float>("PC_REAL", false);
  expect_type<float>("IEEE_REAL", true);
  expect_type<double>("PC_REAL", false);
  expect_type<double>("SUN_REAL", true);
}

// F_floating of a VAX: 1.0 is the bytes 80 40 00 00, -7.5 is F0 C1 00 00 (VAX Architecture
// Reference Manual, 2).
TEST(Pds3, VaxReals) {
  const TemporaryFolder folder;
  const std::string one("\x80\x40\0\0", 4), other("\xf0\xc1\0\0", 4), reserved("\0\x80\0\0", 4);
  std::string data = one + other + reserved;
  for (int k = 3; k < 12; ++k) data += one;
  (void)folder.write("a.img", data);
  const Read file = read(folder.write(
      "a.lbl", pds3_label("\"a.img\"", " SAMPLE_TYPE = VAX_REAL\n SAMPLE_BITS = 32\n UNIT = M\n",
                          kMoonMap)));
  ASSERT_TRUE(file.good) << file.log;
  EXPECT_EQ(file.posts[0], 1);
  EXPECT_EQ(file.posts[1], -7.5);
  EXPECT_EQ(file.voids[2], VoidKind::not_finite);
}

// Two bands in three orders, with bytes before and after each line.
TEST(Pds3, BandsAndBytesAroundLines) {
  for (const char* order : {"BAND_SEQUENTIAL", "LINE_INTERLEAVED", "SAMPLE_INTERLEAVED"}) {
    const TemporaryFolder folder;
    const std::string name = order, before = "<<<", after = ">>";
    const auto post = [&](int band, int line, int sample) {
      return bytes_of(static_cast<std::int16_t>(band * 1000 + 10 * line + sample), false);
    };
    std::string data;
    if (name == "SAMPLE_INTERLEAVED") {
      for (int line = 0; line < 3; ++line) {
        data += before;
        for (int sample = 0; sample < 4; ++sample)
          for (int band = 0; band < 2; ++band) data += post(band, line, sample);
        data += after;
      }
    } else {
      const bool by_band = name == "BAND_SEQUENTIAL";
      for (int outer = 0; outer < (by_band ? 2 : 3); ++outer)
        for (int inner = 0; inner < (by_band ? 3 : 2); ++inner) {
          data += before;
          for (int sample = 0; sample < 4; ++sample)
            data += by_band ? post(outer, inner, sample) : post(inner, outer, sample);
          data += after;
        }
    }
    (void)folder.write("a.img", data);
    DemOptions options;
    options.band = 2;
    const std::string path = folder.write(
        "a.lbl", pds3_label("(\"a.img\", 1)",
                            fmt::format(" SAMPLE_TYPE = PC_INTEGER\n SAMPLE_BITS = 16\n UNIT = M\n"
                                        " BANDS = 2\n BAND_STORAGE_TYPE = {}\n"
                                        " LINE_PREFIX_BYTES = 3\n LINE_SUFFIX_BYTES = 2\n",
                                        order),
                            kMoonMap));
    const Read file = read(path, options);
    ASSERT_EQ(file.posts.size(), 12u) << order << file.log;
    for (int k = 0; k < 12; ++k)
      EXPECT_EQ(file.posts[static_cast<std::size_t>(k)], 1000 + 10 * (k / 4) + k % 4) << order;
    options.band = 3;
    EXPECT_NE(read(path, options).log.find("band 3"), std::string::npos);
  }
}

std::string float_file(const std::vector<double>& values) {
  std::string out;
  for (const double value : values) out += bytes_of(static_cast<float>(value), false);
  return out;
}

Read read_floats(const std::string& data, const std::string& more, const DemOptions& options = {},
                 const std::string& map = kMoonMap) {
  const TemporaryFolder folder;
  (void)folder.write("a.img", data);
  return read(
      folder.write("a.lbl", pds3_label("\"a.img\"",
                                       " SAMPLE_TYPE = PC_REAL\n SAMPLE_BITS = 32\n" + more, map)),
      options);
}

TEST(Voids, ByKind) {
  std::string data = float_file(ramp());
  const std::uint32_t patterns[] = {0xff7ffffb, 0x7fc00000, 0xff7ffffd};
  for (std::size_t k = 0; k < 3; ++k) data.replace(4 * k, 4, bytes_of(patterns[k], false));
  data.replace(12, 4, bytes_of(-32768.0f, false));
  data.replace(16, 4, bytes_of(9999.0f, false));
  const Read file = read_floats(data,
                                " UNIT = METER\n MISSING_CONSTANT = (16#FF7FFFFB#, -32768)\n"
                                " VALID_MAXIMUM = 5000\n");
  ASSERT_TRUE(file.good) << file.log;
  using K = VoidKind;
  const K expected[] = {K::missing, K::not_finite,   K::out_of_range,
                        K::missing, K::out_of_range, K::none};
  for (std::size_t k = 0; k < 6; ++k) {
    // the largest negative float is below any valid range, if none is stated it is undeclared
    if (k == 2)
      EXPECT_EQ(file.voids[k], K::undeclared);
    else
      EXPECT_EQ(file.voids[k], expected[k]) << k;
    EXPECT_EQ(std::isnan(file.posts[k]), k < 5) << k;
  }
}

// A constant that is written with fewer digits than the float has.
TEST(Voids, RoundedConstant) {
  std::vector<double> values = ramp();
  values[3] = -3.40282265508890445e38;
  const Read file =
      read_floats(float_file(values), " UNIT = METER\n MISSING_CONSTANT = -3.40282e+38\n");
  ASSERT_TRUE(file.good) << file.log;
  EXPECT_EQ(file.voids[3], VoidKind::missing);
}

TEST(Meaning, UnitsAndRadii) {
  std::vector<double> km = ramp();
  for (double& value : km) value /= 1000;
  // stated kilometres
  EXPECT_NEAR(read_floats(float_file(km), " UNIT = KILOMETER\n").posts[11], 1100, 1e-4);
  // radii in kilometres without a unit: the body's radius tells
  std::vector<double> radii = km;
  for (double& value : radii) value += 1737.4;
  const Read by_radius = read_floats(float_file(radii), "");
  EXPECT_EQ(by_radius.info.quantity, Quantity::radius);
  EXPECT_EQ(by_radius.info.unit, "km");
  EXPECT_NEAR(by_radius.posts[11], 1100, 0.07);  // half an ulp of a float of 1738 is 6 cm
  // stated metres, and the numbers are kilometres
  EXPECT_NE(read_floats(float_file(radii), " UNIT = METER\n").log.find("--unit km"),
            std::string::npos);
  // heights of metres that look like a radius in kilometres are heights: they have slopes
  std::vector<double> high = ramp();
  for (double& value : high) value = 1700 + value / 20;
  std::string fine = kMoonMap;
  fine.replace(fine.find("0.0111111111111111111"), 21, "3000");
  EXPECT_EQ(read_floats(float_file(high), " UNIT = METER\n", {}, fine).info.quantity,
            Quantity::height);
  // neither: in doubt
  const Read doubt = read_floats(float_file(km), "");
  EXPECT_FALSE(doubt.good);
  EXPECT_NE(doubt.log.find("--unit"), std::string::npos) << doubt.log;
  DemOptions options;
  options.unit = 1000;
  EXPECT_NEAR(read_floats(float_file(km), "", options).posts[11], 1100, 1e-4);
  // radii of another body
  std::vector<double> mars = ramp();
  for (double& value : mars) value += 3396190;
  EXPECT_NE(read_floats(float_file(mars), " UNIT = METER\n").log.find("--radius"),
            std::string::npos);
  options.unit.reset();
  options.quantity = Quantity::plain;
  EXPECT_EQ(read_floats(float_file(mars), "", options).posts[11], 3396190 + 1100);
}

// An offset that is the radius does not round heights: 1737400 has steps of 0.125 in floats.
TEST(Meaning, OffsetIsTheRadius) {
  std::vector<double> values = ramp();
  values[1] = 100.01f;
  const Read file = read_floats(float_file(values), " UNIT = METER\n OFFSET = 1737400.0\n");
  EXPECT_EQ(file.info.quantity, Quantity::radius);
  EXPECT_EQ(file.posts[1], double(100.01f));
}

TEST(Place, BoundsAgainstOffsets) {
  const std::string bounds =
      " MAXIMUM_LATITUDE = 135\n MINIMUM_LATITUDE = -135\n WESTERNMOST_LONGITUDE = 0\n"
      " EASTERNMOST_LONGITUDE = 360\nEND_OBJECT\n";
  const auto map = [&](const char* line, const char* sample) {
    return "OBJECT = IMAGE_MAP_PROJECTION\n MAP_PROJECTION_TYPE = \"SIMPLE CYLINDRICAL\"\n"
           " A_AXIS_RADIUS = 1737.4 <km>\n POSITIVE_LONGITUDE_DIRECTION = EAST\n"
           " CENTER_LONGITUDE = 180\n MAP_RESOLUTION = 0.01111111111111111 <pix/deg>\n"
           " LINE_PROJECTION_OFFSET = " +
           std::string(line) + "\n SAMPLE_PROJECTION_OFFSET = " + sample + "\n" + bounds;
  };
  const std::string data = float_file(ramp());
  EXPECT_TRUE(read_floats(data, " UNIT = M\n", {}, map("1.0", "1.5")).good);
  // the corner's offset, and that of the next pixel (isis2pds)
  for (const auto& [line, sample] : {std::pair{"1.5", "2.0"}, {"2.0", "2.5"}}) {
    const Read doubt = read_floats(data, " UNIT = M\n", {}, map(line, sample));
    EXPECT_FALSE(doubt.good) << line;
    EXPECT_NE(doubt.log.find("--place bounds"), std::string::npos) << doubt.log;
    DemOptions options;
    options.place_by_bounds = true;
    const Read moved = read_floats(data, " UNIT = M\n", options, map(line, sample));
    ASSERT_TRUE(moved.good) << moved.log;
    EXPECT_NEAR(moved.info.map.at(0.5, 0.5).longitude, 45, 1e-9);
    EXPECT_NEAR(moved.info.map.at(0.5, 1.5).latitude, 0, 1e-9);
    options.place_by_bounds = false;
    EXPECT_TRUE(read_floats(data, " UNIT = M\n", options, map(line, sample)).good);
  }
}

TEST(Place, LongitudesToTheWest) {
  std::string map = kMoonMap;
  map.replace(map.find("EAST"), 4, "WEST");
  map.replace(map.find("180 <deg>"), 9, "90 <deg> ");
  const Read file = read_floats(float_file(ramp()), " UNIT = M\n", {}, map);
  ASSERT_TRUE(file.good) << file.log;
  // 90 W is the middle; the picture still has east to the right
  EXPECT_NEAR(file.info.map.at(2, 1.5).longitude, -90, 1e-9);
  EXPECT_NEAR(file.info.map.at(3, 1.5).longitude, 0, 1e-9);
  DemOptions options;
  options.positive_west = false;
  EXPECT_NEAR(
      read_floats(float_file(ramp()), " UNIT = M\n", options, map).info.map.at(2, 1.5).longitude,
      90, 1e-9);
}

// Bounds may be stated in the other domain of longitudes; a shift of half a pixel is still found.
TEST(Place, BoundsInTheOtherDomain) {
  const auto map = [](const char* sample) {
    return "OBJECT = IMAGE_MAP_PROJECTION\n MAP_PROJECTION_TYPE = \"SIMPLE CYLINDRICAL\"\n"
           " A_AXIS_RADIUS = 1737.4 <km>\n POSITIVE_LONGITUDE_DIRECTION = EAST\n"
           " CENTER_LONGITUDE = 250\n MAP_RESOLUTION = 1 <pix/deg>\n"
           " LINE_PROJECTION_OFFSET = 1.0\n SAMPLE_PROJECTION_OFFSET = " +
           std::string(sample) +
           "\n MAXIMUM_LATITUDE = 1.5\n MINIMUM_LATITUDE = -1.5\n"
           " WESTERNMOST_LONGITUDE = -112\n EASTERNMOST_LONGITUDE = -108\nEND_OBJECT\n";
  };
  const Read file = read_floats(float_file(ramp()), " UNIT = M\n", {}, map("1.5"));
  ASSERT_TRUE(file.good) << file.log;
  EXPECT_NEAR(file.info.map.at(0, 1.5).longitude, -112, 1e-9);
  EXPECT_FALSE(read_floats(float_file(ramp()), " UNIT = M\n", {}, map("2.0")).good);
}

// Metres of an equirectangular map of an ellipsoid are those of its radius at the standard
// latitude, as ISIS has it. Of Mars at 60 degrees that is 3381.1 km.
TEST(Place, LocalRadiusOfAnEllipsoid) {
  const double a = 3396190, b = 3376200, s = std::sin(60 * kDegree), c = std::cos(60 * kDegree);
  const double local = a * b / std::sqrt(b * b * c * c + a * a * s * s);
  const std::string scale = std::to_string(local * kDegree);  // a degree of latitude a pixel
  const std::string map =
      "OBJECT = IMAGE_MAP_PROJECTION\n MAP_PROJECTION_TYPE = \"EQUIRECTANGULAR\"\n"
      " A_AXIS_RADIUS = 3396.19 <km>\n C_AXIS_RADIUS = 3376.2 <km>\n"
      " POSITIVE_LONGITUDE_DIRECTION = EAST\n CENTER_LATITUDE = 60\n CENTER_LONGITUDE = 0\n"
      " MAP_SCALE = " +
      scale +
      " <m/pixel>\n LINE_PROJECTION_OFFSET = 61\n SAMPLE_PROJECTION_OFFSET = 1.5\n"
      "END_OBJECT\n";
  const Read file = read_floats(float_file(ramp()), " UNIT = M\n", {}, map);
  ASSERT_TRUE(file.good) << file.log;
  // 0.27 degrees off with the radius at the equator
  EXPECT_NEAR(file.info.map.at(2, 1.5).latitude, 60, 1e-7);
  EXPECT_NEAR(file.info.map.at(3, 1.5).longitude, 2, 1e-7);
  EXPECT_NE(file.log.find("N9604"), std::string::npos) << file.log;
}

// Well-known text of GDAL for such a map has a sphere of that radius; which body it is of is asked.
TEST(Place, LocalRadiusAsASphere) {
  const TemporaryFolder folder;
  (void)folder.write("a.dat", float_file(ramp()));
  const std::string header = folder.write(
      "a.hdr",
      "ENVI\nsamples = 4\nlines = 3\nbands = 1\ndata type = 4\nbyte order = 0\n"
      "map info = {Equirectangular, 1, 1, 0, 0, 59000, 59000}\ncoordinate system string = "
      "{PROJCS[\"Equirectangular Mars\",GEOGCS[\"GCS_Mars\",DATUM[\"D_Mars\","
      "SPHEROID[\"Mars_localRadius\",3381000,0]]],PROJECTION[\"Equirectangular\"],"
      "PARAMETER[\"central_meridian\",0],UNIT[\"Meter\",1]]}\n");
  DemOptions options;
  options.unit = 1;
  const Read refused = read(header, options);
  EXPECT_FALSE(refused.good);
  EXPECT_NE(refused.log.find("--radius METRES, as 3396190"), std::string::npos) << refused.log;
  options.radius = 3396190;
  const Read settled = read(header, options);
  ASSERT_TRUE(settled.good) << settled.log;
  // the degrees are those of the file's own sphere
  EXPECT_NEAR(settled.info.map.at(0, 3).latitude, -3 * 59000 / (3381000 * kDegree), 1e-9);
}

// A map with the radius of another body than the file names.
TEST(Place, RadiusOfAnotherBody) {
  std::string map = kMoonMap;
  map.replace(map.find("1737.4"), 6, "6378.1");
  const std::string data = float_file(ramp());
  DemOptions options;
  options.unit = 1;
  const auto named = [&](const char* target, const std::string& of, const DemOptions& with) {
    return read_floats(
        data,
        std::string(" UNIT = M\nEND_OBJECT\nTARGET_NAME = ") + target + "\nOBJECT = NOTHING\n",
        with, of);
  };
  const Read refused = named("MOON", map, options);
  EXPECT_FALSE(refused.good);
  EXPECT_NE(refused.log.find("names MOON"), std::string::npos) << refused.log;
  EXPECT_NE(refused.log.find("--radius METRES"), std::string::npos) << refused.log;
  EXPECT_TRUE(named("MOON", kMoonMap, options).good);
  EXPECT_TRUE(named("EARTH", map, options).good);
  EXPECT_TRUE(named("RYUGU", map, options).good);
  options.radius = 1737400;
  EXPECT_TRUE(named("MOON", map, options).good);
  // well-known text of a system of the Earth's, with the radius of the Moon
  const TemporaryFolder folder;
  (void)folder.write("a.dat", data);
  const std::string header = folder.write(
      "a.hdr",
      "ENVI\nsamples = 4\nlines = 3\nbands = 1\ndata type = 4\nbyte order = 0\n"
      "map info = {Geographic Lat/Lon, 1, 1, 0, 0, 0.1, 0.1}\ncoordinate system string = "
      "{GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"Moon\",1737400,0]]]}\n");
  options.radius.reset();
  const Read crossed = read(header, options);
  EXPECT_FALSE(crossed.good);
  EXPECT_NE(crossed.log.find("WGS"), std::string::npos) << crossed.log;
}

TEST(Envi, ReferencePixelAndBytes) {
  const TemporaryFolder folder;
  (void)folder.write("a.dat", "head" + float_file(ramp()));
  const std::string header =
      "ENVI\nsamples = 4\nlines = 3\nbands = 1\nheader offset = 4\ndata type = 4\ninterleave = "
      "bsq\n"
      "byte order = 0\nmap info = {Equirectangular, 1.5, 1.5, 5000, 2000, 1000, 1000}\n"
      "coordinate system string = "
      "{PROJCS[\"x\",GEOGCS[\"y\",DATUM[\"D\",SPHEROID[\"S\",1737400,0]]],"
      "PROJECTION[\"Equirectangular\"],PARAMETER[\"central_meridian\",0],UNIT[\"Meter\",1]]}\n";
  const Read file = read(folder.write("a.hdr", header));
  ASSERT_TRUE(file.good) << file.log;
  EXPECT_EQ(file.posts, ramp());
  // 1.5 is the centre of the first pixel
  EXPECT_EQ(file.info.map.left, 4500);
  EXPECT_EQ(file.info.map.top, 2500);
  // a file of no known kind beside its header
  EXPECT_EQ(read(folder / "a.dat").posts, ramp());
}

// Without a coordinate system string the name of the projection places the map.
TEST(Envi, NamesOfProjections) {
  const TemporaryFolder folder;
  (void)folder.write("a.dat", float_file(ramp()));
  const auto read_map = [&](const std::string& map, DemOptions options = {}) {
    return read(folder.write("a.hdr",
                             "ENVI\nsamples = 4\nlines = 3\nbands = 1\ndata type = 4\n"
                             "byte order = 0\n" +
                                 map + "\n"),
                options);
  };
  DemOptions moon;
  moon.radius = 1737400;
  moon.unit = 1;
  const std::string equirectangular =
      "map info = {Equirectangular, 1, 1, 30322, 60644, 1000, 1000, D_Moon, units=Meters}";
  const Read placed = read_map(equirectangular, moon);
  ASSERT_TRUE(placed.good) << placed.log;
  EXPECT_EQ(placed.info.map.kind, Map::Kind::cylindrical);
  // metres over the radius
  EXPECT_NEAR(placed.info.map.at(0, 0).longitude, 30322 / (1737400 * kDegree), 1e-9);
  EXPECT_NEAR(placed.info.map.at(0, 0).latitude, 60644 / (1737400 * kDegree), 1e-9);
  EXPECT_NE(placed.log.find("W9603"), std::string::npos) << placed.log;
  // the radius settles it
  const Read refused = read_map(equirectangular);
  EXPECT_FALSE(refused.good);
  EXPECT_NE(refused.log.find("--radius METRES"), std::string::npos) << refused.log;
  const Read other = read_map("map info = {Sinusoidal, 1, 1, 0, 0, 1000, 1000}", moon);
  EXPECT_EQ(other.info.map.kind, Map::Kind::none);
  EXPECT_NE(other.log.find("the projection 'Sinusoidal' is not read"), std::string::npos)
      << other.log;
  const Read local = read_map("map info = {Arbitrary, 1, 1, 0, 0, 1000, 1000}", moon);
  EXPECT_EQ(local.log.find("W9603"), std::string::npos) << local.log;
  // no map: its pixels have the spacing that is given
  DemOptions spaced = moon;
  spaced.spacing = 12.5;
  EXPECT_EQ(read_map("", spaced).info.map.dx, 12.5);
  EXPECT_EQ(read_map("", moon).info.map.dx, 0);
}

TEST(Isis, TilesAreAssembled) {
  const TemporaryFolder folder;
  const std::string label =
      "Object = IsisCube\n Object = Core\n  StartByte = 1025\n  Format = Tile\n  TileSamples = 3\n"
      "  TileLines = 2\n  Group = Dimensions\n   Samples = 4\n   Lines = 3\n   Bands = 1\n  "
      "End_Group\n"
      "  Group = Pixels\n   Type = SignedWord\n   ByteOrder = Msb\n   Base = 1737400\n"
      "   Multiplier = 0.5\n  End_Group\n End_Object\n Group = Mapping\n"
      "  ProjectionName = SimpleCylindrical\n  CenterLongitude = 0\n  EquatorialRadius = 1737400 "
      "<meters>\n"
      "  PolarRadius = 1737400 <meters>\n  LongitudeDirection = PositiveEast\n  LongitudeDomain = "
      "180\n"
      "  UpperLeftCornerX = 0 <meters>\n  UpperLeftCornerY = 100000 <meters>\n"
      "  PixelResolution = 1000 <meters/pixel>\n End_Group\nEnd_Object\nEnd\n";
  std::string file = label;
  file.resize(1024);
  for (int tile_row = 0; tile_row < 2; ++tile_row)
    for (int tile = 0; tile < 2; ++tile)
      for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x) {
          const int column = 3 * tile + x, row = 2 * tile_row + y;
          const bool inside = column < 4 && row < 3;
          const int value = inside ? 10 * row + column : -32768;
          file +=
              bytes_of(static_cast<std::int16_t>(row == 1 && column == 3 ? -32766 : value), true);
        }
  const std::string path = folder.write("a.cub", file);
  const Read cube = read(path);
  ASSERT_TRUE(cube.good) << cube.log;
  EXPECT_EQ(cube.info.quantity, Quantity::radius);
  for (std::size_t k = 0; k < 12; ++k) {
    if (k == 7)
      EXPECT_EQ(cube.voids[k], VoidKind::low_instrument);
    else
      EXPECT_EQ(cube.posts[k], 0.5 * double(10 * (k / 4) + k % 4)) << k;
  }
  // cut short at any byte: said, not read
  DemOptions alone;
  alone.gdal = false;
  for (std::size_t size = 0; size < file.size(); size += size < 1000 ? 7 : 1)
    EXPECT_FALSE(read(folder.write("cut.cub", file.substr(0, size)), alone).good) << size;
}

TEST(Damage, LabelsCutShort) {
  const TemporaryFolder folder;
  (void)folder.write("a.img", float_file(ramp()));
  const std::string label =
      pds3_label("\"a.img\"", " SAMPLE_TYPE = PC_REAL\n SAMPLE_BITS = 32\n UNIT = M\n", kMoonMap);
  // without its END a label is damaged; the begin of END_OBJECT cannot be told from it
  DemOptions alone;
  alone.gdal = false;
  for (std::size_t size = 0; size + 5 < label.size(); ++size)
    if (!label.substr(0, size).ends_with("END"))
      EXPECT_FALSE(read(folder.write("cut.lbl", label.substr(0, size)), alone).good) << size;
  EXPECT_TRUE(read(folder.write("whole.lbl", label)).good);
  (void)folder.write("a.img", float_file(ramp()).substr(0, 47));
  EXPECT_NE(read(folder / "whole.lbl").log.find("need 48 bytes"), std::string::npos);
  // a pointer into the label
  const std::string attached =
      pds3_label("2", " SAMPLE_TYPE = PC_REAL\n SAMPLE_BITS = 32\n UNIT = M\n", kMoonMap) +
      float_file(ramp());
  EXPECT_NE(read(folder.write("b.img", attached)).log.find("inside the label"), std::string::npos);
}

TEST(Damage, HugeSizes) {
  const TemporaryFolder folder;
  (void)folder.write("a.img", "x");
  for (const char* size : {"4294967295", "16777216", "99999999999999999999", "-1", "0"}) {
    std::string label =
        pds3_label("\"a.img\"", " SAMPLE_TYPE = PC_REAL\n SAMPLE_BITS = 64\n", kMoonMap);
    label.replace(label.find("LINES = 3"), 9, std::string("LINES = ") + size);
    label.replace(label.find("SAMPLES = 4"), 11, std::string("SAMPLES = ") + size);
    EXPECT_FALSE(read(folder.write("a.lbl", label)).good) << size;
  }
}

// ESRI's grids of text are read by GDAL alone.
TEST(Gdal, PresentAndAbsent) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a.asc",
                                        "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n"
                                        "nodata_value -9\n1 2 3\n40 -9 60\n");
  DemOptions options;
  options.unit = 1;
  if (reads_gdal()) {
    const Read file = read(path, options);
    ASSERT_TRUE(file.good) << file.log;
    EXPECT_EQ(file.info.format, "GDAL (AAIGrid)");
    EXPECT_EQ(file.posts[3], 40);
    EXPECT_EQ(file.voids[4], VoidKind::missing);
    EXPECT_EQ(file.info.map.top, 20);
    EXPECT_EQ(file.info.map.dx, 10);
    EXPECT_NE(read(folder.write("b.asc", "ncols 3\nno"), options).log.find("GDAL does not read it"),
              std::string::npos);
  }
  setenv("PANWRIGHT_GDAL", "/nonexistent/libgdal.so", 1);
  EXPECT_FALSE(reads_gdal());
  EXPECT_NE(read(path, options).log.find("GDAL is not installed"), std::string::npos);
  unsetenv("PANWRIGHT_GDAL");
}

}  // namespace
}  // namespace panwright::terrain::readers_test
