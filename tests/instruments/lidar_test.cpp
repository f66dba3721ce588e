// LiDARs against closed forms: links, ranges, footprints, waveforms, noise, motion.
#include "instruments/lidar.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "geometry/tessellate/tessellate.h"
#include "instruments/internal/receiver.h"
#include "tests/trace/trace_models.h"

namespace panwright::instruments::lidar_test {
namespace {

using trace::testing_support::add;
using trace::testing_support::box;
using trace::testing_support::plate;
using trace::testing_support::Random;
using trace::testing_support::single;

constexpr double kSpeed = 299'792'458, kPlanck = 6.62607015e-34;

pan::Contents of_albedo(const geometry::Mesh& mesh, double albedo) {
  pan::Contents contents = single(mesh);
  contents.materials[0].diffuse = Vec3(albedo);
  return contents;
}

geometry::Mesh sphere(double radius, std::uint32_t count) {
  DiagnosticLog log;
  return *geometry::tessellated(geometry::Sphere{radius, geometry::SphereCounts{count, count}}, {},
                                {}, log);
}

// In front of an instrument at the origin, which looks along z: +z of a plate faces it.
world::Pose at(double range, double tilt = 0) {
  return {Vec3(0, 0, range), glm::angleAxis(kPi + tilt, Vec3(1, 0, 0))};
}

// One pulse along the boresight, again and again, without noise.
Lidar along_boresight(std::uint32_t pulses = 1) {
  Lidar lidar;
  lidar.scan.pattern = ScanPattern::file;
  for (std::uint32_t k = 0; k < pulses; ++k) lidar.scan.table.emplace_back(1e-4 * k, 0, 0);
  lidar.excess_noise = 0;
  lidar.sun = false;
  lidar.quantum_efficiency = 1;
  lidar.threshold_e = 1e-9;
  lidar.method = RangeMethod::peak;
  return lidar;
}

Lidar flash_of(std::uint32_t size, double fov) {
  Lidar lidar = along_boresight();
  lidar.scan = {};
  lidar.scan.columns = lidar.scan.rows = size;
  lidar.scan.fov = fov;
  return lidar;
}

LidarCloud measured(const Lidar& lidar, const world::World& world, const LidarOptions& options = {},
                    const Job& job = {}) {
  DiagnosticLog log;
  auto cloud = measure(lidar, world, {}, options, log, job);
  EXPECT_TRUE(cloud) << to_text(log);
  return cloud ? *std::move(cloud) : LidarCloud{};
}

double total(const LidarCloud& cloud) {
  return std::accumulate(cloud.points.begin(), cloud.points.end(), 0.0,
                         [](double sum, const LidarPoint& p) { return sum + p.intensity; });
}

struct Moments {
  double mean = 0, sd = 0;
};
template <class Get>
Moments moments_of(const std::vector<LidarPoint>& points, const Get& get) {
  Moments out;
  for (const LidarPoint& p : points) out.mean += get(p);
  out.mean /= static_cast<double>(points.size());
  for (const LidarPoint& p : points) out.sd += (get(p) - out.mean) * (get(p) - out.mean);
  out.sd = std::sqrt(out.sd / static_cast<double>(points.size() - 1));
  return out;
}

// 1 mJ on a plate of albedo 0.5 at 1 km that fills the beam, aperture 5 cm, optics 0.7: 1.17e6
// photons (2.19e-13 J).
TEST(LidarLink, IsThatOfALambertPlate) {
  world::World world;
  add(world, "plate", of_albedo(plate(50, 50), 0.5), at(1000));
  Lidar lidar = along_boresight();
  lidar.pulse_energy = 1e-3;
  const LidarCloud cloud = measured(lidar, world);
  ASSERT_EQ(cloud.points.size(), 1u);
  const double joules = cloud.points[0].intensity * kPlanck * kSpeed / 1064e-9;
  EXPECT_NEAR(joules, 1e-3 * 0.5 * 0.05 * 0.05 / 4 / 1e6 * 0.7, 2e-3 * 2.19e-13);
  EXPECT_NEAR(cloud.points[0].intensity, 1.17e6, 0.005e6);
  EXPECT_NEAR(cloud.points[0].reflectance, 0.5, 1e-3);
  EXPECT_NEAR(cloud.points[0].range, 1000, 1e-4);
  EXPECT_EQ(cloud.points[0].ids.target, 1u);
}

// A pulse within the limit of the eye.
TEST(LidarLink, KeepsTheEyeSafeEnergy) {
  world::World world;
  add(world, "plate", of_albedo(plate(50, 50), 0.5), at(100));
  Lidar lidar = along_boresight(2);
  const double full = measured(lidar, world).points[0].intensity;
  lidar.eye_safe_energy = 0.25 * lidar.pulse_energy;
  const LidarCloud cloud = measured(lidar, world);
  EXPECT_NEAR(cloud.points[0].intensity, 0.25 * full, 1e-9 * full);
  EXPECT_EQ(cloud.energy, lidar.eye_safe_energy);
  EXPECT_NEAR(cloud.power, 1e4 * cloud.energy, 1e-9 * cloud.power);
}

// I = (2/3) rho a² E; depth behind the nearest point: mean a/4, spread 0.194 a.
TEST(LidarSphere, HasTheIntensityAndDepthOfLambert) {
  constexpr double kRange = 2000, kAlbedo = 0.4;
  world::World world;
  add(world, "sphere", of_albedo(sphere(1, 400), kAlbedo), {Vec3(0, 0, kRange), {1, 0, 0, 0}});
  Lidar lidar = flash_of(64, 2.2 / kRange);
  lidar.sub_rays = 32;
  lidar.pulse_fwhm = 1e-6;  // longer than the sphere: peaks are sums
  lidar.pulse_energy = 1;
  const LidarCloud cloud = measured(lidar, world);
  const double solid = std::pow(2 * std::tan(0.5 * lidar.scan.fov), 2);
  const double received = total(cloud) * kPlanck * kSpeed / 1064e-9;  // joules
  const double collecting = kPi * 0.05 * 0.05 / 4 * 0.7;
  const double intensity = received * kRange * kRange / collecting;  // J/sr
  const double irradiance = 1 / solid / (kRange * kRange);           // J/m²
  const double ratio = intensity / (2.0 / 3 * kAlbedo * irradiance);
  double depth = 0, spread = 0;
  const double sum = total(cloud);
  for (const LidarPoint& p : cloud.points)
    depth += p.intensity * (p.true_range - (kRange - 1)) / sum;
  for (const LidarPoint& p : cloud.points)
    spread += p.intensity * std::pow(p.true_range - (kRange - 1) - depth, 2) / sum;
  std::printf("intensity %.5f of the closed form, depth %.5f, spread %.5f radii\n", ratio, depth,
              std::sqrt(spread));
  EXPECT_NEAR(ratio, 1, 0.002);           // measured 4e-4
  EXPECT_NEAR(depth, 0.25, 0.25 * 0.01);  // measured 6e-4
  EXPECT_NEAR(std::sqrt(spread), std::sqrt(1.0 / 10 - 1.0 / 16), 0.01 * 0.194);
}

// A plate that fills the beam: R^-2. A wire across it: R^-3. A patch within it: R^-4.
TEST(LidarRange, FallsByThePowerOfWhatTheBeamHolds) {
  const struct {
    double width, height, power;
  } cases[] = {{400, 400, 2}, {400, 0.02, 3}, {0.05, 0.05, 4}};
  for (const auto& each : cases) {
    double sums[2] = {};
    for (const int k : {0, 1}) {
      world::World world;
      add(world, "plate", of_albedo(plate(each.width, each.height), 0.5), at(k == 0 ? 100 : 200));
      Lidar lidar = flash_of(k == 0 ? 32 : 64, 0.01);
      lidar.pulse_energy = 1e-3;
      lidar.sub_rays = 256;
      lidar.pulse_fwhm = 1e-6;
      sums[k] = total(measured(lidar, world));
    }
    const double power = std::log2(sums[0] / sums[1]);
    std::printf("power of the range: %.4f\n", power);
    EXPECT_NEAR(power, each.power, 0.02);  // measured 0.011: of few sub-rays on the patch
  }
}

// On a plane tilted by th a Gaussian beam adds (w/2) tan th to the pulse, in quadrature: peaks are
// lower by as much.
TEST(LidarFootprint, SpreadsOnATiltedPlate) {
  for (const double degrees : {30.0, 60.0, 75.0}) {
    const double tilt = degrees * kDegree, range = 500;
    world::World world;
    add(world, "plate", of_albedo(plate(100, 100), 0.5), at(range, tilt));
    Lidar lidar = along_boresight();
    lidar.divergence = 4e-3;
    lidar.sub_rays = 1024;
    lidar.method = RangeMethod::centroid;
    const LidarCloud cloud = measured(lidar, world);
    ASSERT_EQ(cloud.points.size(), 1u);
    const double sigma = 0.5 * kSpeed * lidar.pulse_fwhm / 2.3548200450309493;
    const double added = 0.5 * (0.5 * lidar.divergence * range) * std::tan(tilt);
    const double expected = 0.5 * std::cos(tilt) * sigma / std::hypot(sigma, added);
    std::printf("%2.0f deg: peak %.4f of the closed form, range %+.4f m\n", degrees,
                cloud.points[0].reflectance / expected, cloud.points[0].range - range);
    EXPECT_NEAR(cloud.points[0].reflectance / expected, 1, 0.01);
    // the near side is brighter, by the square of the range and the cosine
    const double nearer = added * added / range;
    EXPECT_NEAR(cloud.points[0].range, range - 2.3 * nearer, 0.5 * nearer + 1e-4);
  }
}

// Two equal echoes part only beyond two sigmas: 0.637 m for 5 ns. Nearer they give one point, with
// the centroid between.
TEST(LidarWaveform, PartsEchoesBeyondTwoSigmas) {
  Lidar lidar = along_boresight();
  lidar.echoes = EchoChoice::all;
  lidar.sample = 0.1e-9;
  const auto echoes = [&](double apart, double share) {
    const Receiver receiver(lidar, {});
    Receiver::Scratch scratch;
    Excess excess;
    std::vector<Returned> light = {{100, 1e4 * share, 1, {1, 1, 1, 1}, 0},
                                   {100 + apart, 1e4 * (1 - share), 1, {1, 2, 1, 2}, 0}};
    receiver.receive(0, light, 0, scratch, excess);
    return scratch.echoes;
  };
  EXPECT_EQ(echoes(0.62, 0.5).size(), 1u);
  EXPECT_EQ(echoes(0.66, 0.5).size(), 2u);
  lidar.method = RangeMethod::centroid;
  for (const double share : {0.2, 0.5, 0.9}) {
    const auto found = echoes(0.5, share);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].range, 100 + (1 - share) * 0.5, 1e-4);
    EXPECT_NEAR(found[0].true_range, 100 + (1 - share) * 0.5, 1e-9);
    EXPECT_NEAR(found[0].share, std::max(share, 1 - share), 1e-9);
    EXPECT_TRUE((found[0].flags & kMixed) != 0);
  }
  const auto apart = echoes(5, 0.3);
  ASSERT_EQ(apart.size(), 2u);
  EXPECT_EQ(apart[0].ids.node, 1u);
  EXPECT_EQ(apart[1].ids.node, 2u);
  EXPECT_NEAR(apart[1].intensity / apart[0].intensity, 7.0 / 3, 1e-3);
}

// dR = -(c/2) sigma (sqrt(2 ln(A/Th)) - sqrt(2 ln(1.05))), for a pulse of 5 ns.
TEST(LidarWaveform, WalksWithTheAmplitude) {
  const struct {
    double ratio, walk;
  } table[] = {{2, 0.275}, {10, 0.584}, {100, 0.867}, {1e3, 1.084}, {1e4, 1.267}};
  Lidar lidar = along_boresight();
  lidar.method = RangeMethod::threshold;
  lidar.walk_reference = 1.05;
  lidar.threshold_e = 100;
  const double sigma = 0.5 * kSpeed * lidar.pulse_fwhm / 2.3548200450309493;
  const double step = 0.25 * kSpeed * lidar.pulse_fwhm / 2.3548200450309493;
  const double unit = step / (sigma * std::sqrt(2 * kPi));
  for (const auto& [ratio, walk] : table)
    for (const double residual : {1.0, 0.2, 0.0}) {
      lidar.walk_residual = residual;
      const Receiver receiver(lidar, {});
      Receiver::Scratch scratch;
      Excess excess;
      std::vector<Returned> light = {{100.123, ratio * lidar.threshold_e / unit, 1, {}, 0}};
      receiver.receive(0, light, 0, scratch, excess);
      ASSERT_EQ(scratch.echoes.size(), 1u);
      EXPECT_NEAR(100.123 - scratch.echoes[0].range, residual * walk, 0.01 * walk)
          << ratio << " " << residual;
    }
}

// A Gaussian pulse of N electrons in sigmas: detections 1 - exp(-N), bias and spread of the first.
TEST(LidarPhotons, FirstOnesAreEarly) {
  const struct {
    double mean, bias, sd;
  } table[] = {{0.1, -0.028, 1.00}, {1, -0.278, 0.984},   {2, -0.534, 0.940},   {5, -1.082, 0.770},
               {10, -1.504, 0.624}, {100, -2.505, 0.431}, {1000, -3.241, 0.351}};
  Lidar lidar = along_boresight();
  lidar.photon_counting = true;
  lidar.echoes = EchoChoice::first;
  lidar.gate = {50, 150};
  const double sigma = 0.5 * kSpeed * lidar.pulse_fwhm / 2.3548200450309493;
  const Receiver receiver(lidar, {7, 3});
  Receiver::Scratch scratch;
  Excess excess;
  constexpr std::uint32_t kPulses = 40'000;
  std::vector<Returned> light;
  for (const auto& [mean, bias, sd] : table) {
    double sum = 0, squares = 0, found = 0;
    for (std::uint32_t k = 0; k < kPulses; ++k) {
      light = {{100, mean, 1, {}, 0}};
      receiver.receive(k, light, 0, scratch, excess);
      if (scratch.echoes.empty()) continue;
      const double off = (scratch.echoes[0].range - 100) / sigma;
      ++found;
      sum += off;
      squares += off * off;
    }
    const double rate = 1 - std::exp(-mean), n = kPulses;
    EXPECT_NEAR(found / n, rate, 4 * std::sqrt(rate * (1 - rate) / n) + 1e-9);
    EXPECT_NEAR(sum / found, bias, 4 * sd / std::sqrt(found) + 0.001);
    EXPECT_NEAR(std::sqrt(squares / found - sum * sum / found / found), sd,
                4 * sd / std::sqrt(2 * found) + 0.001);
  }
  // background before the target
  const double rate = 1e6, time = 2 * 50 / kSpeed;
  std::uint32_t on_target = 0;
  for (std::uint32_t k = 0; k < kPulses; ++k) {
    light = {{100, 50, 1, {}, 0}};
    receiver.receive(k, light, rate, scratch, excess);
    on_target += !scratch.echoes.empty() && std::fabs(scratch.echoes[0].range - 100) < 5 * sigma;
  }
  const double expected = std::exp(-rate * (time - 2 * 2.5 * sigma / kSpeed));
  EXPECT_NEAR(on_target / double(kPulses), expected, 0.01);
}

// Errors of ranges: of N electrons sigma/sqrt N; jitter, bias, steps; dropped pulses.
TEST(LidarNoise, HasTheStatisticsOfItsParameters) {
  world::World world;
  add(world, "plate", of_albedo(plate(50, 50), 0.5), at(100));
  constexpr std::uint32_t kPulses = 20'000;
  Lidar lidar = along_boresight(kPulses);
  lidar.sub_rays = 1;
  lidar.method = RangeMethod::centroid;
  lidar.excess_noise = 1;
  const double mean_n = measured(along_boresight(), world).points[0].intensity;
  lidar.pulse_energy *= 1e4 / mean_n;
  lidar.threshold_e = 12;
  const double sigma = 0.5 * kSpeed * lidar.pulse_fwhm / 2.3548200450309493;
  const auto range = [](const LidarPoint& p) { return p.range - 100; };
  const Moments shot = moments_of(measured(lidar, world).points, range);
  std::printf("shot noise: mean %+.1e m, sd %.4f of sigma/sqrt N\n", shot.mean,
              shot.sd / (sigma / 100));
  EXPECT_NEAR(shot.sd, sigma / 100, 0.03 * sigma / 100);
  EXPECT_NEAR(shot.mean, 0, 4 * shot.sd / std::sqrt(kPulses) + 1e-4);

  lidar.excess_noise = 0;
  lidar.threshold_e = 1e-3;  // the centroid has no more of one side than of the other
  lidar.jitter = 0.02;
  lidar.bias = 0.5;
  const Moments jitter = moments_of(measured(lidar, world).points, range);
  EXPECT_NEAR(jitter.sd, 0.02, 0.02 * 0.02);
  EXPECT_NEAR(jitter.mean, 0.5, 4 * 0.02 / std::sqrt(kPulses) + 1e-4);
  lidar.resolution = 0.25;
  for (const LidarPoint& p : measured(lidar, world).points)
    ASSERT_NEAR(p.range / 0.25, std::round(p.range / 0.25), 1e-9);
  lidar.drop_outs = 0.3;
  const LidarCloud some = measured(lidar, world);
  const double lost =
      double(std::ranges::count(some.status, PulseStatus::dropped)) / double(kPulses);
  EXPECT_NEAR(lost, 0.3, 4 * std::sqrt(0.3 * 0.7 / kPulses));
}

// Samples of noise above the threshold, in an empty sky: n Q(Th/s) a pulse.
TEST(LidarNoise, RaisesFalseAlarms) {
  constexpr std::uint32_t kPulses = 100'000;
  Lidar lidar = along_boresight(kPulses);
  lidar.electronics_e = 10;
  lidar.threshold_e = 40;
  lidar.gate = {0, 300};
  lidar.echoes = EchoChoice::all;
  lidar.max_echoes = 16;
  world::World world;
  add(world, "behind", single(box({1, 1, 1})), {Vec3(0, 0, -10), Quat(1, 0, 0, 0)});
  const LidarCloud cloud = measured(lidar, world);
  const double step = 0.25 * kSpeed * lidar.pulse_fwhm / 2.3548200450309493;
  const double expected = kPulses * 300 / step * 0.5 * std::erfc(4 / std::sqrt(2.0));
  std::printf("%zu false alarms, %.1f expected\n", cloud.points.size(), expected);
  EXPECT_NEAR(double(cloud.points.size()), expected, 4 * std::sqrt(expected));
  for (const LidarPoint& p : cloud.points) {
    EXPECT_EQ(p.flags, kFalseAlarm);
    EXPECT_TRUE(std::isnan(p.true_range));
    EXPECT_EQ(p.ids.target, 0u);
  }
  for (const double x : {0.0, 0.5, 2.4, 2.6, 4.0, 8.0})
    EXPECT_NEAR(normal_tail(x) / (0.5 * std::erfc(x / std::sqrt(2.0))), 1, 1e-12) << x;
}

// Background of a sunlit plate: E rho cos/pi · filter · field · aperture, in the variance of the
// samples; none in its shadow.
TEST(LidarNoise, HasTheSunInIt) {
  world::World world;
  add(world, "plate", of_albedo(plate(50, 50), 0.5), at(100));
  world::Sun sun;
  sun.direction = glm::normalize(Vec3(0, 1, -2));
  world.set_sun(sun);
  constexpr std::uint32_t kPulses = 20'000;
  Lidar lidar = along_boresight(kPulses);
  lidar.photon_counting = true;
  lidar.echoes = EchoChoice::first;
  lidar.gate = {10, 90};  // before the plate: background alone
  lidar.sun = true;
  lidar.sun_w_m2_nm = 0.6;
  lidar.field = 1e-3;
  lidar.filter_nm = 0.002;
  const double radiance = 0.6 * 0.002 * 0.5 / kPi * (2 / std::sqrt(5.0));
  const double watts = radiance * kPi / 4 * 1e-6 * kPi / 4 * 0.05 * 0.05 * 0.7;
  const double rate = watts * 1064e-9 / (kPlanck * kSpeed);
  const double expected = 1 - std::exp(-rate * 2 * 80 / kSpeed);
  const double found = double(measured(lidar, world).points.size()) / kPulses;
  std::printf("background in %.4f of the pulses, %.4f expected\n", found, expected);
  EXPECT_NEAR(found, expected, 4 * std::sqrt(expected * (1 - expected) / kPulses));
  add(world, "shade", of_albedo(plate(50, 50), 0.5),
      {Vec3(0, 40, 20), glm::angleAxis(kPi, Vec3(1, 0, 0))});
  EXPECT_TRUE(measured(lidar, world).points.empty());
}

// A mirror at 45 degrees shows a plate beside it where its image is; the mirror itself answers
// nothing. A mirror that faces the instrument sends the beam back.
TEST(LidarMirror, ShowsGhosts) {
  materials::Material mirror;
  mirror.weights = Vec3(0, 1, 0);
  mirror.specular = Vec3(0.9);
  mirror.specular_brdf = materials::Mirror{};
  pan::Contents contents = single(plate(4, 4));
  contents.materials[0] = mirror;
  world::World world;
  add(world, "mirror", contents, at(20, kPi / 4));
  Lidar lidar = along_boresight();
  lidar.sub_rays = 1;
  EXPECT_TRUE(measured(lidar, world).points.empty());
  // the mirror turns +z to +y or -y: a plate on either side
  for (const double side : {1.0, -1.0})
    add(world, side > 0 ? "above" : "below", of_albedo(plate(4, 4), 0.5),
        {Vec3(0, 7 * side, 20), glm::angleAxis(side * kPi / 2, Vec3(1, 0, 0))});
  const LidarCloud cloud = measured(lidar, world);
  ASSERT_EQ(cloud.points.size(), 1u);
  EXPECT_NEAR(cloud.points[0].true_range, 27, 1e-5);
  EXPECT_NEAR(cloud.points[0].range, 27, 1e-3);
  EXPECT_EQ(cloud.points[0].flags, kGhost);
  EXPECT_GT(cloud.points[0].ids.target, 1u);
  EXPECT_NEAR(cloud.points[0].reflectance, 0.5 * 0.81, 1e-3);

  world::World facing;
  add(facing, "mirror", contents, at(20));
  const LidarCloud back = measured(lidar, facing);
  ASSERT_EQ(back.points.size(), 1u);
  // all of what the aperture's disc of directions gets: 0.9 of the pulse's light
  const double electrons = 0.9 * 1e-6 * 0.7 * 1064e-9 / (kPlanck * kSpeed);
  EXPECT_NEAR(back.points[0].intensity, electrons, 0.002 * electrons);
}

// Corner cubes: a lobe of 1/(2 pi w²) in place of Lambert's rho/pi.
TEST(LidarRetroreflector, AnswersByItsLobe) {
  pan::Contents contents = single(plate(10, 10));
  contents.materials[0].weights = Vec3(0, 1, 0);
  contents.materials[0].specular = Vec3(1);
  contents.materials[0].specular_brdf = materials::Retroreflector{1, 0, kPi / 2, 1e-3};
  world::World world;
  add(world, "cubes", contents, at(200));
  Lidar lidar = along_boresight();
  const LidarCloud cloud = measured(lidar, world);
  ASSERT_EQ(cloud.points.size(), 1u);
  EXPECT_NEAR(cloud.points[0].reflectance, kPi / (2 * kPi * 1e-6), 0.01 * 0.5e6);
}

// A bright pixel saturates, and its neighbours see some of it at its range.
TEST(LidarFlash, Blooms) {
  world::World world;
  pan::Contents contents = single(plate(0.3, 0.3));
  contents.materials[0].weights = Vec3(0, 1, 0);
  contents.materials[0].specular = Vec3(1);
  contents.materials[0].specular_brdf = materials::Retroreflector{1, 0, kPi / 2, 1e-3};
  add(world, "cube", contents, at(50));
  Lidar lidar = flash_of(32, 0.2);
  lidar.threshold_e = 1;
  lidar.saturation_e = 1000;
  lidar.pulse_energy = 1e-5;
  lidar.resolution = 0.001;
  const std::size_t alone = measured(lidar, world).points.size();
  ASSERT_GT(alone, 0u);
  lidar.bloom_pixels = 2;
  lidar.bloom_share = 0.1;
  const LidarCloud cloud = measured(lidar, world);
  EXPECT_GT(cloud.points.size(), alone);
  std::size_t bloomed = 0, saturated = 0;
  for (const LidarPoint& p : cloud.points) {
    bloomed += (p.flags & kBloomed) != 0;
    saturated += (p.flags & kSaturated) != 0;
    EXPECT_NEAR(p.range, 50, 0.5);
  }
  EXPECT_GT(bloomed, 0u);
  EXPECT_GT(saturated, 0u);
  EXPECT_TRUE(std::ranges::is_sorted(cloud.points, {}, &LidarPoint::pulse));
}

// Instrument and target move from pulse to pulse: with the true poses the cloud is that of the
// target at rest, to 1e-9 m.
TEST(LidarMotion, UndistortsToTheTargetAtRest) {
  world::World world;
  add(world, "box", single(box({4, 3, 2})), {Vec3(0, 0, 30), Quat(1, 0, 0, 0)});
  Lidar lidar = along_boresight();
  lidar.scan = {};
  lidar.scan.pattern = ScanPattern::raster;
  lidar.scan.columns = lidar.scan.rows = 40;
  lidar.scan.azimuth = lidar.scan.elevation = {-0.05, 0.05};
  LidarOptions options;
  options.ideal = true;
  options.frame_of = 0;
  options.motion = [](double time, LidarMoment& moment) {
    const double t = 10 * time;
    moment.pose = {Vec3(t, -t, 2 * t), glm::angleAxis(0.02 * t, glm::normalize(Vec3(1, 2, 3)))};
    moment.world.set_pose(
        0, {Vec3(2 * t, t, 30), glm::angleAxis(3 * t, glm::normalize(Vec3(3, -1, 2)))});
    return true;
  };
  const LidarCloud cloud = measured(lidar, world, options);
  ASSERT_GT(cloud.points.size(), 200u);
  ASSERT_EQ(cloud.poses.size(), cloud.pulses.size());
  double worst = 0;
  for (const LidarPoint& p : cloud.points) {
    const Vec3 off = glm::abs(p.position) - Vec3(2, 1.5, 1);
    worst = std::max(worst, std::fabs(max_component(off)));
  }
  std::printf("%zu points of a turning box, %.1e m from its faces\n", cloud.points.size(), worst);
  EXPECT_LT(worst, 1e-9);
  // in the axes of the instrument they are smeared
  options.frame_of = LidarOptions::kInstrument;
  double smear = 0;
  for (const LidarPoint& p : measured(lidar, world, options).points) {
    const Vec3 off = glm::abs(p.position - Vec3(0, 0, 30)) - Vec3(2, 1.5, 1);
    smear = std::max(smear, std::fabs(max_component(off)));
  }
  EXPECT_GT(smear, 0.1);
}

// Two panels on a joint: only what the scan meets in time.
TEST(LidarMotion, FollowsJoints) {
  pan::Contents contents = single(plate(4, 4));
  contents.nodes[0].name = "root";
  contents.nodes.push_back({"slide", 0, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  contents.instances[0].node = 1;
  world::World world;
  add(world, "plate", contents, at(20));
  const Lidar lidar = [] {
    Lidar out = along_boresight(100);
    out.sub_rays = 1;
    return out;
  }();
  LidarOptions options;
  options.ideal = true;
  options.motion = [](double time, LidarMoment& moment) {
    moment.world.set_node_transform(0, 1,
                                    world::NodeTransform{Vec3(0, 0, 100 * time), {1, 0, 0, 0}});
    return true;
  };
  for (const LidarPoint& p : measured(lidar, world, options).points)
    EXPECT_NEAR(p.range, 20 - 100 * p.time, 1e-9);
}

TEST(LidarCloud, IsTheSameForAnyNumberOfThreads) {
  world::World world;
  add(world, "box", single(box({4, 3, 2})),
      {Vec3(0, 0, 30), glm::normalize(Quat(0.9, 0.1, 0.3, 0.2))});
  Lidar lidar = flash_of(48, 0.3);
  lidar.excess_noise = 2;
  lidar.electronics_e = 3;
  lidar.sun = true;
  lidar.threshold_e = 12;
  lidar.gate = {1, 100};
  lidar.saturation_e = 40;
  lidar.bloom_pixels = 1;
  lidar.bloom_share = 0.01;
  lidar.pulse_energy = 1e-4;
  const LidarCloud many = measured(lidar, world), one = measured(lidar, world, {}, Job({1, {}}));
  ASSERT_EQ(many.points.size(), one.points.size());
  ASSERT_GT(many.points.size(), 100u);
  for (std::size_t i = 0; i < many.points.size(); ++i) {
    ASSERT_EQ(many.points[i].range, one.points[i].range) << i;
    ASSERT_EQ(many.points[i].intensity, one.points[i].intensity) << i;
    ASSERT_EQ(many.points[i].flags, one.points[i].flags) << i;
  }
  LidarOptions other;
  other.frame = 1;
  EXPECT_NE(measured(lidar, world, other).points[0].range, one.points[0].range);
}

}  // namespace
}  // namespace panwright::instruments::lidar_test
