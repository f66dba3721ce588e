// The examples as images: each is drawn, and calibration targets show what they are for.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "base/math.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::render_test {
namespace {

const std::string kExamples = PANWRIGHT_SOURCE_DIR "/examples/";

// Radiance per unit irradiance, in 1/sr.
struct DrawnImage {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<float> rgb;
  double at(std::size_t x, std::size_t y) const { return rgb[3 * (y * width + x)]; }
};

// An image of an example; `options` as on the command line.
DrawnImage drawn(const std::string& model, const std::array<std::size_t, 2>& size,
                 std::vector<std::string> options) {
  const support::TemporaryFolder folder;
  const std::string output = folder / "picture.npy";
  options.insert(options.begin(),
                 {PANWRIGHT_BIN_DIR "/panwright", "render", kExamples + model, "-o", output,
                  "--size", std::to_string(size[0]) + "x" + std::to_string(size[1]), "--quiet"});
  const support::Outcome outcome = support::run(options);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  DrawnImage image{size[0], size[1], std::vector<float>(3 * size[0] * size[1])};
  const std::string bytes = support::contents(output);
  const std::size_t wanted = image.rgb.size() * sizeof(float);
  EXPECT_GT(bytes.size(), wanted);
  if (bytes.size() > wanted)
    std::memcpy(image.rgb.data(), bytes.data() + bytes.size() - wanted, wanted);
  return image;
}

TEST(ExampleImages, ShowSomething) {
  const std::vector<std::vector<std::string>> views = {
      {"servicer/servicer.pxn", "9 -9 6"},     {"client/client.pxn", "10 -12 6"},
      {"cubesat/cubesat.pxn", "0.6 -0.6 0.4"}, {"calibration/board.pxn", "0.3 -1.2 0.2"},
      {"calibration/plates.pxn", "0 -1.2 0"},  {"calibration/spheres.pxn", "0 -12 0"}};
  for (const auto& view : views) {
    const DrawnImage image =
        drawn(view[0], {96, 96}, {"--camera", view[1], "--fov", "40", "--sun", "1 -0.7 0.6"});
    std::size_t lit = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) lit += image.rgb[i] > 0;
    EXPECT_GT(lit, 96u * 96 / 40) << view[0];
    EXPECT_LT(lit, 96u * 96 * 3 / 4) << view[0];
  }
}

// Under a Sun at the plates' normal, radiance is the albedo over pi.
TEST(ExampleImages, StepWedgeShowsItsAlbedos) {
  const DrawnImage image = drawn("calibration/plates.pxn", {320, 160},
                                 {"--camera", "0 -2 0", "--ortho", "0.8", "--sun", "0 -1 0"});
  for (int i = 0; i < 10; ++i) {
    const double x = (i % 5 - 2) * 0.12;
    const double z = (0.5 - i / 5) * 0.12;
    const double radiance = image.at(static_cast<std::size_t>(160 + x / 0.8 * 320),
                                     static_cast<std::size_t>(80 - z / 0.8 * 320));
    const double albedo = 0.9 * std::pow(0.7, i);
    // measured: 8.3e-8, single precision
    EXPECT_NEAR(radiance * kPi / albedo, 1, 2e-7) << i;
  }
}

// The flux of a Lambert sphere at phase angle a: 2/3 albedo r^2 (sin a + (pi - a) cos a)/pi for
// unit irradiance (Russell, "On the albedo of the planets and their satellites", 1916).
TEST(ExampleImages, LambertSpheresHaveTheirPhaseCurve) {
  constexpr std::size_t kWidth = 960;
  constexpr std::size_t kHeight = 480;
  constexpr double kAcross = 6;  // metres
  constexpr double kPixel = kAcross / kWidth;
  for (const double phase : {0.0, 40.0, 90.0}) {
    const double a = phase * kPi / 180;
    const std::string sun = std::to_string(std::sin(a)) + " " + std::to_string(-std::cos(a)) + " 0";
    const DrawnImage image = drawn("calibration/spheres.pxn", {kWidth, kHeight},
                                   {"--camera", "0 -12 0", "--ortho", "6", "--sun", sun,
                                    "--samples", "4", "--shadows", "off"});
    for (int i = 0; i < 4; ++i) {
      // a window about the sphere
      const double x = kWidth / 2.0 + (i - 1.5) * 1.2 / kPixel;
      const double y = kHeight / 2.0 - 0.6 / kPixel;
      const double half = 0.6 / kPixel;
      double flux = 0;
      for (auto row = static_cast<std::size_t>(y - half); row < y + half; ++row)
        for (auto column = static_cast<std::size_t>(x - half); column < x + half; ++column)
          flux += image.at(column, row) * kPixel * kPixel;
      const double expected =
          2.0 / 3 * 0.8 * std::pow(0.5, i) * 0.25 * (std::sin(a) + (kPi - a) * std::cos(a)) / kPi;
      // The model's budget is 1e-3. Measured: 1e-6, 1.4e-5 and 6.0e-5 at the three angles, most
      // of it from samples along the terminator.
      EXPECT_NEAR(flux / expected, 1, 1e-4) << phase << " " << i;
    }
  }
}

}  // namespace
}  // namespace panwright::render_test
