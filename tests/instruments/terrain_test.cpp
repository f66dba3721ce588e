// Look-ups, LiDARs and RADARs over terrain against every triangle and closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "instruments/lidar.h"
#include "instruments/lookup.h"
#include "instruments/radar.h"
#include "materials/sample.h"
#include "preview/reference/reference.h"
#include "tests/support/terrain_models.h"
#include "tests/trace/trace_models.h"

namespace panwright::instruments::terrain_test {
namespace {

using trace::testing_support::add;
using trace::testing_support::box;
using trace::testing_support::Random;
using trace::testing_support::single;
using Real = long double;
using Point = std::array<Real, 3>;

constexpr int kSide = 129;

double height_at(int column, int row) {
  return 6 * std::sin(0.21 * column) * std::cos(0.17 * row) +
         0.03 * ((column * 37 + row * 91) % 29);
}

std::vector<float> hills() {
  std::vector<float> out;
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column)
      out.push_back(static_cast<float>(height_at(column, row)));
  return out;
}

Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Real dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point point(const Vec3& v) { return {v.x, v.y, v.z}; }

struct Facet {
  std::array<Point, 3> corner;  // world
  std::uint32_t target = 0;
};

// Terrain turned and far from the origin, and a craft over it.
struct Site {
  world::World world;
  world::Pose ground{{3e5, -2e5, 4e5}, glm::normalize(Quat(0.7, 0.3, -0.5, 0.2))};
  world::Pose craft;
  std::vector<Facet> facets;

  Vec3 place(const Vec3& local) const { return ground.rotation * local + ground.translation; }

  Site() {
    DiagnosticLog log;
    const std::vector<float> heights = hills();
    EXPECT_TRUE(world.add("ground", support::plane_model(kSide, heights), ground, log));
    craft = {place({4, -3, 20}), glm::normalize(Quat(0.2, 0.9, 0.1, -0.4))};
    const geometry::Mesh mesh = box({3, 2, 4});
    add(world, "craft", single(mesh), craft);
    const auto post = [&](int column, int row) {
      return placed(ground, {column - 64.0, 64.0 - row,
                             double(heights[static_cast<std::size_t>(row * kSide + column)])});
    };
    for (int row = 0; row + 1 < kSide; ++row)
      for (int column = 0; column + 1 < kSide; ++column) {
        const Point a = post(column, row), b = post(column + 1, row), c = post(column, row + 1),
                    d = post(column + 1, row + 1);
        facets.push_back({{a, d, b}, 1});
        facets.push_back({{a, c, d}, 1});
      }
    for (const auto& triangle : mesh.triangles) {
      Facet facet;
      facet.target = 2;
      for (std::size_t k = 0; k < 3; ++k)
        facet.corner[k] = placed(craft, mesh.positions[triangle[k]]);
      facets.push_back(facet);
    }
  }

  // In extended precision.
  static Point placed(const world::Pose& pose, const Vec3& v) {
    const Real w = pose.rotation.w, x = pose.rotation.x, y = pose.rotation.y, z = pose.rotation.z;
    const Point u{x, y, z}, p = point(v), uv = cross(u, p), uuv = cross(u, uv);
    Point out;
    for (std::size_t k = 0; k < 3; ++k)
      out[k] = p[k] + 2 * (w * uv[k] + uuv[k]) + Real(pose.translation[static_cast<int>(k)]);
    return out;
  }

  std::pair<Real, std::uint32_t> met(const geometry::Ray& ray) const {
    std::pair<Real, std::uint32_t> best{std::numeric_limits<Real>::infinity(), 0};
    const Point origin = point(ray.origin), along = point(ray.direction);
    const Real length = std::sqrt(dot(along, along));
    for (const Facet& facet : facets) {
      const Point ab = facet.corner[1] - facet.corner[0], ac = facet.corner[2] - facet.corner[0];
      const Point p = cross(along, ac);
      const Real det = dot(ab, p);
      if (det == 0) continue;
      const Point from = origin - facet.corner[0];
      const Real u = dot(from, p) / det;
      const Point q = cross(from, ab);
      const Real v = dot(along, q) / det, t = dot(ac, q) / det * length;
      if (t < 0 || u < 0 || v < 0 || u + v > 1 || t >= best.first) continue;
      best = {t, facet.target};
    }
    return best;
  }
};

TEST(TerrainLookups, RaysAreThoseOfEveryTriangle) {
  const Site site;
  Lookups lookups;
  lookups.update(site.world);
  Random random(3);
  std::vector<geometry::Ray> rays;
  for (int k = 0; k < 300; ++k) {
    const double reach = k % 3 == 0 ? 5e5 : k % 3 == 1 ? 300 : 30;
    const Vec3 aim =
        site.place(k % 5 == 0 ? Vec3(4, -3, 20) + random.in_cube(2)
                              : Vec3(random.between(-63, 63), random.between(-63, 63), 0));
    const Vec3 eye =
        site.place(Vec3(random.between(-0.4, 0.4), random.between(-0.4, 0.4), 1) * reach);
    rays.push_back({eye, glm::normalize(aim - eye)});
  }
  std::vector<SurfacePoint> found(rays.size());
  lookups.rays(rays, found);
  std::array<int, 3> seen{};
  double worst = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const auto [distance, target] = site.met(rays[k]);
    ASSERT_EQ(found[k].ids.target, target) << k;
    ++seen[target];
    if (target == 0) continue;
    worst = std::max(worst, std::fabs(static_cast<double>(found[k].distance - distance)));
    // measured: 1.6e-9 m, of ranges of 5e5 m in a world whose coordinates reach 1e6 m
    EXPECT_NEAR(found[k].distance, static_cast<double>(distance), 5e-9) << k;
    if (target != 1) continue;
    EXPECT_EQ(found[k].ids.node, 1u);
    EXPECT_EQ(found[k].ids.material, 0u);
    EXPECT_EQ(found[k].ids.instance, 0u);
    EXPECT_LT(glm::dot(found[k].facet, rays[k].direction), 0);
    EXPECT_LT(glm::length(site.place(found[k].in_model) - found[k].position), 1e-9);
  }
  printf("look-ups of terrain: %.1e m; %d and %d hits\n", worst, seen[1], seen[2]);
  EXPECT_GT(seen[1], 150);
  EXPECT_GT(seen[2], 20);
}

TEST(TerrainLookups, PixelsAreThoseOfTheImage) {
  const Site site;
  DiagnosticLog log;
  world::Camera camera;
  world::set_field_of_view(camera, 48, 36, 60 * kDegree);
  camera.position = site.place({40, -50, 30});
  camera.world_from_camera = *world::looking_at(camera.position, site.place({0, 0, 5}),
                                                site.ground.rotation * Vec3(0, 0, 1), log);
  preview::ReferenceOptions options;
  options.samples = 8;
  options.bounces = 0;
  options.ground_truth = true;
  const auto image = preview::Reference().render(site.world, camera, options, log);
  ASSERT_TRUE(image) << to_text(log);
  Lookups lookups;
  lookups.update(site.world);
  std::vector<Vec2> places;
  for (int y = 0; y < 36; ++y)
    for (int x = 0; x < 48; ++x) places.emplace_back(x + 0.5, y + 0.5);
  std::vector<SurfacePoint> found(places.size());
  lookups.pixels(camera, places, found);
  std::array<int, 3> seen{};
  for (std::size_t i = 0; i < places.size(); ++i) {
    const image::Image& layers = image->image;
    ASSERT_EQ(found[i].ids.target, layers.target_id[i]) << i;
    ASSERT_EQ(found[i].ids.node, layers.node_id[i]) << i;
    ASSERT_EQ(found[i].ids.material, layers.material_id[i]) << i;
    ++seen[layers.target_id[i]];
    if (!found[i]) continue;
    EXPECT_FLOAT_EQ(static_cast<float>(found[i].distance), layers.range[i]) << i;
  }
  EXPECT_GT(seen[1], 500);
  EXPECT_GT(seen[2], 4);
}

TEST(TerrainLookups, NearestOfGroundAndCraft) {
  const Site site;
  Lookups lookups;
  lookups.update(site.world);
  Random random(5);
  std::vector<Vec3> points;
  for (int k = 0; k < 60; ++k)
    points.push_back(site.place(Vec3(random.in_cube(k % 2 == 0 ? 60 : 2000))));
  std::vector<SurfacePoint> found(points.size());
  lookups.nearest(points, found);
  int grounds = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    Real want = std::numeric_limits<Real>::infinity();
    std::uint32_t target = 0;
    for (const Facet& facet : site.facets) {
      const Point& a = facet.corner[0];
      const Point normal = cross(facet.corner[1] - a, facet.corner[2] - a), p = point(points[k]);
      bool within = true;
      Real own = std::numeric_limits<Real>::infinity();
      for (std::size_t c = 0; c < 3; ++c) {
        const Point &from = facet.corner[c], side = facet.corner[(c + 1) % 3] - from, to = p - from;
        within = within && dot(cross(side, to), normal) >= 0;
        const Real share = std::clamp<Real>(dot(to, side) / dot(side, side), 0, 1);
        const Point off{to[0] - share * side[0], to[1] - share * side[1], to[2] - share * side[2]};
        own = std::min(own, std::sqrt(dot(off, off)));
      }
      if (within) own = std::fabs(dot(p - a, normal)) / std::sqrt(dot(normal, normal));
      if (own < want) want = own, target = facet.target;
    }
    ASSERT_EQ(found[k].ids.target, target) << k;
    // measured: 3e-10 m
    EXPECT_NEAR(found[k].distance, static_cast<double>(want), 5e-9) << k;
    const Vec3 off = points[k] - found[k].position;
    EXPECT_GE(glm::dot(found[k].facet, off), -1e-9) << k;
    grounds += target == 1;
  }
  EXPECT_GT(grounds, 30);
  EXPECT_LT(grounds, 60);
}

// A wall 5 m high at x = 0 and a keypoint behind it.
TEST(TerrainLookups, SightsElevationsAndKeypoints) {
  std::vector<float> heights;
  for (int row = 0; row < 65; ++row)
    for (int column = 0; column < 65; ++column) heights.push_back(column == 32 ? 5.0f : 0.0f);
  world::World world;
  DiagnosticLog log;
  ASSERT_TRUE(world.add("ground", support::plane_model(65, heights), log));
  pan::Contents contents = single(box({1, 1, 1}));
  contents.keypoints.push_back({"top", 0, Vec3(0, 0, 0.5)});
  add(world, "craft", contents, {{4, 0, 0.5}, Quat(1, 0, 0, 0)});
  Lookups lookups;
  lookups.update(world);
  const std::vector<Sight> sights{
      {{-4, 0, 1}, {4, 3, 1}}, {{-4, 0, 6}, {4, 3, 6}}, {{2, 3, 1}, {9, 3, 1}}};
  std::vector<std::uint8_t> open(3);
  lookups.sights(sights, 1e-3, open);
  EXPECT_EQ(open, (std::vector<std::uint8_t>{0, 1, 1}));
  const std::vector<Vec2> places{{0, 7}, {0.25, 7}, {4, 0}, {9, 9}, {40, 0}};
  std::vector<SurfacePoint> found(places.size());
  lookups.elevations(places, found);
  EXPECT_EQ(found[0].position.z, 5);
  EXPECT_EQ(found[1].position.z, 3.75);
  EXPECT_EQ(found[2].position.z, 1);
  EXPECT_EQ(found[2].ids.target, 2u);
  EXPECT_EQ(found[3].position.z, 0);
  EXPECT_FALSE(found[4]);
  world::Sun sun = world.sun();
  for (const bool high : {false, true}) {
    sun.direction = glm::normalize(Vec3(-1, 0, high ? 2 : 0.3));
    world.set_sun(sun);
    lookups.update(world);
    world::Camera camera;
    world::set_field_of_view(camera, 64, 64, 40 * kDegree);
    camera.position = {-10, 0, high ? 20.0 : 2.0};
    camera.world_from_camera = *world::looking_at(camera.position, {4, 0, 0}, Vec3(0, 0, 1), log);
    const auto keypoints = lookups.keypoints(camera);
    ASSERT_EQ(keypoints[1].size(), 1u);
    EXPECT_EQ(keypoints[1][0].occluded, !high);
    EXPECT_EQ(keypoints[1][0].lit, high);
  }
}

Lidar flash(std::uint32_t size, double fov) {
  Lidar lidar;
  lidar.scan.columns = lidar.scan.rows = size;
  lidar.scan.fov = fov;
  lidar.excess_noise = 0;
  lidar.sun = false;
  lidar.quantum_efficiency = 1;
  lidar.threshold_e = 1e-9;
  lidar.method = RangeMethod::peak;
  return lidar;
}

TEST(TerrainLidar, RangesAreThoseOfEveryTriangle) {
  const Site site;
  DiagnosticLog log;
  const world::Pose pose{
      site.place({10, -60, 70}),
      *world::looking_at(site.place({10, -60, 70}), site.place({0, 0, 3}), Vec3(0, 0, 1), log)};
  LidarOptions options;
  options.ideal = true;
  const auto cloud = measure(flash(24, 40 * kDegree), site.world, pose, options, log);
  ASSERT_TRUE(cloud) << to_text(log);
  ASSERT_GT(cloud->points.size(), 400u);
  double worst = 0;
  int crafts = 0;
  for (const LidarPoint& p : cloud->points) {
    const auto [distance, target] =
        site.met({pose.translation, pose.rotation * cloud->pulses[p.pulse].direction});
    ASSERT_EQ(p.ids.target, target);
    worst = std::max(worst, std::fabs(p.range / static_cast<double>(distance) - 1));
    // measured: 1.4e-15 of 100 m, in world coordinates of 5e5 m
    EXPECT_NEAR(p.range / static_cast<double>(distance), 1, 1e-13);
    crafts += target == 2;
  }
  printf("ranges of a LiDAR: %.1e\n", worst);
  EXPECT_GT(crafts, 1);
}

// Level ground under an oblique beam: the regolith's f cos at zero phase, over the square of the
// range.
TEST(TerrainLidar, IntensityIsThatOfTheRegolith) {
  world::World world;
  DiagnosticLog log;
  ASSERT_TRUE(world.add("ground", support::plane_model(65, std::vector<float>(65 * 65, 0)), log));
  materials::Material regolith;
  regolith.diffuse = Vec3(1);
  regolith.diffuse_brdf = materials::Hapke{
      .w = 0.384, .h = 0.052, .b0 = 1.70, .roughness = 23.657 * kDegree, .b = 0.229, .c = 0.426};
  materials::fit(regolith);
  for (const double tilt : {0.0, 35.0, 60.0}) {
    const Vec3 away(std::sin(tilt * kDegree), 0, std::cos(tilt * kDegree));
    const world::Pose pose{12.0 * away,
                           *world::looking_at(12.0 * away, Vec3(0), Vec3(0, 1, 0), log)};
    Lidar lidar = flash(1, 0.01);
    lidar.scan = {};
    lidar.scan.pattern = ScanPattern::file;
    lidar.scan.table.emplace_back(0, 0, 0);
    LidarOptions options;
    options.ideal = true;
    const auto cloud = measure(lidar, world, pose, options, log);
    ASSERT_TRUE(cloud && cloud->points.size() == 1) << to_text(log);
    const double f =
        materials::Scattering(regolith).brdf(away, away, Vec3(0, 0, 1), Vec3(0), Vec3(1)).x;
    const LidarPoint& p = cloud->points[0];
    EXPECT_NEAR(p.range, 12, 1e-12);
    EXPECT_NEAR(p.cosine, away.z, 1e-12);
    // that of a Lambert plate across the beam: pi f cos. Measured: 1e-15
    EXPECT_NEAR(p.reflectance, kPi * f * away.z, 1e-9 * p.reflectance);
  }
}

Radar altimeter(const std::string& material) {
  Radar radar;
  radar.frequency = 4.3e9;
  radar.bandwidth = 150e6;
  radar.pattern = BeamPattern::uniform;
  radar.beam = Vec2(30 * kDegree);
  radar.range = Vec2(40, 60);
  radar.speed = Vec2(-1, 1);
  radar.noise_figure = 0;
  radar.altimeter = 0.5;
  radar.surfaces = {{material, ScatterLaw::cosine, 0.4, 3}};
  return radar;
}

// Echoes of level ground from 50 m: its cross-section is the integral of sigma-nought over the
// ground within the beam, an ellipse of azimuth and elevation.
TEST(TerrainRadar, AltitudeAndSectionOfLevelGround) {
  world::World world;
  DiagnosticLog log;
  ASSERT_TRUE(
      world.add("ground", support::plane_model(129, std::vector<float>(129 * 129, 0)), log));
  const RadarMoment moment{
      world, {{0, 0, 50}, *world::looking_at({0, 0, 50}, Vec3(0), Vec3(0, 1, 0), log)}};
  RadarOptions ideal;
  ideal.ideal = true;
  const auto found = measure(altimeter("terrain"), moment, nullptr, ideal, log);
  ASSERT_TRUE(found) << to_text(log);
  EXPECT_TRUE(log.entries().empty()) << to_text(log);
  ASSERT_TRUE(found->altitude);
  printf("altitude: %.3f m\n", *found->altitude);
  // measured: 49.944 m, of cells of 1 m
  EXPECT_NEAR(*found->altitude, 50, 0.25);
  double section = 0;
  constexpr int kSteps = 2000;
  const double most = std::tan(15.2 * kDegree), step = 2 * most / kSteps;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double x = (i + 0.5) * step - most, y = (j + 0.5) * step - most;
      const double cosine = 1 / std::sqrt(1 + x * x + y * y);
      const double off = std::hypot(std::atan(x), std::asin(y * cosine));
      if (off <= 15 * kDegree) section += 50 * 50 * step * step * 0.4 * cosine * cosine * cosine;
    }
  printf("cross-section: %.5f of the closed form\n", found->targets[0].cross_section / section);
  // measured: 1.6e-4
  EXPECT_NEAR(found->targets[0].cross_section / section, 1, 1e-3);
  // of another material: terrain is guessed, and that is said
  ASSERT_TRUE(measure(altimeter("steel"), moment, nullptr, ideal, log));
  ASSERT_EQ(log.entries().size(), 1u);
  EXPECT_EQ(log.entries()[0].code, Code("W0264"));
  EXPECT_NE(log.entries()[0].message.find("'terrain'"), std::string::npos);
}

}  // namespace
}  // namespace panwright::instruments::terrain_test
