// Heights and rays on terrain against every triangle, built here from the source's posts.
#include "terrain/ground.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>

#include "base/parallel.h"
#include "terrain/sights.h"
#include "terrain/tile_writer.h"
#include "tests/support/process.h"
#include "tests/terrain/made_files.h"

namespace panwright::terrain::ground_test {
namespace {

using support::TemporaryFolder;
using testing_support::bytes_of;
using testing_support::Kind;
using testing_support::kRadius;
using testing_support::label_of;
using testing_support::place_of;

struct Made {
  std::uint32_t width, height;
  std::vector<float> z;
  std::optional<Ground> ground;
  std::vector<std::array<Vec3, 3>> triangles;
  std::vector<Vec3> points;
};

double hill(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
  const std::uint32_t noise = ((x * 73856093u) ^ (y * 19349663u) ^ seed) * 2654435761u;
  return 60 * std::sin(x * 0.11) * std::cos(y * 0.07) + 25 * double(noise >> 8) / (1 << 24);
}

Made make(Kind kind, std::uint32_t width, std::uint32_t height, bool hole,
          const std::string& label = {}) {
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
  if (auto tiles = tiles_of(kind, data, label.empty() ? label_of(kind, width, height) : label))
    out.ground.emplace(std::move(tiles));
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

// From where a pixel may be, to 1e6 m: within 1e-6 m.
TEST(Ground, RaysFromAfar) { expect_rays(make(Kind::polar, 270, 130, false), 1e6, 100); }

// Distance to a triangle by the sides of its plane: another way than the library's.
double distance_to(const std::array<Vec3, 3>& t, const Vec3& p) {
  const Vec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  bool within = true;
  double out = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &a = t[k], &b = t[(k + 1) % 3], side = b - a;
    within = within && glm::dot(glm::cross(side, p - a), normal) >= 0;
    const double share = std::clamp(glm::dot(p - a, side) / glm::dot(side, side), 0.0, 1.0);
    out = std::min(out, glm::length(p - a - share * side));
  }
  return within ? std::fabs(glm::dot(p - t[0], normal)) / glm::length(normal) : out;
}

void expect_nearest(const Made& made, double reach) {
  Draw draw;
  double worst = 0;
  for (int k = 0; k < 120; ++k) {
    Vec3 post = made.points[static_cast<std::size_t>(draw() * double(made.points.size()))];
    if (!std::isfinite(post.z)) post = made.points[0];
    // near the ground, high above and far below, beside the map
    const Vec3 point =
        post + (k % 2 == 0 ? 0.003 : 1) * reach * Vec3(draw() - 0.5, draw() - 0.5, draw() - 0.5);
    double want = std::numeric_limits<double>::infinity();
    for (const auto& triangle : made.triangles)
      if (std::isfinite(triangle[0].z + triangle[1].z + triangle[2].z))
        want = std::min(want, distance_to(triangle, point));
    const auto got = made.ground->closest(point);
    ASSERT_TRUE(got) << k;
    worst = std::max(worst, std::fabs(got->distance - want));
    // measured: 1.5e-11 m
    EXPECT_NEAR(got->distance, want, 1e-9) << k;
    EXPECT_NEAR(glm::length(got->point.position - point), got->distance, 1e-9);
    const auto& own = made.triangles[2 * (got->point.row * (made.width - 1) + got->point.column) +
                                     got->point.triangle];
    EXPECT_LT(distance_to(own, got->point.position), 1e-9) << k;
    EXPECT_FALSE(made.ground->closest(point, 0.999 * want)) << k;
    EXPECT_TRUE(made.ground->closest(point, 1.001 * want + 1e-6)) << k;
  }
  printf("nearest points: %.1e m\n", worst);
}

TEST(Ground, NearestOnAPlane) { expect_nearest(make(Kind::plane, 300, 90, true), 3000); }
TEST(Ground, NearestOnACylindricalMap) {
  expect_nearest(make(Kind::cylindrical, 600, 120, true), 60000);
}
TEST(Ground, NearestOnAPolarMap) { expect_nearest(make(Kind::polar, 270, 300, false), 60000); }

// Triangles of a level, from the posts of the file.
std::vector<std::array<Vec3, 3>> triangles_of(const Made& made, std::uint32_t level) {
  const LevelSide across = level_side(made.width, level), down = level_side(made.height, level);
  const auto post = [&](std::uint32_t i, std::uint32_t j) {
    return made.points[std::min(j << level, made.height - 1) * made.width +
                       std::min(i << level, made.width - 1)];
  };
  std::vector<std::array<Vec3, 3>> out;
  for (std::uint32_t j = 0; j + 1 < down.posts; ++j)
    for (std::uint32_t i = 0; i + 1 < across.posts; ++i) {
      out.push_back({post(i, j), post(i + 1, j + 1), post(i + 1, j)});
      out.push_back({post(i, j), post(i, j + 1), post(i + 1, j + 1)});
    }
  return out;
}

// Levels side by side: no ray goes through the
// ground, each meets a triangle of its level, and the exact ground lies within the angle.
void expect_levels(Kind kind, const Vec3& eye, double far, double angle) {
  const Made made = make(kind, 1025, 515, false);
  const GroundLevels levels = made.ground->levels(eye, angle);
  std::vector<std::vector<std::array<Vec3, 3>>> triangles;
  for (std::uint32_t k = 0; k < 3; ++k) triangles.push_back(triangles_of(made, k));
  Draw draw;
  std::array<int, 4> seen{};
  int outlines = 0;
  double worst = 0, largest = 0;
  for (int k = 0; k < 3000; ++k) {
    const auto post = made.points[static_cast<std::size_t>(draw() * double(made.points.size()))];
    const Vec3 target = post + 3.0 * Vec3{draw() - 0.5, draw() - 0.5, draw() - 0.5};
    const Vec3 direction = glm::normalize(target - eye);
    if (glm::length(target - eye) > far) continue;
    const auto got = made.ground->nearest(eye, direction, 0, 1e9, &levels);
    const auto exact = made.ground->nearest(eye, direction);
    if (got.has_value() != exact.has_value()) {
      // at an outline: a ray within the angle has the other answer
      const Vec3 aside = angle * glm::normalize(kind == Kind::plane ? Vec3(0, 0, 1) : target);
      EXPECT_TRUE(made.ground->nearest(eye, glm::normalize(direction + aside)).has_value() ==
                      got.has_value() ||
                  made.ground->nearest(eye, glm::normalize(direction - aside)).has_value() ==
                      got.has_value())
          << k;
      ++outlines;
    }
    if (!got || !exact) continue;
    ASSERT_LE(got->point.level, 3u);
    ++seen[got->point.level];
    EXPECT_LT(glm::dot(got->point.normal, direction), 0) << k;
    // the exact ground above or below the point
    const Vec3 p = got->point.position;
    const Vec3 up = kind == Kind::plane ? Vec3(0, 0, 1) : glm::normalize(p);
    const auto there = made.ground->nearest(p + 1000.0 * up, -up);
    ASSERT_TRUE(there) << k;
    const double off = std::fabs(there->distance - 1000);
    largest = std::max(largest, off);
    worst = std::max(worst, off / (angle * got->distance));
    if (k % 100 != 0 || got->point.level > 2) continue;
    // triangles of its level in front of it may lie in tiles of other levels
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& triangle : triangles[got->point.level])
      if (const auto t = brute(triangle, eye, direction))
        nearest = std::min(nearest, std::fabs(*t - got->distance));
    EXPECT_LT(nearest, 1e-6) << k;
  }
  printf("levels: %d %d %d %d hits, %d at outlines, off by %.3f of the angle, %.3g m\n", seen[0],
         seen[1], seen[2], seen[3], outlines, worst, largest);
  // measured: 0.12, 0.02, 0.04
  EXPECT_LE(worst, 1);
  EXPECT_LT(outlines, 20);
  EXPECT_GT(largest, 0.1);
  EXPECT_GT(seen[1], 100);
}

TEST(Ground, LevelsOnAPlane) { expect_levels(Kind::plane, {3000, -2500, 300}, 1e4, 0.05); }
TEST(Ground, LevelsOnACylindricalMap) {
  expect_levels(Kind::cylindrical, {54000, -12000, 5000}, 2e4, 0.05);
}
TEST(Ground, LevelsOnAPolarMap) { expect_levels(Kind::polar, {0, 25000, -58000}, 4e4, 0.03); }

TEST(Ground, PlacesOnAPlane) { expect_places(make(Kind::plane, 300, 90, true), Kind::plane); }
TEST(Ground, PlacesOnACylindricalMap) {
  expect_places(make(Kind::cylindrical, 280, 120, true), Kind::cylindrical);
}
TEST(Ground, PlacesOnAPolarMap) { expect_places(make(Kind::polar, 270, 130, false), Kind::polar); }

// An ellipsoid's polar map, where posts have no closed form: rays against the ground at places,
// which has no trees.
TEST(Ground, RaysOnAPolarMapOfAnEllipsoid) {
  std::string label = label_of(Kind::polar, 270, 130);
  label.insert(label.find(" A_AXIS"), " C_AXIS_RADIUS = 49 <km>\n");
  const Made made = make(Kind::polar, 270, 130, true, label);
  ASSERT_NE(made.ground->tiles().charts()[0].radius, made.ground->tiles().charts()[0].polar_radius);
  Draw draw;
  int hits = 0;
  for (int k = 0; k < 300; ++k) {
    const Vec3 eye{6000 * (draw() - 0.5), 6000 * (draw() - 0.5), -52000};
    const Vec3 aim{20000 * (draw() - 0.5), 10000 * (draw() - 0.5), -49000};
    const auto hit = made.ground->nearest(eye, glm::normalize(aim - eye));
    if (!hit) continue;
    ++hits;
    const Vec3 p = hit->point.position;
    const GroundPoint below = made.ground->at(
        {std::atan2(p.z, std::hypot(p.x, p.y)) * 180 / kPi, std::atan2(p.y, p.x) * 180 / kPi});
    ASSERT_TRUE(below) << k;
    // measured: 4e-11 m
    EXPECT_NEAR(below.height, hit->point.height, 1e-8) << k;
  }
  EXPECT_GT(hits, 100);
}

// Trees that do not fit are dropped, and change no answer.
TEST(Ground, BoundedMemory) {
  constexpr std::size_t kMost = 700'000;  // of three trees; there are 15 tiles, and those above
  const Made made = make(Kind::plane, 1025, 515, false);
  const auto tiles = std::make_shared<const Tiles>(made.ground->tiles());
  const Ground small(tiles, kMost);
  std::vector<double> want(400), got(400);
  const auto ray = [&](std::size_t i, const Ground& ground) {
    const Vec3 eye(5000 + 40 * std::sin(double(i)), -2500, 3000);
    const Vec3 aim(10 * (i * 7919 % 1020) + 8, -10.0 * double(i * 104729 % 510) - 8, 0);
    const auto hit = ground.nearest(eye, glm::normalize(aim - eye));
    return hit ? hit->distance : -1;
  };
  for (std::size_t i = 0; i < want.size(); ++i) want[i] = ray(i, *made.ground);
  EXPECT_GT(made.ground->tree_bytes(), 2 * kMost);
  std::atomic<std::size_t> most = 0;
  parallel_for(want.size(), [&](std::size_t i) {
    got[i] = ray(i, small);
    if (small.tree_bytes() > most) most = small.tree_bytes();
  });
  EXPECT_EQ(got, want);
  // of two threads each needs a few more at most
  EXPECT_LT(most, kMost + 4 * 250'000);
  EXPECT_LE(small.tree_bytes(), kMost);
}

// Normals of a smooth hill: close to those of its formula, and the same from both sides of the
// edges of triangles, whose own differ.
TEST(Ground, SmoothNormalsOfAHill) {
  const Made made = make(Kind::plane, 300, 90, false);
  const Ground& ground = *made.ground;
  const auto normal_at = [&](double x, double y, bool smooth) {
    const GroundPoint p = ground.at({y, x});
    EXPECT_TRUE(p) << x << " " << y;
    return smooth ? ground.smooth(p).normal : p.normal;
  };
  Draw draw;
  double step = 0, facets = 0;
  for (int k = 0; k < 400; ++k) {
    const double i = 2 + std::floor(draw() * 290), j = 2 + std::floor(draw() * 80), t = draw();
    // across a side of a cell, its other side, its diagonal
    const double x = 10 * (i + (k % 3 == 0 ? 0 : t)) + 5, y = -10 * (j + (k % 3 == 1 ? 0 : t)) - 5;
    const Vec2 aside = k % 3 == 0 ? Vec2(1, 0) : k % 3 == 1 ? Vec2(0, 1) : Vec2(1, 1);
    const auto apart = [&](bool smooth) {
      return glm::length(normal_at(x + 1e-6 * aside.x, y + 1e-6 * aside.y, smooth) -
                         normal_at(x - 1e-6 * aside.x, y - 1e-6 * aside.y, smooth));
    };
    step = std::max(step, apart(true));
    facets += apart(false) / 400;
  }
  printf("smooth normals: %.1e apart at edges, of triangles %.1e in the mean\n", step, facets);
  EXPECT_LT(step, 2e-6);  // measured: 3.6e-7
  EXPECT_GT(facets, 0.1);
}

// Of a globe without relief they are vertical, at the seam of the map as elsewhere.
TEST(Ground, SmoothNormalsOfAGlobe) {
  const TemporaryFolder folder;
  std::string label = label_of(Kind::cylindrical, 720, 360), data;
  label.replace(label.find("MAP_RESOLUTION = 10"), 19, "MAP_RESOLUTION = 2");
  for (int k = 0; k < 720 * 360; ++k) data += bytes_of(0.0f, false);
  (void)folder.write("a.img", data);
  DiagnosticLog log;
  const auto dem = Dem::open(folder.write("a.lbl", label), {}, log);
  ASSERT_TRUE(dem) << to_text(log);
  ASSERT_TRUE(write_tiles({&*dem, 1}, folder / "a.pan", {}, log)) << to_text(log);
  auto tiles = Tiles::open(folder / "a.pan", log);
  ASSERT_TRUE(tiles) << to_text(log);
  const Ground ground(std::make_shared<const Tiles>(*std::move(tiles)));
  Draw draw;
  double worst = 0, flat = 0, rise = 0;
  for (int k = 0; k < 2000; ++k) {
    const double longitude = k % 4 == 0 ? 179.4 + 1.2 * draw() : 360 * draw() - 180;
    const GroundPoint p = ground.at({178 * (draw() - 0.5), longitude});
    ASSERT_TRUE(p) << k;
    const SmoothGround smooth = ground.smooth(p);
    const Vec3 up = glm::normalize(p.position);
    worst = std::max(worst, glm::length(smooth.normal - up));
    flat = std::max(flat, glm::length(p.normal - up));
    // twice the depth below the sphere, at most
    EXPECT_LE(smooth.rise, -2.1 * p.height + 1e-9) << k;
    EXPECT_GE(smooth.rise, -p.height - 1e-9) << k;
    rise = std::max(rise, smooth.rise);
  }
  printf("normals of a globe: smooth %.1e, of triangles %.1e; rise %.2f m\n", worst, flat, rise);
  EXPECT_LT(worst, 1e-4);  // measured: 1.9e-5
  EXPECT_GT(flat, 2e-3);
}

// Beside voids and borders there is a normal too.
TEST(Ground, SmoothNormalsBesideVoids) {
  const Made made = make(Kind::plane, 300, 90, true);
  Draw draw;
  int points = 0;
  for (int k = 0; k < 3000; ++k) {
    const bool border = k % 2 == 0;
    const LatLon place{border ? -5 - 9 * draw() : -400 - 410 * draw(),
                       border ? 5 + 2980 * draw() : 1000 + 220 * draw()};
    const GroundPoint p = made.ground->at(place);
    if (!p) continue;
    ++points;
    const SmoothGround smooth = made.ground->smooth(p);
    ASSERT_NEAR(glm::length(smooth.normal), 1, 1e-12);
    ASSERT_GT(smooth.normal.z, 0.1);
    ASSERT_TRUE(smooth.rise >= 0 && smooth.rise < 100);
  }
  EXPECT_GT(points, 1500);
}

// Lines of sight between points above the ground against all triangles, from both ends; ranges
// straight down, and along an azimuth.
void expect_sights(const Made& made, double above) {
  const Ground& ground = *made.ground;
  Draw draw;
  std::vector<GroundSight> asked;
  for (int k = 0; k < 300; ++k) {
    const auto pick = [&] {
      return made.points[static_cast<std::size_t>(draw() * double(made.points.size()))];
    };
    const Vec3 from = pick(), to = pick();
    const Vec3 up = ground.tiles().map(0).is_placed() ? glm::normalize(from) : Vec3(0, 0, 1);
    asked.push_back({from + above * draw() * up, to + above * draw() * up});
  }
  std::vector<std::uint8_t> open(asked.size()), back(asked.size());
  sights(ground, asked, 1e-4, open);
  for (GroundSight& each : asked) std::swap(each.from, each.to);
  sights(ground, asked, 1e-4, back);
  EXPECT_EQ(open, back);
  int free = 0;
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const Vec3 line = asked[k].to - asked[k].from;
    const double length = glm::length(line);
    bool blocked = false;
    for (const auto& triangle : made.triangles) {
      const auto t = brute(triangle, asked[k].from, line / length);
      blocked = blocked || (t && *t >= 1e-4 && *t <= length - 1e-4);
    }
    EXPECT_EQ(open[k] == 0, blocked) << k;
    free += open[k];
  }
  EXPECT_GT(free, 20);
  EXPECT_LT(free, 280);
}

TEST(Ground, LinesOfSightOnAPlane) { expect_sights(make(Kind::plane, 300, 90, false), 60); }
TEST(Ground, LinesOfSightOnAPolarMap) { expect_sights(make(Kind::polar, 270, 130, false), 500); }

TEST(Ground, RangesFromPlaces) {
  for (const Kind kind : {Kind::plane, Kind::cylindrical, Kind::polar}) {
    const Made made = make(kind, 270, 130, false);
    const Ground& ground = *made.ground;
    const LatLon place = kind == Kind::plane         ? LatLon{-655, 1355}
                         : kind == Kind::cylindrical ? LatLon{1.23, -4.56}
                                                     : LatLon{-88, 30};
    const auto from = point_above(ground, place, 12.5);
    ASSERT_TRUE(from);
    const LocalAxes axes = local_axes(ground, place);
    std::vector<GroundRay> rays{{*from, direction_at(axes, 1, -kPi / 2)},
                                {*from, direction_at(axes, 0.3, kPi / 2)}};
    std::vector<double> metres(2);
    ranges(ground, rays, 0, metres);
    // measured: 1e-11
    EXPECT_NEAR(metres[0], 12.5, 1e-9);
    EXPECT_EQ(metres[1], std::numeric_limits<double>::infinity());
    // a step to the north and to the east
    if (kind == Kind::plane) continue;
    const double angle = 1e-5;
    const auto moved = [&](double azimuth) {
      return glm::normalize(*from + 50000 * angle * direction_at(axes, azimuth, 0));
    };
    const auto at = [](double latitude, double longitude) {
      const double y = latitude * kDegree, x = longitude * kDegree;
      return Vec3(std::cos(y) * std::cos(x), std::cos(y) * std::sin(x), std::sin(y));
    };
    const double degrees =
        glm::length(*from) > 0 ? angle * 50000 / glm::length(*from) / kDegree : 0;
    EXPECT_LT(glm::length(moved(0) - at(place.latitude + degrees, place.longitude)), 1e-9);
    EXPECT_LT(glm::length(moved(kPi / 2) -
                          at(place.latitude,
                             place.longitude + degrees / std::cos(place.latitude * kDegree))),
              1e-8);
  }
}

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
