// Views without a camera over terrain: of a site, of a body, and of what stands on the ground.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pan/model.h"
#include "terrain/tile_writer.h"
#include "terrain/tiles.h"
#include "tests/support/process.h"
#include "workspace/frame.h"
#include "workspace/open.h"

namespace panwright::workspace::ground_views_test {
namespace {

namespace fs = std::filesystem;

constexpr double kMoon = 1737400;  // metres
const char* const kCrater = PANWRIGHT_SOURCE_DIR "/examples/terrain/crater.lbl";

world::World world_of(const fs::path& terrain, const char* lander, DiagnosticLog& log) {
  world::World world;
  const auto ground = open(terrain, {}, log);
  if (!ground || !world.add("ground", *ground, log)) return {};
  if (lander == nullptr) return world;
  const auto model = open(lander, {}, log);
  if (!model || !world.add("lander", *model, log)) return {};
  return world;
}

Frame frame_of(const world::World& world, const Settings& settings = {}) {
  DiagnosticLog log;
  View view;
  view.settings = settings;
  const auto frame = FrameMaker(world).frame(view, log);
  EXPECT_TRUE(frame) << to_text(log);
  return frame ? *frame : Frame{};
}

// Whether a place falls onto the image.
bool is_in_view(const world::Camera& camera, const Vec3& place) {
  const auto pixel = world::project(camera, place);
  return pixel && pixel->x >= 0 && pixel->x <= camera.width && pixel->y >= 0 &&
         pixel->y <= camera.height;
}

// Sine of the height of the camera over the horizon of a place.
double rise(const world::Camera& camera, const Vec3& place, const Vec3& up) {
  return glm::dot(glm::normalize(camera.position - place), up);
}

Vec3 up_in_image(const world::Camera& camera) { return camera.world_from_camera * Vec3(0, -1, 0); }

class GroundViews : public testing::Test {
 protected:
  // The made crater field, near the south pole of the Moon.
  fs::path crater() {
    DiagnosticLog log;
    std::vector<terrain::Dem> dems;
    auto dem = terrain::Dem::open(kCrater, {}, log);
    if (!dem) return {};
    dems.push_back(*std::move(dem));
    const fs::path file = folder_.path() / "crater.pan";
    EXPECT_TRUE(terrain::write_tiles(dems, file, {}, log)) << to_text(log);
    return file;
  }
  // A file of `side` x `side` heights of 0, and its map.
  fs::path flat(const std::string& map, int side) {
    DiagnosticLog log;
    (void)folder_.write("flat.dat", std::string(4 * side * side, 0));
    const auto header = folder_.write(
        "flat.hdr", "ENVI\nsamples = " + std::to_string(side) +
                        "\nlines = " + std::to_string(side) +
                        "\nbands = 1\ndata type = 4\nbyte order = 0\nmap info = " + map + "\n");
    terrain::DemOptions reading;
    reading.unit = 1;
    reading.quantity = terrain::Quantity::height;
    std::vector<terrain::Dem> dems;
    auto dem = terrain::Dem::open(header, reading, log);
    EXPECT_TRUE(dem) << to_text(log);
    if (!dem) return {};
    dems.push_back(*std::move(dem));
    const fs::path file = folder_.path() / "flat.pan";
    EXPECT_TRUE(terrain::write_tiles(dems, file, {}, log)) << to_text(log);
    return file;
  }
  // Places of the ground of a file, evenly over its first chart.
  static std::vector<Vec3> places(const fs::path& file) {
    DiagnosticLog log;
    const auto tiles = terrain::Tiles::open(file, log);
    std::vector<Vec3> out;
    if (!tiles) return out;
    const terrain::ChartRecord& chart = tiles->charts()[0];
    for (const double row : {0.5, 0.5 * chart.height, chart.height - 0.5})
      for (const double column : {0.5, 0.5 * chart.width, chart.width - 0.5}) {
        const terrain::Map map = terrain::map_of(chart);
        if (!map.is_placed()) {
          const Vec2 at = map.point(column, row);
          out.emplace_back(at, 0);
          continue;
        }
        const terrain::LatLon at = map.at(column, row);
        const double b = at.latitude * kDegree, l = at.longitude * kDegree;
        out.push_back((chart.radius + chart.low) *
                      Vec3(std::cos(b) * std::cos(l), std::cos(b) * std::sin(l), std::sin(b)));
      }
    return out;
  }

  support::TemporaryFolder folder_;
};

TEST_F(GroundViews, ASiteOnABody) {
  DiagnosticLog log;
  const fs::path file = crater();
  const world::Camera camera = frame_of(world_of(file, nullptr, log)).camera();
  const std::vector<Vec3> ground = places(file);
  ASSERT_EQ(ground.size(), 9u);
  for (const Vec3& place : ground) EXPECT_TRUE(is_in_view(camera, place));
  const Vec3 up = glm::normalize(ground[4]);
  EXPECT_NEAR(rise(camera, ground[4], up), std::sqrt(1 / 2.25), 0.05);
  EXPECT_GT(glm::dot(up_in_image(camera), up), 0.7);
  EXPECT_LT(glm::length(camera.position - ground[4]), 5000);
}

TEST_F(GroundViews, APlaneAwayFromItsOrigin) {
  DiagnosticLog log;
  const fs::path file = flat("{Local, 1, 1, 10000, 20000, 2, 2}", 64);
  const world::Camera camera = frame_of(world_of(file, nullptr, log)).camera();
  const std::vector<Vec3> ground = places(file);
  ASSERT_EQ(ground.size(), 9u);
  EXPECT_NEAR(ground[4].x, 10064, 2);
  for (const Vec3& place : ground) EXPECT_TRUE(is_in_view(camera, place));
  EXPECT_GT(camera.position.z, 50);
}

// A camera without a direction looks at the site, the vertical upwards, and not into the body.
TEST_F(GroundViews, ACameraWithoutDirection) {
  DiagnosticLog log;
  const fs::path file = crater();
  const std::vector<Vec3> ground = places(file);
  ASSERT_EQ(ground.size(), 9u);
  const Vec3 up = glm::normalize(ground[4]);
  Settings settings;
  settings.camera = ground[4] + 800.0 * glm::normalize(up + glm::cross(up, Vec3(1, 0, 0)));
  const world::Camera camera = frame_of(world_of(file, nullptr, log), settings).camera();
  const auto pixel = world::project(camera, ground[4]);
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x, 0.5 * camera.width, 0.1 * camera.width);
  EXPECT_NEAR(pixel->y, 0.5 * camera.height, 0.1 * camera.height);
  EXPECT_GT(glm::dot(up_in_image(camera), up), 0.5);
}

// What stands on the ground fills the image, from above its own horizon.
TEST_F(GroundViews, WhatStandsOnTheGround) {
  DiagnosticLog log;
  const fs::path file = crater();
  const world::World world =
      world_of(file, PANWRIGHT_SOURCE_DIR "/examples/client/client.pxn", log);
  ASSERT_EQ(world.size(), 2u) << to_text(log);
  const std::vector<Vec3> ground = places(file);
  ASSERT_EQ(ground.size(), 9u);
  Settings settings;
  settings.pose = {PoseSetting{"lander", {ground[4], {1, 0, 0, 0}}}};
  const world::Camera camera = frame_of(world, settings).camera();
  EXPECT_TRUE(is_in_view(camera, ground[4]));
  EXPECT_LT(glm::length(camera.position - ground[4]), 60);
  const Vec3 up = glm::normalize(ground[4]);
  EXPECT_GT(rise(camera, ground[4], up), 0.2);
  EXPECT_GT(glm::dot(up_in_image(camera), up), 0.7);
  // high above, ground has no say
  settings.pose = {PoseSetting{"lander", {5 * kMoon * up, {1, 0, 0, 0}}}};
  EXPECT_GT(up_in_image(frame_of(world, settings).camera()).z, 0.7);
}

// What is dark or out of view is said: a craft without a pose, a Sun below the horizon.
TEST_F(GroundViews, WhatIsDarkOrInsideIsNamed) {
  DiagnosticLog log;
  const fs::path file = crater();
  const world::World world =
      world_of(file, PANWRIGHT_SOURCE_DIR "/examples/client/client.pxn", log);
  ASSERT_EQ(world.size(), 2u) << to_text(log);
  const std::vector<Vec3> ground = places(file);
  ASSERT_EQ(ground.size(), 9u);
  const Vec3 up = glm::normalize(ground[4]);
  const auto codes = [&](const Vec3& at, const Vec3& sun, bool lamp) {
    DiagnosticLog said;
    View view;
    view.settings.pose = {PoseSetting{"lander", {at, {1, 0, 0, 0}}}};
    view.settings.sun = sun;
    if (lamp)
      EXPECT_TRUE(
          read_setting(SettingId::lamp, "point on camera intensity 9", view.settings, said));
    EXPECT_TRUE(FrameMaker(world).frame(view, said));
    std::string text;
    for (const Diagnostic& each : said.entries())
      text += std::string(code_info(each.code).name) + " ";
    return text;
  };
  const Vec3 level = glm::normalize(glm::cross(up, Vec3(1, 0, 0)));
  EXPECT_EQ(codes(Vec3(0), up, false), "W5022 ");
  EXPECT_EQ(codes(ground[4], up, false), "");
  EXPECT_EQ(codes(ground[4], level + 0.01 * up, false), "");
  EXPECT_EQ(codes(ground[4], level - 0.05 * up, false), "N5023 ");
  EXPECT_EQ(codes(ground[4], level - 0.05 * up, true), "");
  // 100 km up the horizon is 19 degrees lower
  EXPECT_EQ(codes(ground[4] + 1e5 * up, level - 0.3 * up, false), "");
  EXPECT_EQ(codes(ground[4] + 1e5 * up, level - 0.4 * up, false), "N5023 ");
}

TEST_F(GroundViews, AWholeBody) {
  DiagnosticLog log;
  const fs::path file = flat(
      "{Geographic Lat/Lon, 1, 1, -180, 90, 5.625, 2.8125, units=Degrees}\n"
      "coordinate system string = {GEOGCS[\"Moon\",DATUM[\"Moon\",SPHEROID[\"Moon\",1737400,0]],"
      "PRIMEM[\"Reference_Meridian\",0],UNIT[\"Degree\",0.017453292519943295]]}",
      64);
  const world::Camera camera = frame_of(world_of(file, nullptr, log)).camera();
  EXPECT_GT(glm::length(camera.position), 3 * kMoon);
  EXPECT_TRUE(is_in_view(camera, {0, 0, kMoon}));
  EXPECT_TRUE(is_in_view(camera, {0, -kMoon, 0}));
}

// `dem --at` tells a pose in which a model stands upright: z up, y to the north.
TEST_F(GroundViews, UprightOnTheGround) {
  const fs::path file = crater();
  const auto run = support::run({PANWRIGHT_BIN_DIR "/panwright", "dem", file.string(), "--at",
                                 "-87.61778 56.83508 12.5", "--light", "90 30", "--json"});
  const auto number = [&](std::size_t& from) {
    from = run.out.find_first_of("-0123456789", from);
    std::size_t length = 0;
    const double value = from == run.out.npos ? NAN : std::stod(run.out.substr(from), &length);
    from += length;
    return value;
  };
  std::size_t at = run.out.find("\"position\"");
  ASSERT_NE(at, run.out.npos) << run.out;
  const double x = number(at), y = number(at), z = number(at);
  at = run.out.find("\"height\"", run.out.find("\"points\""));
  EXPECT_NEAR(glm::length(Vec3(x, y, z)), kMoon + number(at) + 12.5, 1e-6);
  at = run.out.find("\"upright\"");
  ASSERT_NE(at, run.out.npos) << run.out;
  const double w = number(at), i = number(at), j = number(at), k = number(at);
  const Quat q(w, i, j, k);
  const Vec3 up = glm::normalize(Vec3(x, y, z));
  EXPECT_LT(glm::length(q * Vec3(0, 0, 1) - up), 1e-12);
  EXPECT_LT(std::fabs((q * Vec3(1, 0, 0)).z), 1e-12);  // east is level
  EXPECT_GT((q * Vec3(0, 1, 0)).z, 0.01);              // north
  at = run.out.find("\"sun\"");
  const double a = number(at), b = number(at), c = number(at);
  // from the east, 30 degrees high
  EXPECT_LT(glm::length(Vec3(a, b, c) - q * Vec3(std::sqrt(0.75), 0, 0.5)), 1e-12);
}

}  // namespace
}  // namespace panwright::workspace::ground_views_test
