// The Sun, the Moon and rotations by date, against DE405, DE430 and DE441, the Earth's rotation as
// measured (binary PCK) and DE421's rotation of the Moon.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "ephemeris/analytic.h"
#include "ephemeris/kernels.h"
#include "tests/ephemeris/corpus.h"

namespace panwright::ephemeris::analytic_corpus_test {
namespace {

namespace fs = std::filesystem;

constexpr double kArcsecond = kDegree / 3600;

using testing_support::folder;
using testing_support::load;

class AnalyticCorpus : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(folder() / "spk")) GTEST_SKIP() << "no kernels are at hand";
  }
};

// Largest angle and share of the distance between a function and a body of kernels.
void compare(const Kernels& kernels, int body, Vec3 (*function)(double), double& angle,
             double& distance, std::size_t& count) {
  std::string problem;
  for (const Interval& span : kernels.coverage(body, 399, kJ2000))
    for (int i = 0; i <= 200; ++i) {
      const double et = span.begin + (span.end - span.begin) * i / 200;
      const auto found = kernels.state(body, 399, kJ2000, et, Aberration::none, problem);
      if (!found) continue;
      const Vec3 ours = function(et);
      angle = std::max(angle, angle_between(found->state.position, ours) / kArcsecond);
      distance = std::max(distance, std::abs(length(ours) / length(found->state.position) - 1));
      ++count;
    }
}

TEST_F(AnalyticCorpus, SunAndMoon) {
  double sun = 0, sun_distance = 0, moon = 0, moon_distance = 0;
  std::size_t count = 0;
  for (const char* file : {"spk/de405s_littleendian.bsp", "spk/de430-2015-03-02.bsp",
                           "spk/de441-1969.bsp", "spk/allspk_littleendian.bsp"}) {
    const auto kernels = load({file});
    ASSERT_TRUE(kernels);
    compare(*kernels, 10, sun_from_earth, sun, sun_distance, count);
    compare(*kernels, 301, moon_from_earth, moon, moon_distance, count);
    std::cout << file << " " << count << ": Sun " << sun << "\", " << sun_distance << "; Moon "
              << moon << "\", " << moon_distance << "\n";
  }
  EXPECT_GT(count, 1000u);
  EXPECT_LE(sun, 30);
  EXPECT_LE(sun_distance, 2e-4);
  EXPECT_LE(moon, 20);
  EXPECT_LE(moon_distance, 1e-4);
}

TEST_F(AnalyticCorpus, Rotations) {
  const auto earth = load({"pck/allbpck.bpc", "text/naif0012.tls"});
  ASSERT_TRUE(earth);
  std::string problem;
  double spin = 0, pole = 0, of_moon = 0;
  std::size_t count = 0;
  for (const Interval& span : earth->attitude_coverage(13000))
    for (int i = 1; i < 100; ++i) {
      const double et = span.begin + (span.end - span.begin) * i / 100;
      const auto found = earth->attitude(13000, et, problem);
      const auto utc = earth->utc_of_et(et, problem);
      if (!found || !utc) continue;
      // UTC seconds past J2000 of a calendar without leap seconds: TT less 32.184 s and 32 s or
      // more
      const double tai_minus_utc = et > 189345665 ? 33 : 32;
      const Mat3 ours = earth_attitude(et, et - 32.184 - tai_minus_utc).from_j2000;
      const Mat3 turn = ours * transpose(found->from_j2000);
      spin = std::max(spin, std::abs(turn[1][0]) / kArcsecond);
      pole = std::max(pole, std::hypot(turn[2][0], turn[2][1]) / kArcsecond);
      ++count;
    }
  const auto moon = load({"pck/moon_pa_de421_1900-2050.bpc", "text/moon_080317.tf"});
  ASSERT_TRUE(moon);
  const auto frame = moon->frame("MOON_ME");
  ASSERT_TRUE(frame);
  for (int i = 0; i < 400; ++i) {
    const double et = -3.1e9 + i * (1.5e9 + 3.1e9) / 400;
    const auto found = moon->attitude(*frame, et, problem);
    ASSERT_TRUE(found) << problem;
    const Mat3 turn = moon_attitude(et).from_j2000 * transpose(found->from_j2000);
    const double angle = std::hypot(turn[1][0], turn[2][0], turn[2][1]);
    of_moon = std::max(of_moon, angle / kDegree);
  }
  std::cout << "Earth: about its axis " << spin << "\", pole " << pole << "\"; Moon " << of_moon
            << " degrees; " << count << "\n";
  EXPECT_GT(count, 100u);
  EXPECT_LE(spin, 14);
  EXPECT_LE(pole, 1);
  EXPECT_LE(of_moon, 0.01);
}

}  // namespace
}  // namespace panwright::ephemeris::analytic_corpus_test
