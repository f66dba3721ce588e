// Public elevation files beside the checkout, against values of their README, which another reader
// (numpy, from the raw bytes) gave; and traps of formats, each by its file.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "terrain/shape.h"
#include "terrain/survey.h"

namespace panwright::terrain::corpus_test {
namespace {

namespace fs = std::filesystem;

fs::path folder() {
  const char* given = std::getenv("PANWRIGHT_CORPUS");
  return given != nullptr && *given != '\0' ? fs::path(given) : fs::path(PANWRIGHT_CORPUS_DIR);
}

class TerrainCorpus : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(folder() / "terrain")) GTEST_SKIP() << "no elevation files are at hand";
  }
};

struct Read {
  DemInfo info;
  Survey survey;
  std::vector<double> posts;
  std::string log;

  double at(std::size_t row, std::size_t column) const { return posts[row * info.width + column]; }
};

Read read(const std::string& name, const DemOptions& options = {}) {
  DiagnosticLog log;
  Read out;
  const auto dem = Dem::open(folder() / name, options, log);
  EXPECT_TRUE(dem) << to_text(log);
  if (!dem) return out;
  out.info = dem->info();
  const auto about = survey(*dem, {}, log);
  EXPECT_TRUE(about) << to_text(log);
  if (about) out.survey = *about;
  EXPECT_TRUE(dem->read(
      0, out.info.height,
      [&](const Rows& rows) {
        out.posts.insert(out.posts.end(), rows.heights.begin(), rows.heights.end());
        return true;
      },
      log));
  out.log = to_text(log);
  return out;
}

std::string refusal(const std::string& name, const DemOptions& options = {}) {
  DiagnosticLog log;
  EXPECT_FALSE(Dem::open(folder() / name, options, log)) << name;
  return to_text(log);
}

// The window of the twelve encodings, as the plainest of them stores it.
std::vector<float> window() {
  std::ifstream file(folder() / "terrain/encodings/a_pcreal_detached.img", std::ios::binary);
  std::vector<float> out(128 * 128);
  file.read(reinterpret_cast<char*>(out.data()), 65536);
  return out;
}

// Posts of a file of the window that have heights differ by `most` metres at most; the others are
// void in the encodings with 240 of them.
void expect_window(const std::string& name, double most, std::uint64_t voids,
                   const DemOptions& options = {}) {
  const Read file = read("terrain/encodings/" + name, options);
  ASSERT_EQ(file.posts.size(), 128u * 128u) << name;
  EXPECT_EQ(file.survey.void_posts(), voids) << name;
  EXPECT_EQ(file.survey.valid, 128u * 128u - voids) << name;
  const auto truth = window();
  double worst = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (!std::isnan(file.posts[i]))
      worst = std::max(worst, std::fabs(file.posts[i] - double(truth[i])));
  EXPECT_LE(worst, most) << name;
  // one place for all: shift 0. The labels of PDS3 give the scale as 0.005 km.
  EXPECT_NEAR(file.info.map.left, 75680, 1e-6) << name;
  EXPECT_NEAR(file.info.map.top, 39320, 1e-6) << name;
  EXPECT_NEAR(file.info.map.dx, 5, 1e-9) << name;
  EXPECT_EQ(file.info.map.radius, 1737400) << name;
  EXPECT_EQ(file.info.map.kind, Map::Kind::polar) << name;
  EXPECT_FALSE(file.info.map.north) << name;
}

TEST_F(TerrainCorpus, Encodings) {
  expect_window("a_pcreal_detached.lbl", 0, 0);
  expect_window("a_pcreal_detached.img", 0, 0);  // its label lies beside it
  expect_window("b_ieeereal_attached.img", 0, 0);
  expect_window("c_msbint16_scaled.lbl", 0.005 + 1e-9, 0);
  expect_window("d_lsbint16_radius_offset.lbl", 0.25 + 1e-9, 0);
  expect_window("g_pcreal_isis_null_hex.lbl", 0, 240);
  // kilometres in single precision: half an ulp of 0.57 km is 0.03 mm
  expect_window("h_pcreal_km.lbl", 3.1e-5, 0);
  expect_window("i_isis3.cub", 0, 240);
  expect_window("j_pds4.xml", 0, 240);
  expect_window("l_envi.hdr", 0, 240);
  expect_window("l_envi.dat", 0, 240);
}

TEST_F(TerrainCorpus, MeaningOfEncodings) {
  const Read a = read("terrain/encodings/a_pcreal_detached.lbl");
  EXPECT_FLOAT_EQ(static_cast<float>(a.survey.least.height), 487.3281f);
  EXPECT_FLOAT_EQ(static_cast<float>(a.survey.largest.height), 567.3532f);
  EXPECT_FLOAT_EQ(static_cast<float>(a.at(0, 0)), 558.6711f);
  EXPECT_FLOAT_EQ(static_cast<float>(a.at(64, 64)), 548.0610f);
  EXPECT_FLOAT_EQ(static_cast<float>(a.at(127, 127)), 535.6449f);
  EXPECT_TRUE(a.info.unit_stated);
  EXPECT_EQ(a.info.quantity, Quantity::height);
  EXPECT_EQ(a.info.frame, "MEAN EARTH/POLAR AXIS OF DE421");
  EXPECT_EQ(read("terrain/encodings/d_lsbint16_radius_offset.lbl").info.quantity, Quantity::radius);
  const Read km = read("terrain/encodings/h_pcreal_km.lbl");
  EXPECT_EQ(km.info.quantity, Quantity::radius);
  EXPECT_EQ(km.info.unit, "km");
  EXPECT_NEAR(km.survey.least.height, 487.3281, 1e-3);
  EXPECT_NEAR(km.survey.largest.height, 567.3532, 1e-3);
  const Read isis = read("terrain/encodings/i_isis3.cub");
  EXPECT_EQ(isis.survey.voids[std::size_t(VoidKind::null)], 240u);
}

TEST_F(TerrainCorpus, PlateauOfVoids) {
  const Read file = read("terrain/encodings/f_pcreal_void_as_lowest.lbl");
  EXPECT_EQ(file.survey.void_posts(), 0u);
  EXPECT_EQ(file.survey.least.posts, 241u);
  EXPECT_NE(file.log.find("241 posts have the lowest height"), std::string::npos) << file.log;
  DemOptions options;
  options.missing = file.survey.least.height;
  EXPECT_EQ(read("terrain/encodings/f_pcreal_void_as_lowest.lbl", options).survey.void_posts(),
            241u);
}

// Numbers as a cube stores them, times its multiplier, plus its base.
struct Cube {
  const char* name;
  double least, largest, mean;  // f
  std::uint64_t null, lis;
  bool radii;
};

TEST_F(TerrainCorpus, Cubes) {
  const Cube cubes[] = {
      {"gld100_12800m_i16.cub", 1728978.5, 1747245.0, 1736878.7834, 0, 0, true},
      {"ldem_4_reduced.cub", 1729589.0, 1746541.0, 1736879.8079, 0, 0, true},
      {"mars_hirise_marth_equi.cub", -1884.1655, -1324.1248, -1655.5880, 76, 0, false},
      {"ulcn2005_tiled_npole.cub", 1735825.0, 1738507.0, 1737013.8263, 0, 0, true},
      {"vesta_special_f32.cub", 212520.3125, 292371.8125, 254260.8404, 50825, 364, true}};
  for (const Cube& cube : cubes) {
    const Read file = read(std::string("terrain/isis/") + cube.name);
    const double r = cube.radii ? file.info.map.radius : 0;
    EXPECT_EQ(file.info.quantity, cube.radii ? Quantity::radius : Quantity::height) << cube.name;
    EXPECT_NEAR(file.survey.least.height + r, cube.least, 5.1e-5) << cube.name;
    EXPECT_NEAR(file.survey.largest.height + r, cube.largest, 5.1e-5) << cube.name;
    EXPECT_NEAR(file.survey.mean + r, cube.mean, 5.1e-5) << cube.name;
    EXPECT_EQ(file.survey.voids[std::size_t(VoidKind::null)], cube.null) << cube.name;
    EXPECT_EQ(file.survey.voids[std::size_t(VoidKind::low_instrument)], cube.lis) << cube.name;
    EXPECT_EQ(file.survey.void_posts(), cube.null + cube.lis) << cube.name;
  }
  // raw [0,0], [middle], [last]
  const Read gld = read("terrain/isis/gld100_12800m_i16.cub");
  EXPECT_EQ(gld.at(0, 0), -576 * 0.5);
  EXPECT_EQ(gld.at(213, 426), 5721 * 0.5);
  EXPECT_EQ(gld.at(425, 852), -1039 * 0.5);
  const Read tiled = read("terrain/isis/ulcn2005_tiled_npole.cub");
  EXPECT_EQ(tiled.at(0, 0), 314);
  EXPECT_EQ(tiled.at(125, 125), -118);
  EXPECT_EQ(tiled.at(249, 249), -1043);
  const Read vesta = read("terrain/isis/vesta_special_f32.cub");
  EXPECT_EQ(vesta.survey.valid, 15059u);
}

TEST_F(TerrainCorpus, CubeOfVoidsOnly) {
  const Read file = read("terrain/isis/mars_hirise_polar_allnull.cub");
  EXPECT_EQ(file.survey.valid, 0u);
  EXPECT_EQ(file.survey.voids[std::size_t(VoidKind::null)], 156u);
  EXPECT_NE(file.log.find("no height"), std::string::npos) << file.log;
  // the label's own bounds, of an ellipsoid's polar map: 83.4354 to 83.5147, 346.378 to 347.147
  const LatLon first = file.info.map.at(0, 0), last = file.info.map.at(13, 12);
  EXPECT_NEAR(first.longitude, 346.16, 0.03);
  EXPECT_GT(first.latitude, 83.4354 - 0.02);
  EXPECT_LT(last.latitude, 83.5147 + 0.02);
}

// A map of parameters has no unit: it is refused as heights, and read as it stands.
TEST_F(TerrainCorpus, AlbedoMaps) {
  const std::string name = "terrain/isis/hapke_sato2014_44cells.cub";
  EXPECT_NE(refusal(name).find("--values plain"), std::string::npos);
  double least = 1e9, largest = -1e9, sum = 0;
  for (std::uint32_t band = 1; band <= 63; ++band) {
    DemOptions options;
    options.quantity = Quantity::plain;
    options.band = band;
    const Read file = read(name, options);
    ASSERT_EQ(file.posts.size(), 44u);
    least = std::min(least, file.survey.least.height);
    largest = std::max(largest, file.survey.largest.height);
    sum += file.survey.mean;
    if (band == 1) {
      EXPECT_NEAR(file.at(0, 0), 0.157523, 1e-6);
    }
  }
  EXPECT_NEAR(least, 0, 1e-9);
  EXPECT_NEAR(largest, 23.6566, 5e-5);
  EXPECT_NEAR(sum / 63, 3.0644, 5e-5);
}

TEST_F(TerrainCorpus, PointerIntoTheLabel) {
  const std::string name = "terrain/isis/ldem_4_attached_1line.img";
  const std::string why = refusal(name);
  EXPECT_NE(why.find("inside the label"), std::string::npos) << why;
  EXPECT_NE(why.find("--data-offset 2924"), std::string::npos) << why;
  DemOptions options;
  options.data_offset = 2924;
  const Read file = read(name, options);
  ASSERT_EQ(file.posts.size(), 1440u);
  const double first[] = {-10, -8, 49, 28, 19};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(file.at(0, i), 0.5 * first[i]);
  EXPECT_EQ(file.survey.least.height, -505);
  EXPECT_EQ(file.survey.largest.height, 367.5);
  EXPECT_NE(file.log.find("LINE_LAST_PIXEL is 720"), std::string::npos) << file.log;
}

TEST_F(TerrainCorpus, GeoTiff) {
  const Read s = read("terrain/lola/shoemaker_5m_256.tif");
  EXPECT_EQ(s.info.map.left, 75360);
  EXPECT_EQ(s.info.map.top, 39640);
  EXPECT_FLOAT_EQ(static_cast<float>(s.survey.least.height), 467.6863f);
  EXPECT_FLOAT_EQ(static_cast<float>(s.survey.largest.height), 593.4158f);
  EXPECT_NEAR(s.survey.mean, 539.0129, 5e-5);
  EXPECT_FLOAT_EQ(static_cast<float>(s.at(0, 0)), 593.4158f);
  EXPECT_FLOAT_EQ(static_cast<float>(s.at(128, 128)), 548.0610f);
  EXPECT_FLOAT_EQ(static_cast<float>(s.at(255, 255)), 528.1821f);
  EXPECT_FLOAT_EQ(static_cast<float>(s.at(10, 200)), 521.3738f);
  const LatLon middle = s.info.map.at(128, 128);
  EXPECT_NEAR(middle.latitude, -87.18, 0.01);
  EXPECT_NEAR(middle.longitude, 62.8, 0.05);

  const Read g = read("terrain/lola/gzcommon_moon_33.tif");
  EXPECT_TRUE(g.info.map.north);
  EXPECT_EQ(g.info.map.left, -53750);
  EXPECT_EQ(g.info.map.top, -51050);
  EXPECT_NEAR(g.survey.least.height, -212.29616, 5e-6);
  EXPECT_NEAR(g.survey.largest.height, -205.44009, 5e-6);
  EXPECT_NEAR(g.at(0, 0), -206.0089, 5e-5);
  EXPECT_NEAR(g.at(16, 16), -207.6055, 5e-5);
  // width on the sphere; another project's test has 80.04 m
  EXPECT_NEAR(33 * g.info.map.spacing(16.5, 16.5).x, 80.04, 0.005);
}

// The statistics of the README are of a flat frame; those of a survey follow the ground, where a
// metre of this map is 1 / 1.0006 m.
TEST_F(TerrainCorpus, Slopes) {
  const Read s = read("terrain/lola/shoemaker_5m_256.tif");
  const double rms[] = {4.706, 4.626, 4.531, 4.426, 4.297, 4.084, 3.662};
  const double median[] = {2.606, 2.574, 2.517, 2.470, 2.392, 2.306, 2.146};
  ASSERT_EQ(s.survey.slopes.size(), 7u);
  const double k = 5 / s.info.map.spacing(128, 128).x;
  EXPECT_NEAR(k, 1.0006, 5e-5);
  for (std::size_t i = 0; i < 7; ++i) {
    const auto on_the_map = [&](double degrees) {
      return std::atan(std::tan(degrees * kDegree) / k) / kDegree;
    };
    EXPECT_NEAR(on_the_map(s.survey.slopes[i].rms), rms[i], 2e-2) << i;
    EXPECT_NEAR(on_the_map(s.survey.slopes[i].median), median[i], 2e-2) << i;
  }
}

// Means of a neighbourhood of a place of LDEM_4, metres.
struct Ldem {
  Read file = read("small-bodies/LDEM_4.LBL");
  double at(double latitude, double longitude) const {
    const Vec2 p = file.info.map.pixel({latitude, longitude}, file.info.width);
    return file.at(static_cast<std::size_t>(p.y), static_cast<std::size_t>(p.x));
  }
};

TEST_F(TerrainCorpus, GlobalMoon) {
  const Ldem ldem;
  const Map& map = ldem.file.info.map;
  EXPECT_EQ(ldem.file.info.width, 1440u);
  EXPECT_EQ(ldem.file.info.height, 720u);
  // of the raw numbers, in half metres; the label's own MINIMUM is -17758
  EXPECT_EQ(ldem.file.survey.least.height, -17757 * 0.5);
  EXPECT_EQ(ldem.file.survey.largest.height, 21008 * 0.5);
  EXPECT_NEAR(map.at(0, 0).latitude, 90, 1e-12);
  EXPECT_NEAR(map.at(0, 0.5).longitude, 0, 1e-9);
  EXPECT_NEAR(map.at(1440, 720).latitude, -90, 1e-12);
  EXPECT_EQ(map.domain, 360);
  EXPECT_NE(ldem.file.log.find("MAP_SCALE"), std::string::npos) << ldem.file.log;
  // a crop by another program has the same posts
  DemOptions options;
  const Read crop = read("small-bodies/ldem4-crop-a.tif", options);
  ASSERT_EQ(crop.posts.size(), 240u * 180u);
  for (std::size_t row = 0; row < 180; ++row)
    for (std::size_t column = 0; column < 240; ++column)
      ASSERT_EQ(crop.at(row, column), ldem.file.at(180 + row, 900 + column))
          << row << " " << column;
}

// Crater centres and diameters of the IAU Gazetteer of Planetary Nomenclature, degrees and
// kilometres. The place found is where a ring of the crater's size lies highest over its floor.
TEST_F(TerrainCorpus, NamedCraters) {
  const Ldem ldem;
  const struct {
    const char* name;
    double latitude, longitude, diameter;
  } craters[] = {{"Copernicus", 9.62, 339.92, 96.07},
                 {"Tycho", -43.30, 348.78, 85.29},
                 {"Theophilus", -11.45, 26.28, 98.59},
                 {"Langrenus", -8.86, 61.04, 131.98},
                 {"Aristoteles", 50.24, 17.32, 87.57}};
  for (const auto& crater : craters) {
    const double radius = crater.diameter / 2 / 30.3234;  // degrees of latitude
    const double shrink = std::cos(crater.latitude * kDegree);
    const auto mean = [&](double north, double east, double share) {
      double sum = 0;
      for (double turn = 0; turn < 360; turn += 3)
        sum +=
            ldem.at(crater.latitude + north + share * radius * std::cos(turn * kDegree),
                    crater.longitude + (east + share * radius * std::sin(turn * kDegree)) / shrink);
      return sum / 120;
    };
    double best = -1e9, x = 0, y = 0;
    for (double north = -0.75; north <= 0.75; north += 0.05)
      for (double east = -0.75; east <= 0.75; east += 0.05) {
        double score = 0;
        for (const double share : {0.95, 1.0, 1.05}) score += mean(north, east, share) / 3;
        for (const double share : {0.4, 0.5, 0.6, 0.7}) score -= mean(north, east, share) / 4;
        if (score > best) best = score, x = east, y = north;
      }
    const double off = std::hypot(x, y) / 0.25;
    std::printf("%s: %.2f pixels off (east %.2f, north %.2f)\n", crater.name, off, x / 0.25,
                y / 0.25);
    EXPECT_LT(off, 1) << crater.name;
  }
}

TEST_F(TerrainCorpus, Shapes) {
  DiagnosticLog log;
  const auto itokawa = read_shape(folder() / "small-bodies/25143itokawa.tab", {}, log);
  ASSERT_TRUE(itokawa) << to_text(log);
  EXPECT_TRUE(itokawa->unit_stated);
  EXPECT_EQ(itokawa->unit, "km");
  EXPECT_EQ(itokawa->vertices.size(), 6098u);
  EXPECT_EQ(itokawa->plates.size(), 12192u);
  EXPECT_EQ(itokawa->vertices[0], Vec3(7.6e-5, 1.58e-4, 0.138414) * 1000.0);
  EXPECT_EQ(survey_shape(*itokawa).open_edges, 0u);
  const auto eros = read_shape(folder() / "small-bodies/eros007790.tab", {}, log);
  ASSERT_TRUE(eros) << to_text(log);
  EXPECT_EQ(eros->vertices.size(), 3897u);
  EXPECT_EQ(eros->plates.size(), 7790u);
  // Thomas and others 2002: 2535 km³, 34.4 x 11.2 x 11.2 km; this model is coarser
  EXPECT_NEAR(survey_shape(*eros).volume, 2535e9, 0.02 * 2535e9);
  DiagnosticLog doubt;
  EXPECT_FALSE(read_shape(folder() / "small-bodies/bennu.obj", {}, doubt));
  EXPECT_TRUE(doubt.contains(Code("E9602")));
  ShapeOptions metres;
  metres.unit = 1;
  const auto bennu = read_shape(folder() / "small-bodies/bennu.obj", metres, log);
  ASSERT_TRUE(bennu) << to_text(log);
  EXPECT_EQ(bennu->vertices.size(), 1348u);
  EXPECT_EQ(bennu->plates.size(), 2692u);
  // Barnouin and others 2019: 0.0615 km³
  EXPECT_NEAR(survey_shape(*bennu).volume, 0.0615e9, 0.03 * 0.0615e9);
  metres.unit = 1110;  // as its comment says
  const auto churyumov = read_shape(folder() / "small-bodies/67P-CG.obj", metres, log);
  ASSERT_TRUE(churyumov) << to_text(log);
  EXPECT_EQ(churyumov->vertices.size(), 6600u);
  EXPECT_EQ(churyumov->plates.size(), 13196u);
}

}  // namespace
}  // namespace panwright::terrain::corpus_test
