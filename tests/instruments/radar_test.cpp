// RADARs against closed forms: cross-sections, spectra, altitudes, noise.
#include "instruments/radar.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numeric>

#include "geometry/tessellate/tessellate.h"
#include "tests/trace/trace_models.h"

namespace panwright::instruments::radar_test {
namespace {

using namespace trace::testing_support;

constexpr double kWave = 0.03;  // metres

// A RADAR without noise or pattern, 200 m from the origin on -z, that looks along +z.
Radar x_band(ScatterLaw law, double level = 1) {
  Radar radar;
  radar.frequency = kLightSpeed / kWave;
  radar.bandwidth = 300e6;
  radar.dwell = 0.1;
  radar.pattern = BeamPattern::uniform;
  radar.beam = Vec2(0.2);
  radar.range = Vec2(190, 210);
  radar.surfaces = {{"*", law, level}};
  radar.noise_figure = 0;
  return radar;
}

const world::Pose kFrom{{0, 0, -200}, Quat(1, 0, 0, 0)};

RadarHistogram measured(const Radar& radar, const world::World& world,
                        const RadarMotion* motion = nullptr, const RadarOptions& options = {},
                        std::size_t threads = 0) {
  DiagnosticLog log;
  auto out = measure(radar, {world, kFrom}, motion, options, log, Job({threads, {}}));
  EXPECT_TRUE(out) << to_text(log);
  EXPECT_EQ(to_text(log), "");
  return *std::move(out);
}

world::World sphere_of(double radius, std::uint32_t rings) {
  DiagnosticLog log;
  const auto mesh = geometry::tessellated(
      geometry::Sphere{radius, geometry::SphereCounts{rings, 2 * rings}}, {}, {}, log);
  world::World world;
  // poles across the line of sight
  add(world, "sphere", single(*mesh), {Vec3(0), Quat(std::sqrt(0.5), std::sqrt(0.5), 0, 0)});
  return world;
}

Quat turned(const Vec3& axis, double angle) {
  return Quat(std::cos(angle / 2), std::sin(angle / 2) * axis);
}

// Geometric optics: pi a². Physical optics adds up to 2 / (2 k a) by the edge of its shadow, which
// the rays blur and which a wave does not have.
TEST(RadarSection, OfASphereIsItsDisc) {
  for (const double radius : {0.1, 0.3, 1.0}) {
    const auto found = measured(x_band(ScatterLaw::metal), sphere_of(radius, 400));
    const double error = found.targets[0].cross_section / (kPi * radius * radius) - 1;
    printf("sphere of %.1f m: error %.1e\n", radius, error);
    EXPECT_LT(std::fabs(error), 0.02) << radius;
    EXPECT_NEAR(found.targets[0].range, 200 - radius, 0.02);
  }
}

// 4 pi A² / lambda² (cos t sinc(k a sin t))².
TEST(RadarSection, OfATurnedPlateIsThatOfPhysicalOptics) {
  const double side = 0.5;
  for (const double degrees : {0.0, 1.0, 2.0, 3.0}) {
    world::World world;
    add(world, "plate", single(plate(side, side)), {Vec3(0), turned({0, 1, 0}, degrees * kDegree)});
    Radar radar = x_band(ScatterLaw::metal);
    radar.bounces = 1;
    // the far field of the closed form: within 2·side²/lambda = 17 m its phase is flat
    DiagnosticLog log;
    radar.range = Vec2(1e5 - 10, 1e5 + 10);
    const auto found =
        measure(radar, {world, {{0, 0, -1e5}, Quat(1, 0, 0, 0)}}, nullptr, {}, log, {});
    ASSERT_TRUE(found) << to_text(log);
    const double t = degrees * kDegree, u = 2 * kPi / kWave * side * std::sin(t);
    const double lobe = u == 0 ? 1 : std::sin(u) / u;
    const double exact =
        4 * kPi * std::pow(side, 4) / (kWave * kWave) * std::pow(std::cos(t) * lobe, 2);
    const double error = found->targets[0].cross_section / exact - 1;
    printf("plate at %.0f deg: %.4f m2, error %.1e\n", degrees, found->targets[0].cross_section,
           error);
    EXPECT_LT(std::fabs(error), 0.02) << degrees;
  }
}

// Square corner cube of side b: 12 pi b⁴ / lambda² on its axis, by three bounces.
TEST(RadarSection, OfACornerCubeIsThatOfThreeBounces) {
  const double side = 0.3;
  pan::Contents contents = single(plate(side, side));
  contents.nodes.clear();
  contents.instances.clear();
  contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  const double half = side / 2;
  const std::pair<Vec3, Quat> faces[] = {{{half, half, 0}, Quat(1, 0, 0, 0)},
                                         {{half, 0, half}, turned({1, 0, 0}, -kPi / 2)},
                                         {{0, half, half}, turned({0, 1, 0}, kPi / 2)}};
  for (const auto& [place, rotation] : faces) {
    const auto node = static_cast<std::uint32_t>(contents.nodes.size());
    contents.nodes.push_back({"face" + std::to_string(node), 0, place, rotation, Vec3(1)});
    contents.instances.push_back({node, 0, 0, -1});
  }
  // its axis 1 1 1 towards the RADAR at -z
  const Vec3 axis = glm::normalize(Vec3(1, 1, 1));
  const Vec3 about = glm::normalize(glm::cross(axis, Vec3(0, 0, -1)));
  world::World world;
  add(world, "cube", contents, {Vec3(0), turned(about, angle_between(axis, Vec3(0, 0, -1)))});
  DiagnosticLog log;
  Radar radar = x_band(ScatterLaw::metal);
  radar.range = Vec2(1e4 - 10, 1e4 + 10);
  const RadarMoment moment{world, {{0, 0, -1e4}, Quat(1, 0, 0, 0)}};
  const auto found = measure(radar, moment, nullptr, {}, log, {});
  ASSERT_TRUE(found) << to_text(log);
  const double exact = 12 * kPi * std::pow(side, 4) / (kWave * kWave);
  const double error = found->targets[0].cross_section / exact - 1;
  printf("corner cube %.2f m2, closed form %.2f, error %.1e\n", found->targets[0].cross_section,
         exact, error);
  EXPECT_LT(std::fabs(error), 0.02);
  // all three bounces have the path to the corner
  EXPECT_NEAR(found->targets[0].range, 1e4, 0.01);
  radar.bounces = 1;
  const auto single_bounce = measure(radar, moment, nullptr, {}, log, {});
  EXPECT_LT(single_bounce->targets[0].cross_section, 0.05 * exact);
}

// Lambert sphere of albedo r: (8 pi / 3) r a².
TEST(RadarSection, OfALambertSphere) {
  // of 0.1 m: from 200 m it is smaller by 3 a / 2 R, 7.5e-4
  const auto found = measured(x_band(ScatterLaw::lambert, 0.3), sphere_of(0.1, 100));
  const double exact = 8 * kPi / 3 * 0.3 * 0.01;
  const double error = found.targets[0].cross_section / exact - 1;
  printf("Lambert sphere %.5f m2, error %.1e\n", found.targets[0].cross_section, error);
  EXPECT_LT(std::fabs(error), 0.003);
}

// Received power of a point in the middle of the beam: the RADAR equation.
TEST(RadarPower, FollowsTheRadarEquation) {
  Radar radar = x_band(ScatterLaw::metal);
  radar.pattern = BeamPattern::gaussian;
  radar.gain = 1000;
  radar.power = 5;
  radar.loss = 2;
  const auto found = measured(radar, sphere_of(0.1, 200));
  const double section = found.targets[0].cross_section;
  const double exact =
      5 * 1e6 * kWave * kWave * section / (std::pow(4 * kPi, 3) * std::pow(199.9, 4) * 2);
  const double sum = std::accumulate(found.power.begin(), found.power.end(), 0.0);
  const double error = sum / found.response_sum / exact - 1;
  printf("power %.4e W, error %.1e\n", sum / found.response_sum, error);
  EXPECT_LT(std::fabs(error), 0.02);
}

// A Lambert sphere that spins across the line of sight: 1 - (v / v_max)².
TEST(RadarSpeed, SpectrumOfASpinningSphere) {
  const double rate = 2;  // rad/s, radius 1 m: v_max = 2 m/s
  Radar radar = x_band(ScatterLaw::lambert, 0.3);
  radar.speed = Vec2(-3, 3);
  world::World world = sphere_of(1, 100), begin = world, end = world;
  const world::Pose pose = world[0].pose();
  const auto at = [&](double angle) {
    return world::Pose{Vec3(0), turned({0, 1, 0}, angle) * pose.rotation};
  };
  begin.set_pose(0, at(-0.5 * rate * radar.dwell));
  end.set_pose(0, at(0.5 * rate * radar.dwell));
  const RadarMotion motion{{begin, kFrom}, {end, kFrom}};
  const auto found = measured(radar, world, &motion, {.ideal = true});
  std::vector<double> spectrum(found.speeds);
  for (std::size_t i = 0; i < found.power.size(); ++i) spectrum[i / found.ranges] += found.power[i];
  // v_max: the chord over the dwell
  const double fastest = 2 * std::sin(0.5 * rate * radar.dwell) / radar.dwell;
  double sum = 0, expected_sum = 0;
  std::vector<double> expected;
  for (std::size_t i = 0; i < spectrum.size(); ++i) {
    const double v = found.first_speed + found.speed_step * static_cast<double>(i);
    expected.push_back(std::max(0.0, 1 - v * v / (fastest * fastest)));
    sum += spectrum[i];
    expected_sum += expected.back();
  }
  double worst = 0;
  for (std::size_t i = 0; i < spectrum.size(); ++i)
    if (expected[i] > 0.1)
      worst = std::max(worst, std::fabs(spectrum[i] / sum * expected_sum - expected[i]));
  printf("spinning sphere: worst %.1e of the largest\n", worst);
  EXPECT_LT(worst, 0.02);
  EXPECT_NEAR(found.targets[0].speed, 0, 1e-3);
}

// A target that recedes while the RADAR rises: the change of the range between them.
TEST(RadarSpeed, IsTheRateOfTheRange) {
  Radar radar = x_band(ScatterLaw::metal);
  radar.speed = Vec2(-10, 10);
  world::World world = sphere_of(0.1, 60), begin = world, end = world;
  const double half = 0.5 * radar.dwell;
  const world::Pose pose = world[0].pose();
  begin.set_pose(0, {Vec3(0, 0, -3 * half), pose.rotation});
  end.set_pose(0, {Vec3(0, 0, 3 * half), pose.rotation});
  const RadarMotion motion{{begin, {{0, 0, -200 - 1 * half}, Quat(1, 0, 0, 0)}},
                           {end, {{0, 0, -200 + 1 * half}, Quat(1, 0, 0, 0)}}};
  const auto found = measured(radar, world, &motion);
  EXPECT_NEAR(found.targets[0].speed, 2, 1e-4);
  const auto most = std::ranges::max_element(found.power) - found.power.begin();
  EXPECT_NEAR(found.first_speed + found.speed_step * static_cast<double>(most / found.ranges), 2,
              found.speed_step);
  EXPECT_NEAR(found.first_range + found.range_step * static_cast<double>(most % found.ranges),
              199.9, found.range_step);
}

// A wide beam over a plane, pulse-limited: the altitude, and s0 · 2 pi R dR of each cell.
TEST(RadarAltimeter, OverAPlane) {
  Radar radar = x_band(ScatterLaw::cosine, 0.1);
  radar.surfaces[0].exponent = 0;
  radar.bandwidth = 150e6;  // cells of 1 m
  radar.beam = Vec2(1.0);
  radar.range = Vec2(180, 220);
  radar.altimeter = 0.5;
  radar.rays = 1024;
  world::World world;
  add(world, "ground", single(plate(1000, 1000)), {Vec3(0), turned({1, 0, 0}, kPi)});
  const auto found = measured(radar, world, nullptr, {.ideal = true});
  ASSERT_TRUE(found.altitude);
  printf("altitude %.3f m\n", *found.altitude);
  EXPECT_LT(std::fabs(*found.altitude / 200 - 1), 0.0025);  // half a metre
  // Pr = P G² lambda² s0 2 pi R dR / ((4 pi)³ R⁴) of the response's width in range
  const double width = std::sqrt(kPi / (4 * std::numbers::ln2)) * 2 * found.range_step;
  double worst = 0;
  for (std::uint32_t i = 0; i < found.ranges; ++i) {
    const double range = found.first_range + found.range_step * i;
    if (range < 203 || range > 218) continue;
    double sum = 0;
    for (std::uint32_t j = 0; j < found.speeds; ++j) sum += found.power[j * found.ranges + i];
    sum /= std::sqrt(found.response_sum);
    const double exact = found.gain * found.gain * kWave * kWave * 0.1 * 2 * kPi * range * width /
                         (std::pow(4 * kPi, 3) * std::pow(range, 4));
    worst = std::max(worst, std::fabs(sum / exact - 1));
  }
  printf("echo of the plane: worst cell %.1e\n", worst);
  EXPECT_LT(worst, 0.02);
}

// A mirror reflects the antenna: P G² lambda² / ((4 pi)² (2 h)²).
TEST(RadarPower, OfAMirrorIsThatOfItsImage) {
  Radar radar = x_band(ScatterLaw::metal);
  radar.frequency = kLightSpeed / 2;
  radar.pattern = BeamPattern::gaussian;
  radar.beam = Vec2(0.5);
  radar.bounces = 1;
  radar.bandwidth = 5e6;
  radar.range = Vec2(-2.5, 400);  // so that 200 m and 0 m/s are centres of cells
  radar.speed = Vec2(-2.5, 2.5);
  world::World world;
  add(world, "mirror", single(plate(1000, 1000)));
  const auto found = measured(radar, world);
  double most = 0;
  for (const double power : found.power) most = std::max(most, power);
  const double exact = found.gain * found.gain * 4 / (16 * kPi * kPi * 400 * 400);
  printf("mirror: largest cell over the image's %.4f\n", most / exact);
  EXPECT_NEAR(most / exact, 1, 0.02);
}

TEST(RadarNoise, IsThatOfTheReceiverAndOfSpeckle) {
  Radar radar = x_band(ScatterLaw::lambert, 0.3);
  radar.noise_figure = 2;
  radar.looks = 4;
  radar.speed = Vec2(-50, 50);
  const auto found = measured(radar, sphere_of(1, 40), nullptr, {.seed = 7, .frame = 3});
  EXPECT_NEAR(found.noise, 1.380649e-23 * 290 * 2 / radar.dwell, 1e-30);
  double sum = 0, squares = 0, cells = 0;
  for (std::size_t i = 0; i < found.power.size(); ++i) {
    const double ratio = found.power[i] / (found.mean_power[i] + found.noise);
    sum += ratio;
    squares += ratio * ratio;
    ++cells;
  }
  const double mean = sum / cells, variance = squares / cells - mean * mean;
  printf("%.0f cells: mean %.4f, variance %.4f\n", cells, mean, variance);
  EXPECT_NEAR(mean, 1, 5 * 0.5 / std::sqrt(cells));
  EXPECT_NEAR(variance, 0.25, 0.02);  // of four looks
  const auto other = measured(radar, sphere_of(1, 40), nullptr, {.seed = 7, .frame = 4});
  EXPECT_NE(found.power, other.power);
}

TEST(RadarThreads, GiveTheSameBytes) {
  Radar radar = x_band(ScatterLaw::metal);
  radar.noise_figure = 1;
  const world::World world = sphere_of(0.3, 40);
  const auto one = measured(radar, world, nullptr, {}, 1);
  const auto many = measured(radar, world, nullptr, {}, 2);
  EXPECT_EQ(one.power, many.power);
  EXPECT_EQ(one.targets[0].cross_section, many.targets[0].cross_section);
  EXPECT_EQ(measured(radar, world, nullptr, {.ideal = true}).power, one.mean_power);
}

TEST(RadarScene, BehindOrEmptyHasNoEcho) {
  const Radar radar = x_band(ScatterLaw::metal);
  EXPECT_EQ(measured(radar, world::World{}).hits, 0u);
  world::World world = sphere_of(0.3, 10);
  world.set_pose(0, {{0, 0, -400}, Quat(1, 0, 0, 0)});
  const auto behind = measured(radar, world);
  EXPECT_EQ(behind.hits, 0u);
  EXPECT_TRUE(std::isnan(behind.targets[0].range));
}

TEST(RadarScene, MaterialsWithoutASurfaceAreSaid) {
  Radar radar = x_band(ScatterLaw::metal);
  radar.surfaces.clear();
  DiagnosticLog log;
  EXPECT_TRUE(measure(radar, {sphere_of(0.3, 10), kFrom}, nullptr, {}, log));
  EXPECT_NE(to_text(log).find("W0264"), std::string::npos) << to_text(log);
}

// 2 ∫ s0 sin t dt of Hagfors' law: 1.023, 1.011, 1.004 of the reflectance at C = 30, 70, 200.
TEST(RadarSurfaces, HagforsKeepsItsReflectance) {
  for (const auto& [c, expected] : {std::pair{30.0, 1.023}, {70.0, 1.011}, {200.0, 1.004}}) {
    const RadarSurface surface{"*", ScatterLaw::hagfors, 0.06, 0, 1 / std::sqrt(c)};
    double sum = 0;
    const int steps = 100000;
    for (int i = 0; i < steps; ++i) {
      const double t = (i + 0.5) * kPi / 2 / steps;
      sum += 2 * sigma_nought(surface, std::cos(t)) * std::sin(t) * kPi / 2 / steps;
    }
    EXPECT_NEAR(sum / 0.06, expected, 6e-4) << c;
  }
}

}  // namespace
}  // namespace panwright::instruments::radar_test
