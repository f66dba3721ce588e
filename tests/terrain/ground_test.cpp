// Heights and rays on terrain against every triangle, built here from the source's posts.
#include "terrain/ground.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "terrain/tile_writer.h"
#include "tests/support/process.h"
#include "tests/terrain/made_files.h"

namespace panwright::terrain::ground_test {
namespace {

using support::TemporaryFolder;
using testing_support::bytes_of;

constexpr double kRadius = 50000;  // a small sphere, so that curvature matters

struct Made {
  std::uint32_t width, height;
  std::vector<float> z;
  std::optional<Ground> ground;
  std::vector<std::array<Vec3, 3>> triangles;
  std::vector<Vec3> points;
};

enum class Kind { plane, cylindrical, polar };

// A place of a post by formulas of this test: Snyder's for a sphere.
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

double hill(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
  const std::uint32_t noise = ((x * 73856093u) ^ (y * 19349663u) ^ seed) * 2654435761u;
  return 60 * std::sin(x * 0.11) * std::cos(y * 0.07) + 25 * double(noise >> 8) / (1 << 24);
}

Made make(Kind kind, std::uint32_t width, std::uint32_t height, bool hole) {
  Made out{width, height, {}, {}, {}, {}};
  std::string data;
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      auto z = static_cast<float>(hill(x, y, 7));
      if (hole && x > 100 && x < 120 && y > 40 && y < 80)
        z = std::numeric_limits<float>::quiet_NaN();
      out.z.push_back(z);
      out.points.push_back(place_of(kind, x, y, double(z), width, height));
      data += bytes_of(z, false);
    }
  for (std::uint32_t y = 0; y + 1 < height; ++y)
    for (std::uint32_t x = 0; x + 1 < width; ++x) {
      const Vec3 &a = out.points[y * width + x], &b = out.points[y * width + x + 1],
                 &c = out.points[(y + 1) * width + x], &d = out.points[(y + 1) * width + x + 1];
      out.triangles.push_back({a, d, b});
      out.triangles.push_back({a, c, d});
    }
  const TemporaryFolder folder;
  const std::string extension = kind == Kind::plane ? ".hdr" : ".lbl";
  (void)folder.write(kind == Kind::plane ? "a.dat" : "a.img", data);
  const std::string path = folder.write("a" + extension, label_of(kind, width, height));
  DiagnosticLog log;
  DemOptions reading;
  reading.unit = 1;
  reading.quantity = Quantity::height;
  const auto dem = Dem::open(path, reading, log);
  EXPECT_TRUE(dem) << to_text(log);
  if (!dem) return out;
  EXPECT_EQ(dem->info().map.is_placed(), kind != Kind::plane);
  const auto report = write_tiles({&*dem, 1}, folder / "a.pan", {}, log);
  EXPECT_TRUE(report) << to_text(log);
  auto tiles = Tiles::open(folder / "a.pan", log);
  EXPECT_TRUE(tiles) << to_text(log);
  if (tiles) out.ground.emplace(std::make_shared<const Tiles>(*std::move(tiles)));
  return out;
}

// Signed volumes: another test than the library's.
std::optional<double> brute(const std::array<Vec3, 3>& t, const Vec3& o, const Vec3& d) {
  const auto volume = [&](const Vec3& a, const Vec3& b) { return glm::dot(d, glm::cross(a, b)); };
  const Vec3 a = t[0] - o, b = t[1] - o, c = t[2] - o;
  const double u = volume(b, c), v = volume(c, a), w = volume(a, b), sum = u + v + w;
  if (sum == 0 || u / sum < 0 || v / sum < 0 || w / sum < 0) return {};
  return glm::dot(d, (u * a + v * b + w * c) / sum);
}

struct Draw {
  std::uint64_t state = 12345;
  double operator()() {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return double(state >> 11) / 9007199254740992.0;
  }
};

void expect_rays(const Made& made, double reach, int count) {
  Draw draw;
  int hits = 0, misses = 0;
  double worst = 0;
  for (int k = 0; k < count; ++k) {
    const auto pick = [&] {
      for (;;) {
        const auto i = static_cast<std::size_t>(draw() * double(made.points.size()));
        if (std::isfinite(made.points[i].z)) return made.points[i];
      }
    };
    const Vec3 target = pick(), start = pick();
    // from above the ground, from far away, from below, and along it
    const Vec3 jitter(draw() - 0.5, draw() - 0.5, draw() - 0.5);
    const Vec3 origin = start + reach * (k % 3 == 0 ? 0.02 : 1.0) * jitter;
    const Vec3 direction = glm::normalize(target + reach * 0.01 * draw() * jitter - origin);
    double want = std::numeric_limits<double>::infinity();
    for (const auto& triangle : made.triangles) {
      const auto t = brute(triangle, origin, direction);
      if (t && *t >= 0 && *t < want) want = *t;
    }
    const auto got = made.ground->nearest(origin, direction);
    ASSERT_EQ(got.has_value(), std::isfinite(want)) << k;
    ASSERT_EQ(made.ground->is_blocked(origin, direction, 0, 1e9), got.has_value()) << k;
    if (!got) {
      ++misses;
      continue;
    }
    ++hits;
    worst = std::max(worst, std::fabs(got->distance - want) / std::max(reach, want));
    // measured: 3.2e-14
    EXPECT_NEAR(got->distance, want, 1e-12 * std::max(reach, want)) << k;
  }
  printf("distances of rays: %.1e, relative\n", worst);
  EXPECT_GT(hits, count / 3);
  EXPECT_GT(misses, 0);
}

TEST(Ground, RaysOnAPlane) { expect_rays(make(Kind::plane, 300, 90, true), 2000, 300); }
TEST(Ground, RaysOnACylindricalMap) {
  expect_rays(make(Kind::cylindrical, 280, 120, true), 20000, 300);
}
TEST(Ground, RaysOnAPolarMap) { expect_rays(make(Kind::polar, 270, 130, false), 20000, 300); }

// The ground at a place is where the vertical meets the triangles.
void expect_places(const Made& made, Kind kind) {
  Draw draw;
  double worst = 0;
  for (int k = 0; k < 200; ++k) {
    // between posts of random cells
    const auto x = static_cast<std::uint32_t>(draw() * (made.width - 1)),
               y = static_cast<std::uint32_t>(draw() * (made.height - 1));
    const Vec3 &a = made.points[y * made.width + x], &d = made.points[(y + 1) * made.width + x + 1];
    const Vec3 b =
        draw() < 0.5 ? made.points[y * made.width + x + 1] : made.points[(y + 1) * made.width + x];
    if (!std::isfinite(a.z + b.z + d.z)) continue;
    const double u = draw(), v = draw() * (1 - u);
    const Vec3 p = a + u * (b - a) + v * (d - a);
    LatLon place{p.y, p.x};
    if (kind != Kind::plane)
      place = {std::asin(p.z / glm::length(p)) * 180 / kPi, std::atan2(p.y, p.x) * 180 / kPi};
    const GroundPoint got = made.ground->at(place);
    ASSERT_TRUE(got) << k;
    const Vec3 normal = glm::normalize(glm::cross(b - a, d - a));
    worst = std::max(worst, glm::length(got.position - p));
    // measured: 2.1e-10 m
    EXPECT_LT(glm::length(got.position - p), 1e-8) << k;
    const double height = kind == Kind::plane ? p.z : glm::length(p) - kRadius;
    EXPECT_NEAR(got.height, height, 1e-7);
    // at an edge the neighbour's normal is as right
    const Vec3 up = kind == Kind::plane ? Vec3(0, 0, 1) : glm::normalize(p);
    if (u > 1e-6 && v > 1e-6 && u + v < 1 - 1e-6) {
      EXPECT_NEAR(std::fabs(glm::dot(got.normal, normal)), 1, 1e-9);
    }
    EXPECT_GT(glm::dot(got.normal, up), 0);
    EXPECT_NEAR(got.slope, std::acos(std::min(1.0, glm::dot(got.normal, up))), 1e-6);
  }
  printf("places: %.1e m\n", worst);
}

TEST(Ground, PlacesOnAPlane) { expect_places(make(Kind::plane, 300, 90, true), Kind::plane); }
TEST(Ground, PlacesOnACylindricalMap) {
  expect_places(make(Kind::cylindrical, 280, 120, true), Kind::cylindrical);
}
TEST(Ground, PlacesOnAPolarMap) { expect_places(make(Kind::polar, 270, 130, false), Kind::polar); }

TEST(Ground, NoneInVoidsAndOutside) {
  const Made made = make(Kind::plane, 300, 90, true);
  EXPECT_FALSE(made.ground->at({-605, 1105}));
  EXPECT_TRUE(made.ground->at({-605, 905}));
  EXPECT_FALSE(made.ground->at({-605, -1}));
  EXPECT_FALSE(made.ground->at({std::numeric_limits<double>::quiet_NaN(), 905}));
  std::vector<LatLon> places(10000, LatLon{-605, 905});
  std::vector<GroundPoint> points(places.size());
  made.ground->at(places, points);
  EXPECT_EQ(points.back().height, made.ground->at(places.back()).height);
}

}  // namespace
}  // namespace panwright::terrain::ground_test
