// Transport in worlds: thin plates, several targets, what is kept, the same bits.
#include "transport/transport.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "tests/transport/transport_models.h"

namespace panwright::transport::transport_test {
namespace {

using namespace testing_support;

constexpr TransportOptions kFew{{600, 32}, 8};

pan::Contents contents_of(const geometry::Mesh& mesh, double albedo) {
  pan::Contents contents;
  contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  contents.materials.emplace_back();
  contents.materials[0].diffuse = Vec3(albedo);
  contents.instances.push_back({0, 0, 0, -1});
  contents.meshes.push_back(pan::packed(mesh, "mesh"));
  return contents;
}

// An L: a floor and a wall, lit from above.
world::World corner() {
  const geometry::Mesh walls[] = {sheet({0, -1, 0}, {1, 0, 0}, {0, 2, 0}),
                                  sheet({0, -1, 0}, {0, 2, 0}, {0, 0, 1})};
  world::World world = world_of(walls, 0.6);
  world.set_sun({.direction = {0, 0, 1}});
  return world;
}

bool same(std::span<const light::SurfelLight> a, std::span<const light::SurfelLight> b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i].irradiance != b[i].irradiance || a[i].grid->cells != b[i].grid->cells ||
        a[i].grid->entries != b[i].grid->entries)
      return false;
  return true;
}

// Grids leave lists out where no surface is. At places of other points all is found, to the last
// bit.
TEST(Transport, ListsStandWhereSurfacesAre) {
  const geometry::Mesh plate = support::box({2, 2, 0.02}), round = ball(0.7, 24);
  const geometry::Mesh both[] = {plate, round};
  const world::World world = world_of(both, 0.8);
  const Solved solved(world, {2000, 32}), finer(world, {5000, 40});
  std::vector<light::SurfacePlace> places;
  for (const Point& point : solved.set->points()) places.push_back({point.start, point.normal});
  const auto grid = [&](std::span<const light::SurfacePlace> where) {
    light::SurfelLight light = solved.shown(std::vector<double>(solved.size(), 0));
    for (std::size_t i = 0; i < solved.size(); ++i)
      light.irradiance[i][0] = static_cast<float>(1 + 0.01 * static_cast<double>(i % 97));
    light.grid = std::make_shared<const light::SurfelGrid>(
        light::surfel_grid(solved.set->surfels(), 0.5 * solved.set->spacing(), where));
    return light;
  };
  const light::SurfelLight all = grid({}), some = grid(places);
  EXPECT_LT(some.grid->entries.size(), 0.8 * static_cast<double>(all.grid->entries.size()));
  std::size_t holes = 0;
  for (const Point& point : finer.set->points()) {
    const Vec3 found = irradiance_at(some, point.start, point.normal);
    EXPECT_EQ(found, irradiance_at(all, point.start, point.normal));
    holes += found.x == 0;
  }
  // where the ball meets the plate, beyond all limits; measured: 1.6e-4
  EXPECT_LT(static_cast<double>(holes), 4e-4 * static_cast<double>(finer.set->points().size()));
}

// What interreflections add to an image of a corner of which all is seen, from the irradiance that
// displays read.
TEST(Transport, ChangeSeenIsThatOfImages) {
  const geometry::Mesh both[] = {sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                                 sheet({0, 0, 0}, {0, 1, 0}, {0, 0, 1})};
  world::World world = world_of(both, 0.6);
  world.set_sun({.direction = glm::normalize(Vec3(1, 0.2, 0.4))});
  Transport transport({{3000, 32}, 8});
  transport.update(world, {});
  world::Camera camera;
  camera.position = {20, 0.5, 14};
  const Vec3 to_sun = world.sun().direction, white = light::incidence(world.sun(), {}).irradiance;
  double flux = 0, added = 0, square = 0, added_square = 0;
  constexpr int kSide = 60;
  for (int sheet = 0; sheet < 2; ++sheet)
    for (int i = 0; i < kSide * kSide; ++i) {
      const double u = (i % kSide + 0.5) / kSide, v = (i / kSide + 0.5) / kSide;
      const Vec3 at = sheet == 0 ? Vec3(u, v, 0) : Vec3(0, u, v);
      const Vec3 normal = sheet == 0 ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
      const Vec3 way = camera.position - at;
      const double seen = glm::dot(normal, way) / std::pow(glm::length(way), 3);
      const double direct = glm::dot(normal, to_sun) * white.x;
      const double other = irradiance_at(transport.light()[0], at, normal).x;
      flux += seen * (direct + other);
      added += seen * other;
      square += seen * (direct + other) * (direct + other);
      added_square += seen * other * other;
    }
  const Transport::Change change = transport.change_seen(world, camera);
  EXPECT_GT(change.of_flux(), 0.05);
  EXPECT_NEAR(change.of_flux(), added / flux, 0.01 * change.of_flux());
  EXPECT_NEAR(change.rms(), std::sqrt(added_square / square), 0.02 * change.rms());
  const double all = 0.6 / kPi * flux / (kSide * kSide);
  EXPECT_NEAR(change.flux, all, 0.01 * all);
  // the other sides face this one
  camera.position = {-20, 0.5, -14};
  EXPECT_EQ(transport.change_seen(world, camera).flux, 0);
}

// The dark side of a plate 2 cm thick, over a sunlit floor's reach, gets nothing of it: light
// neither goes round nor through.
TEST(Transport, ThinPlatesDoNotLeak) {
  // a closed trough: its inside is lit through nothing but the plate's other side
  geometry::Mesh plate = support::box({2, 2, 0.02});
  geometry::Mesh wall = support::box({0.02, 2, 1});
  for (Vec3& p : wall.positions) p += Vec3(0.9, 0, 0.51);
  const geometry::Mesh both[] = {plate, wall};
  world::World world = world_of(both, 0.8);
  world.set_sun({.direction = {-1, 0, 1}});
  Transport transport({{4000, 32}, 8});
  transport.update(world, {});
  double lit = 0, dark = 0;
  for (int i = 0; i < 100; ++i) {
    const Vec3 at(0.019 * i - 1 + 0.05, 0.1, 0.01);
    if (std::fabs(at.x - 0.9) < 0.02) continue;
    lit = std::max(lit, irradiance_at(transport.light()[0], at, {0, 0, 1}).x);
    dark = std::max(dark, irradiance_at(transport.light()[0], {at.x, at.y, -0.01}, {0, 0, -1}).x);
  }
  EXPECT_GT(lit, 0.1);
  EXPECT_LT(dark, 1e-6);  // white is 1; measured: 0
}

geometry::Mesh box_at(const Vec3& low, const Vec3& high) {
  geometry::Mesh mesh = support::box(high - low);
  for (Vec3& p : mesh.positions) p += 0.5 * (low + high);
  return mesh;
}

// Largest light at places of a rectangle. White is 1; measured on dark ones below: 0, on lit ones
// 0.4 to 0.5.
double most_light(const Transport& transport, const Vec3& corner, const Vec3& along,
                  const Vec3& across) {
  constexpr int kSide = 41;
  const Vec3 normal = glm::normalize(glm::cross(along, across));
  double most = 0;
  for (int i = 0; i < kSide * kSide; ++i) {
    const double u = (i % kSide + 0.5) / kSide, v = (i / kSide + 0.5) / kSide;
    most = std::max(most,
                    irradiance_at(transport.light()[0], corner + u * along + v * across, normal).x);
  }
  return most;
}

// A plate 2 cm thick stands on a wide floor, its foot within surfels of 0.1 m. The Sun lights the
// floor before it; behind it nothing is lit, nor sees what is.
TEST(Transport, PlatesOnAFloorDoNotLeak) {
  const geometry::Mesh meshes[] = {box_at({-1, -1, -0.02}, {1, 1, 0}),
                                   box_at({-0.01, -1, 0}, {0.01, 1, 1.2})};
  world::World world = world_of(meshes, 0.8);
  world.set_sun({.direction = {1, 0, 1}});
  Transport transport({{2000, 32}, 8});
  transport.update(world, {});
  const double near = most_light(transport, {0.01, -1, 0}, {0.05, 0, 0}, {0, 2, 0});
  EXPECT_GT(near, 0.15);
  EXPECT_LT(most_light(transport, {-1, -1, 0}, {0.99, 0, 0}, {0, 2, 0}), 1e-3);
  EXPECT_LT(most_light(transport, {-0.01, -1, 0}, {0, 0, 1.2}, {0, 2, 0}), 1e-3);
}

// A closed room of plates of 2 cm on a floor that goes on outside, in the Sun.
TEST(Transport, ClosedRoomsAreDark) {
  const geometry::Mesh meshes[] = {
      box_at({-2, -2, -0.02}, {2, 2, 0}),       box_at({-0.5, -0.5, 0}, {-0.48, 0.5, 1}),
      box_at({0.48, -0.5, 0}, {0.5, 0.5, 1}),   box_at({-0.48, -0.5, 0}, {0.48, -0.48, 1}),
      box_at({-0.48, 0.48, 0}, {0.48, 0.5, 1}), box_at({-0.5, -0.5, 1}, {0.5, 0.5, 1.02}),
  };
  world::World world = world_of(meshes, 0.8);
  world.set_sun({.direction = {1, 0.3, 1}});
  Transport transport({{4000, 32}, 8});
  transport.update(world, {});
  EXPECT_GT(most_light(transport, {0.5, -0.5, 0}, {0.1, 0, 0}, {0, 1, 0}), 0.1);
  EXPECT_LT(most_light(transport, {-0.48, -0.48, 0}, {0.96, 0, 0}, {0, 0.96, 0}), 1e-3);
  EXPECT_LT(most_light(transport, {-0.48, -0.48, 1}, {0, 0.96, 0}, {0.96, 0, 0}), 1e-3);
  EXPECT_LT(most_light(transport, {-0.48, -0.48, 0}, {0, 0.96, 0}, {0, 0, 1}), 1e-3);
  EXPECT_LT(most_light(transport, {0.48, -0.48, 0}, {0, 0, 1}, {0, 0.96, 0}), 1e-3);
}

// Shelves 2 cm thick and 2 cm apart, under a lit wall: the middles of the gaps are dark, however
// wide surfels are.
TEST(Transport, ShelvesDoNotLeak) {
  const geometry::Mesh meshes[] = {
      box_at({-1, -1, 0}, {1, 1, 0.02}),          box_at({-1, -1, 0.04}, {1, 1, 0.06}),
      box_at({-1, -1, 0.08}, {1, 1, 0.1}),        box_at({0.88, -1, 0.1}, {0.9, 1, 1.1}),
      box_at({-1.02, -1, 0}, {-1, 1, 0.1}),       box_at({1, -1, 0}, {1.02, 1, 0.1}),
      box_at({-1.02, -1.02, 0}, {1.02, -1, 0.1}), box_at({-1.02, 1, 0}, {1.02, 1.02, 0.1})};
  world::World world = world_of(meshes, 0.8);
  world.set_sun({.direction = {-1, 0, 1}});
  Transport transport({{2000, 32}, 8});
  transport.update(world, {});
  EXPECT_GT(most_light(transport, {0.5, -0.5, 0.1}, {0.3, 0, 0}, {0, 1, 0}), 0.1);
  for (const double gap : {0.02, 0.06}) {
    const Vec3 low(-1, -1, gap), high(-1, -1, gap + 0.02);
    EXPECT_LT(most_light(transport, low, {2, 0, 0}, {0, 2, 0}), 1e-3);
    EXPECT_LT(most_light(transport, high, {0, 2, 0}, {2, 0, 0}), 1e-3);
  }
  EXPECT_LT(most_light(transport, {-1, -1, 0}, {0, 2, 0}, {2, 0, 0}), 1e-3);
}

// What a wall sends a floor in closed form: the Sun's light on the floor comes back from the wall.
TEST(Transport, SunAndEmissionAreThoseOfTheOracles) {
  world::World world = corner();
  world.set_sun({.direction = {1, 0, 1}});
  Transport transport({{4000, 32}, 1});
  transport.update(world, {});
  // both are lit with √½: the factor from a place x before a wall of height 1, from −1 to 1
  const auto& light = transport.light()[0];
  const double x = 0.3;
  const auto factor = [&](double half, double height) {
    // a rectangle at a right angle, beginning at the place's foot: J. Howell's C-11, twice
    const double a = std::atan(half / x), c = std::sqrt(x * x + height * height);
    return (a - x / c * std::atan(half / c)) / kPi;
  };
  double mean = 0;
  for (int i = 0; i < 50; ++i)
    mean += irradiance_at(light, {x, 0.004 * i - 0.1, 0}, {0, 0, 1}).x / 50;
  const double expected = 0.6 * std::sqrt(0.5) * factor(1, 1);
  EXPECT_NEAR(mean, expected, 0.02 * expected);
}

// In even light from all sides white surfaces send as much as they would get from there: what comes
// from others is the share of the view that they take. Perpendicular squares: J. Howell's C-15.
TEST(Transport, EvenLightOfTerrain) {
  const geometry::Mesh both[] = {sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                                 sheet({0, 0, 0}, {0, 1, 0}, {0, 0, 1})};
  world::World world = world_of(both, 1);
  world.set_sun({.direction = {0, 0, 1}, .irradiance = Vec3(0)});
  light::GroundShine shine;
  shine.stamp = next_stamp();
  constexpr std::size_t kTexels =
      std::size_t{light::GroundShine::kSide} * light::GroundShine::kSide;
  constexpr double kRadiance = 0.3;
  shine.radiance.assign(kTexels, Vec3(kRadiance));
  shine.is_ground.assign(kTexels, 1);
  Transport transport({{3000, 64}, 16});
  const auto mean = [&] {
    double sum = 0, area = 0;
    const SurfelSet& set = transport.surfels(0);
    for (std::size_t s = 0; s < set.surfels().size(); ++s) {
      // their backs see light alone
      const Vec3& normal = set.surfels()[s].normal;
      if (normal.x + normal.z < 0) continue;
      sum += set.area(s) * double(transport.light()[0].irradiance[s][0]);
      area += set.area(s);
    }
    return sum / area;
  };
  transport.update(world, {}, {&shine, 1});
  EXPECT_NEAR(mean() / (kPi * kRadiance), 0.2000438, 5e-4);  // measured: 7e-5
  transport.update(world, {});
  EXPECT_EQ(mean(), 0);
}

TEST(Transport, SameBitsWhateverWasBefore) {
  Transport kept(kFew);
  kept.update(corner(), {});
  world::World other = corner();
  other.set_sun({.direction = {1, 0.2, 1}});
  kept.update(other, {});
  Transport fresh(kFew);
  run_on_threads(Job({3, {}}), [&] { fresh.update(other, {}); });
  EXPECT_TRUE(same(kept.light(), fresh.light()));
  EXPECT_EQ(kept.counts().lights, 2u);
}

TEST(Transport, OnlyWhatChangedIsComputed) {
  world::World world = corner();
  Transport transport(kFew);
  transport.update(world, {});
  transport.update(world, {});
  EXPECT_EQ(transport.counts().lights, 1u);
  world.set_sun({.direction = {1, 0, 1}});
  transport.update(world, {});
  EXPECT_EQ(transport.counts().lights, 2u);
  EXPECT_EQ(transport.counts().lists, 1u);
  world.set_pose(0, {{5, 0, 0}, {1, 0, 0, 0}});
  transport.update(world, {});
  EXPECT_EQ(transport.counts().lists, 1u);  // alone, wherever it stands
  EXPECT_EQ(transport.counts().lights, 3u);
}

// Nothing flickers when the Sun turns: rays are the same for all its directions.
TEST(Transport, TheSunTurnsWithoutFlicker) {
  materials::Material metal;
  metal.diffuse = Vec3(0.3);
  metal.specular = Vec3(0.6);
  metal.weights = {1, 1, 0};
  metal.specular_brdf = materials::with_slopes(materials::SpecularModel::ggx, Vec2(0.3));
  materials::fit(metal);
  const geometry::Mesh walls[] = {sheet({0, -1, 0}, {1, 0, 0}, {0, 2, 0}),
                                  sheet({0, -1, 0}, {0, 2, 0}, {0, 0, 1}),
                                  support::box({0.2, 0.3, 1.1})};
  world::World world = world_of(walls, metal);
  Transport transport({{1500, 32}, 8});
  constexpr int kSteps = 100;
  std::vector<double> light;
  for (int step = 0; step <= kSteps; ++step) {
    const double turn = (40 + step / double{kSteps}) * kDegree;
    world.set_sun({.direction = {std::cos(turn), 0.2, std::sin(turn)}});
    transport.update(world, {});
    double sum = 0;
    for (int i = 0; i < 100; ++i)
      sum += irradiance_at(transport.light()[0],
                           {0.095 * (i % 10) + 0.02, 0.19 * (i / 10) - 0.9, 0}, {0, 0, 1})
                 .x;
    light.push_back(sum / 100);
  }
  double worst = 0;
  for (std::size_t i = 1; i + 1 < light.size(); ++i)
    worst = std::max(worst, std::fabs(light[i - 1] - 2 * light[i] + light[i + 1]));
  EXPECT_GT(light[50], 0.01);
  EXPECT_LT(worst, 1e-3 * light[50]);
}

// Two facing squares as two targets light each other as one target of both does.
TEST(Transport, TargetsLightEachOther) {
  world::World world;
  add(world, "floor", contents_of(sheet({-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0}), 0.5));
  add(world, "lid", contents_of(sheet({-0.5, -0.5, 0}, {0, 1, 0}, {1, 0, 0}), 0.5),
      {{0, 0, 1}, {1, 0, 0, 0}});
  std::vector<light::Source> lamps;
  lamps.push_back(light::Point{.position = {0, 0, 0.5}, .intensity = Vec3(1), .radius = 0});
  world.set_sun({.direction = {0, 0, 1}, .irradiance = Vec3(0)});
  Transport transport({{1500, 32}, 8});
  transport.update(world, lamps);
  const geometry::Mesh plates[] = {sheet({-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0}),
                                   sheet({-0.5, -0.5, 1}, {0, 1, 0}, {1, 0, 0})};
  world::World one = world_of(plates, 0.5);
  one.set_sun(world.sun());
  Transport together({{3000, 32}, 8});
  together.update(one, lamps);
  for (const Vec3& at : {Vec3(0, 0, 0), Vec3(0.3, -0.2, 0), Vec3(-0.4, 0.4, 0)}) {
    const double apart = irradiance_at(transport.light()[0], at, {0, 0, 1}).x;
    EXPECT_GT(apart, 0.01);
    EXPECT_NEAR(apart, irradiance_at(together.light()[0], at, {0, 0, 1}).x, 0.05 * apart);
  }
  // far apart they do not
  world.set_pose(1, {{0, 0, 1e4}, {1, 0, 0, 0}});
  transport.update(world, lamps);
  EXPECT_LT(irradiance_at(transport.light()[0], {0, 0, 0}, {0, 0, 1}).x, 1e-7);
}

TEST(Transport, ListsAreKeptBetweenRuns) {
  const auto folder = std::filesystem::temp_directory_path() / "panwright-transport-test";
  std::filesystem::remove_all(folder);
  const WorkCache cache(folder);
  Transport first(kFew, &cache), second(kFew, &cache);
  first.update(corner(), {});
  second.update(corner(), {});
  EXPECT_EQ(first.counts().lists, 1u);
  EXPECT_EQ(second.counts().lists + second.counts().kept, 1u);
  EXPECT_EQ(second.counts().kept, program_identity() ? 1u : 0u);
  EXPECT_TRUE(same(first.light(), second.light()));
  std::filesystem::remove_all(folder);
}

// Slivers, a triangle of no area, a target far smaller than the other, no light at all: finite.
TEST(Transport, HardCasesAreFinite) {
  geometry::Mesh strips;
  for (std::uint32_t i = 0; i < 40; ++i) {
    const double x = 1e-4 * i;
    for (const Vec3& p : {Vec3(x, 0, 0), Vec3(x + 1e-4, 0, 0), Vec3(x, 10, 0)})
      strips.positions.push_back(p);
    strips.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  strips.triangles.push_back({0, 0, 1});
  strips.normals.assign(strips.positions.size(), Vec3(0, 0, 1));
  const geometry::Mesh all[] = {strips, sheet({0, 0, 0}, {1e-3, 0, 0}, {0, 1e-3, 0})};
  world::World world = world_of(all, 1);
  add(world, "grain", contents_of(support::box(Vec3(1e-4)), 0.9), {{0, 0, 1e-4}, {1, 0, 0, 0}});
  for (const double irradiance : {1.0, 0.0}) {
    world.set_sun({.direction = {0, 1, 1}, .irradiance = Vec3(irradiance)});
    Transport transport(kFew);
    transport.update(world, {});
    for (const light::SurfelLight& light : transport.light())
      for (const auto& rgb : light.irradiance)
        for (const float value : rgb) EXPECT_TRUE(std::isfinite(value) && value >= 0);
  }
  world::World empty;
  Transport transport(kFew);
  transport.update(empty, {});
  EXPECT_TRUE(transport.light().empty());
}

}  // namespace
}  // namespace panwright::transport::transport_test
