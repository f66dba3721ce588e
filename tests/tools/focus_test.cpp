// Images of cameras with a focus, by both engines, against the closed form of a blurred edge.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "base/math.h"
#include "image/arrays.h"
#include "tests/support/process.h"

namespace panwright::focus_test {
namespace {

using support::Outcome;
using support::panwright;
using support::TemporaryFolder;

constexpr std::size_t kWidth = 96, kHeight = 32;
constexpr double kProduct = 64;  // aperture times focal length: pixels times metres

class FocusedImages : public testing::TestWithParam<std::string> {
 protected:
  const TemporaryFolder folder_;

  FocusedImages() {
    folder_.write("box.pxn", "<pangu_model ver=\"1\"><box size=\"1\"/></pangu_model>");
    folder_.write("ball.pxn", "<pangu_model ver=\"1\"><sphere radius=\"0.02\"/></pangu_model>");
  }

  // Electrons of targets before a camera at the origin that looks along y, band by band added.
  std::vector<double> electrons(const std::string& focus, std::vector<std::string> words) const {
    const std::string camera = folder_.write(
        "camera.toml",
        fmt::format("size = [{}, {}]\nfocal_length_mm = 16\npixel_um = 10\n[optics]\naperture_mm = "
                    "40\n{}[detector]\nexposure_s = 1e-6\noff = [\"shot\", \"read\"]\n"
                    "full_well_e = 1e9\n",
                    kWidth, kHeight, focus));
    const std::string file = folder_ / "image.npz";
    words.insert(words.begin(), "render");
    words.insert(words.end(),
                 {"-o", file, "--camera-file", camera, "--camera", "0 0 0", "--look-at", "0 1 0",
                  "--sun", "0.3 -1 0", "--engine", GetParam(), "--layers", "electrons"});
    if (GetParam() == "reference") words.insert(words.end(), {"--samples", "6", "--bounces", "0"});
    const Outcome done = panwright(words);
    EXPECT_EQ(done.code, 0) << done.err;
    DiagnosticLog log;
    const std::string_view names[] = {"electrons"};
    const auto arrays = image::read_arrays(file, names, 1 << 24, log);
    std::vector<float> values(kWidth * kHeight);
    if (!arrays || (*arrays)[0].data.size() != 4 * values.size()) return {};
    std::memcpy(values.data(), (*arrays)[0].data.data(), 4 * values.size());
    return {values.begin(), values.end()};
  }

  // Mean of the middle rows.
  static std::vector<double> profile(const std::vector<double>& image) {
    std::vector<double> out(kWidth);
    for (std::size_t x = 0; x < kWidth; ++x)
      for (std::size_t y = 12; y < 20; ++y) out[x] += image[y * kWidth + x] / 8;
    return out;
  }
};

#ifdef PANWRIGHT_GL
INSTANTIATE_TEST_SUITE_P(Engines, FocusedImages, testing::Values("gl", "reference"),
                         [](const auto& one) { return one.param; });
#else
INSTANTIATE_TEST_SUITE_P(Engines, FocusedImages, testing::Values("reference"),
                         [](const auto& one) { return one.param; });
#endif

// Light of a half plane that a disc of diameter c around x has, the plane on the left of 0.
double of_disc(double x, double c) {
  const double u = std::clamp(2 * x / c, -1.0, 1.0);
  return 0.5 - (u * std::sqrt(1 - u * u) + std::asin(u)) / kPi;
}

double in_pixel(double left, double c) {
  double sum = 0;
  for (int k = 0; k < 200; ++k) sum += of_disc(left + (k + 0.5) / 200, c) / 200;
  return sum;
}

// The right edge of a plate, on the axis, at distances around the focus.
TEST_P(FocusedImages, EdgesAreAsWideAsTheirDiscs) {
  double worst = 0;
  for (const double distance : {4.0, 6.0, 12.0, 30.0}) {
    const double c = kProduct * std::fabs(1 / distance - 1 / 8.0);
    const auto image = electrons(
        "focus_m = 8\n",
        {folder_ / "box.pxn", "--pose", fmt::format("-0.5 {} 0 1 0 0 0", distance + 0.5)});
    ASSERT_EQ(image.size(), kWidth * kHeight);
    const auto row = profile(image);
    for (std::size_t x = 36; x < 60; ++x)
      worst = std::max(
          worst, std::fabs(row[x] / row[30] - in_pixel(static_cast<double>(x) - kWidth / 2.0, c)));
  }
  printf("edges out of focus: off by %.4f of the plate's light\n", worst);
  EXPECT_LT(worst, 0.02);
}

TEST_P(FocusedImages, LightIsKept) {
  double sums[3];
  int at = 0;
  for (const char* focus : {"", "focus_m = 5\n", "focus_m = 2.5\n"}) {
    const auto image = electrons(focus, {folder_ / "ball.pxn", "--pose", "0 5 0 1 0 0 0"});
    sums[at] = 0;
    for (const double each : image) sums[at] += each;
    ++at;
  }
  EXPECT_NEAR(sums[1] / sums[0], 1, 2e-3);
  EXPECT_NEAR(sums[2] / sums[0], 1, 2e-3);
}

// The limit of the method: a sharp plate before a plate as bright and out of focus, whose light it
// does not hide. The true image is even.
TEST_P(FocusedImages, EdgesBeforeLightAreOffWithinHalfADisc) {
  const double c = kProduct * (1 / 4.0 - 1 / 14.0);  // 11.4 pixels
  const auto row = profile(electrons(
      "focus_m = 4\n", {"near=" + (folder_ / "box.pxn"), "far=" + (folder_ / "box.pxn"), "--pose",
                        "near=-0.5 4.5 0 1 0 0 0", "--pose", "far=0 14.5 0 1 0 0 0"}));
  double most = 0;
  for (std::size_t x = 20; x < 76; ++x) {
    const double off = row[x] / row[20] - 1;
    most = std::max(most, std::fabs(off));
    if (std::fabs(static_cast<double>(x) + 0.5 - kWidth / 2.0) > 0.5 * c + 1.5)
      EXPECT_NEAR(off, 0, 0.03) << x;
  }
  printf("at a sharp edge before light out of focus: off by %.2f of it\n", most);
  EXPECT_LT(most, 0.55);
}

TEST(Focus, IsADistance) {
  const TemporaryFolder folder;
  const std::string camera = folder.write(
      "camera.toml",
      "size = 32\nfocal_length_mm = 16\npixel_um = 10\n[optics]\naperture_mm = 4\nfocus_m = -3\n"
      "[detector]\nexposure_s = 1e-6\n");
  const Outcome done = panwright({"camera", camera});
  EXPECT_NE(done.code, 0);
  EXPECT_THAT(done.err, testing::HasSubstr("focus_m is -3, expected 0 to"));
  const std::string infinite =
      folder.write("infinite.toml",
                   "size = 32\nfocal_length_mm = 16\npixel_um = 10\n[optics]\naperture_mm = "
                   "4\nfocus_m = inf\n[detector]\nexposure_s = 1e-6\n");
  EXPECT_THAT(panwright({"camera", infinite}).err,
              testing::HasSubstr("focus_m is inf, expected a finite number"));
  // D f = 6.4 pixels times metres: 1/z = 1/8 ± 1/6.4
  const std::string good = folder.write(
      "good.toml",
      "size = 32\nfocal_length_mm = 16\npixel_um = 10\n[optics]\naperture_mm = 4\nfocus_m = 8\n"
      "[detector]\nexposure_s = 1e-6\n");
  const Outcome said = panwright({"camera", good});
  EXPECT_THAT(
      said.out,
      testing::HasSubstr("8 m; discs of at most a pixel from 3.556 m to infinity, of 0.8 pixels"));
}

}  // namespace
}  // namespace panwright::focus_test
