// Exposures over time of `panwright run` against closed forms: a plate that moves before an
// orthographic camera.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "base/math.h"
#include "tests/support/oracles.h"
#include "tests/support/process.h"

namespace panwright::exposures_test {
namespace {

using support::contents;
using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;

constexpr int kWidth = 64, kHeight = 32;
constexpr double kPixels = 16;    // per metre
constexpr double kSpeed = 16;     // pixels a second, to the right
constexpr double kTime = 1.0301;  // of the frame

// Right edge of the plate in an instant, pixels.
double edge_at(double time) { return kWidth / 2.0 + kPixels * (time - 1 + 0.5); }

class Exposures : public testing::TestWithParam<std::string> {
 protected:
  const TemporaryFolder folder_;
  const std::string box_ =
      folder_.write("box.pxn", "<pangu_model ver=\"1\"><box size=\"1\"/></pangu_model>");
  const std::string way_ = folder_.write("way.csv",
                                         "time[s],box.x[m],box.y[m],box.z[m]\n"
                                         "0,-1,0,0\n2,1,0,0\n");
  const std::string scenario_ = folder_.write(
      "run.toml",
      fmt::format("[targets]\nbox = \"box.pxn\"\n[[source]]\nfile = \"way.csv\"\n[view]\n"
                  "size = [{}, {}]\northo = {}\ncamera = [0, -6, 0]\nsun = [0, -1, 0]\n"
                  "engine = \"{}\"\nsamples = {}\n",
                  kWidth, kHeight, kWidth / kPixels, GetParam(), 16));

  Outcome run(const std::string& output, std::vector<std::string> words) const {
    if (std::ranges::find(words, "--at") == words.end())
      words.insert(words.end(), {"--at", fmt::format("{}", kTime)});
    words.insert(words.begin(), {"run", scenario_, "-o", folder_ / output, "--type", "npy"});
    return panwright(words);
  }

  // Rows of the image of a run, relative to the plate's radiance.
  std::vector<std::vector<double>> rows(const std::string& output,
                                        std::vector<std::string> words) const {
    const Outcome done = run(output, std::move(words));
    EXPECT_EQ(done.code, 0) << done.err;
    const auto image = oracles::read_npy(folder_ / (output + "/000000.npy"));
    std::vector<std::vector<double>> out(kHeight, std::vector<double>(kWidth));
    if (!image) return out;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        out[std::size_t(y)][std::size_t(x)] = image->rgb[std::size_t(3 * (y * kWidth + x))];
    // what is lit all the time
    const double plate = out[kHeight / 2][kWidth / 2];
    for (auto& row : out)
      for (double& value : row) value /= plate;
    return out;
  }
};

#ifdef PANWRIGHT_GL
INSTANTIATE_TEST_SUITE_P(Engines, Exposures, testing::Values("gl", "reference"),
                         [](const auto& one) { return one.param; });
#else
INSTANTIATE_TEST_SUITE_P(Engines, Exposures, testing::Values("reference"),
                         [](const auto& one) { return one.param; });
#endif

// Share of a pixel that a plate covers, in the mean of an exposure: the integral of a ramp.
double ramp(double pixel, double edge, double length) {
  constexpr int kParts = 1000;
  double sum = 0;
  for (int k = 0; k < kParts; ++k) {
    const double x = pixel + (k + 0.5) / kParts;
    sum += std::clamp((edge + 0.5 * length - x) / length, 0.0, 1.0) / kParts;
  }
  return sum;
}

TEST_P(Exposures, EdgesAreRamps) {
  constexpr double kExposure = 0.5;
  const auto image = rows("blur", {"--exposure", "0.5"});
  // 0.004: two ends of a ramp of 8 pixels, from steps of half a pixel; noise of the reference
  for (int x = kWidth / 2; x < kWidth; ++x) {
    double mean = 0;
    for (int y = 12; y < 20; ++y) mean += image[std::size_t(y)][std::size_t(x)] / 8;
    EXPECT_NEAR(mean, ramp(x, edge_at(kTime), kSpeed * kExposure), 0.01) << x;
  }
}

// Transfer function of motion over L pixels: |sinc(L f)|, from an edge at eight places of a pixel.
TEST_P(Exposures, BlurHasTheTransferFunctionOfMotion) {
  constexpr int kPhases = 8;
  constexpr double kBlur = 8;  // pixels
  // samples of OpenGL are in columns, which an edge passes all at once
  std::vector<std::string> words{"--exposure", fmt::format("{}", kBlur / kSpeed), "--samples",
                                 GetParam() == "gl" ? "32" : "16"};
  for (int k = 0; k < kPhases; ++k) {
    words.push_back("--at");
    words.push_back(fmt::format("{}", kTime - k / (kSpeed * kPhases)));
  }
  ASSERT_EQ(run("mtf", words).code, 0);
  // the edge moves left by an eighth from frame to frame: samples of its profile
  std::map<int, double> profile;
  for (int k = 0; k < kPhases; ++k) {
    const auto image = oracles::read_npy(folder_ / fmt::format("mtf/{:06}.npy", k));
    ASSERT_TRUE(image);
    const auto value = [&](int x) {
      double sum = 0;
      for (int y = 12; y < 20; ++y) sum += image->rgb[std::size_t(3 * (y * kWidth + x))] / 8;
      return sum;
    };
    for (int x = kWidth / 2; x < kWidth; ++x)
      profile[x * kPhases + k] = value(x) / value(kWidth / 2);
  }
  std::vector<double> edge;
  for (const auto& [at, value] : profile) edge.push_back(value);
  const auto sinc = [](double x) { return x == 0 ? 1 : std::sin(kPi * x) / (kPi * x); };
  double worst = 0;
  for (int step = 1; step <= 20; ++step) {
    const double f = 0.5 * step / 20;  // cycles per pixel, to Nyquist
    double c = 0, s = 0;
    for (std::size_t i = 1; i < edge.size(); ++i) {
      const double line = edge[i - 1] - edge[i];
      const double phase = 2 * kPi * f * static_cast<double>(i) / kPhases;
      c += line * std::cos(phase), s += line * std::sin(phase);
    }
    // the pixel's own, and that of the differences
    const double own = sinc(f) * sinc(f / kPhases);
    worst = std::max(worst, std::fabs(std::hypot(c, s) / own - std::fabs(sinc(kBlur * f))));
  }
  printf("transfer function of a blur of %g pixels: off by %.4f\n", kBlur, worst);
  EXPECT_LT(worst, 0.01);
}

// Row r exposes r line times after the first one; and the last one first.
TEST_P(Exposures, EdgesLean) {
  for (const char* line_time : {"0.015625", "-0.015625"})
    for (const char* exposure : {"0", "0.125"}) {
      const auto image = rows(std::string("lean") + line_time + exposure,
                              {"--line-time", line_time, "--exposure", exposure, "--samples",
                               GetParam() == "gl" ? "64" : "16"});
      for (int y = 8; y < 24; ++y) {
        double edge = kWidth / 2.0;
        for (int x = kWidth / 2; x < kWidth; ++x) edge += image[std::size_t(y)][std::size_t(x)];
        const double late = line_time[0] == '-' ? kHeight - 1 - y : y;
        // 0.008 measured: of samples 1/64 pixel apart; the reference has noise
        EXPECT_NEAR(edge, edge_at(kTime + late / 64), GetParam() == "gl" ? 0.02 : 0.05)
            << y << " " << line_time << " " << exposure;
      }
    }
}

// A plate of 16 pixels passes the middle of the lens at time 1, by one pixel a line or three
// quarters: a scanner draws 16 rows of it, or 64/3, around the row of that time.
TEST_P(Exposures, LineScannersSeeEverythingInTheMiddleOfTheLens) {
  for (const double line_time : {1.0 / 16, -1.0 / 16, 3.0 / 64})
    for (const char* stages : {"1", "4"}) {
      const double up = line_time > 0 ? 1 : -1;
      folder_.write("way.csv", fmt::format("time[s],box.x[m],box.y[m],box.z[m]\n"
                                           "-4,0,0,{}\n6,0,0,{}\n",
                                           -5 * up, 5 * up));
      const auto image = rows(fmt::format("scan{}{}", line_time, stages),
                              {"--tdi", stages, "--line-time", fmt::format("{}", line_time), "--at",
                               fmt::format("{}", 1 - 16 * std::fabs(line_time))});
      double sum = 0, centre = 0;
      int half_lit = 0;
      for (int y = 0; y < kHeight; ++y) {
        const double value = image[std::size_t(y)][kWidth / 2];
        sum += value;
        centre += value * y;
        half_lit += value > 0.05 && value < 0.95;
        EXPECT_NEAR(value, image[std::size_t(y)][kWidth / 2 + 5], 0.15) << y;
        EXPECT_EQ(image[std::size_t(y)][kWidth / 2 + 9], 0) << y;
      }
      EXPECT_NEAR(sum, 1 / std::fabs(line_time), 0.2) << line_time << " " << stages;
      EXPECT_NEAR(centre / sum, line_time > 0 ? 16 : 15, 0.1) << line_time << " " << stages;
      // stages in step with the image keep it sharp; a quarter of a pixel a line blurs by three
      const bool in_step = std::fabs(line_time) == 1.0 / 16;
      if (*stages == '4') EXPECT_EQ(half_lit > 2, !in_step) << line_time;
    }
  const Outcome bare = run("bare", {"--tdi", "2"});
  EXPECT_THAT(bare.err, HasSubstr("tdi needs line-time"));
}

TEST_P(Exposures, AnInstantIsAsWithout) {
  ASSERT_EQ(run("plain", {}).code, 0);
  ASSERT_EQ(run("zero", {"--exposure", "0", "--line-time", "0"}).code, 0);
  // shorter than a motion of half a pixel
  ASSERT_EQ(run("short", {"--exposure", "0.03"}).code, 0);
  const std::string plain = contents(folder_ / "plain/000000.npy");
  EXPECT_TRUE(plain == contents(folder_ / "zero/000000.npy"));
  EXPECT_TRUE(plain == contents(folder_ / "short/000000.npy"));
  ASSERT_EQ(run("once", {"--exposure", "0.5"}).code, 0);
  ASSERT_EQ(run("again", {"--exposure", "0.5"}).code, 0);
  EXPECT_FALSE(plain == contents(folder_ / "once/000000.npy"));
  EXPECT_TRUE(contents(folder_ / "once/000000.npy") == contents(folder_ / "again/000000.npy"));
}

// A layer of an .npz, with its header.
std::string layer(const std::string& file, const std::string& name) {
  const std::string bytes = contents(file);
  const std::size_t at = bytes.find(name + ".npy");
  return at == bytes.npos ? "" : bytes.substr(at, bytes.find("PK\3\4", at) - at);
}

TEST_P(Exposures, TruthIsThatOfTheMiddle) {
  ASSERT_EQ(run("still", {"--type", "npz"}).code, 0);
  const Outcome done = run("moving", {"--type", "npz", "--exposure", "0.5", "--json"});
  ASSERT_EQ(done.code, 0);
  EXPECT_THAT(done.out, HasSubstr("\"moments\": 17"));
  for (const char* name : {"depth", "normal", "target_id", "node_id"}) {
    const std::string expected = layer(folder_ / "still/000000.npz", name);
    EXPECT_GT(expected.size(), 1000u);
    EXPECT_TRUE(expected == layer(folder_ / "moving/000000.npz", name)) << name;
  }
}

TEST_P(Exposures, NeedABeforeAndAnAfter) {
  const Outcome outside = panwright({"run", scenario_, "-o", folder_ / "outside", "--at", "0.1",
                                     "--at", "0", "--exposure", "0.2"});
  EXPECT_NE(outside.code, 0);
  EXPECT_THAT(outside.err, HasSubstr("the exposure of the frame at 0 s: "));
  EXPECT_THAT(outside.err, HasSubstr("E8003"));
  const std::string views =
      folder_.write("views.json", "[{\"output\": \"a.npy\", \"exposure\": 0.1}]");
  const Outcome view = panwright({"render", box_, "--views", views});
  EXPECT_NE(view.code, 0);
  EXPECT_THAT(view.err, HasSubstr("exposure is '0.1', expected 0"));
  EXPECT_THAT(run("minus", {"--exposure", "-1"}).err, HasSubstr("expected seconds, 0 to 1e6"));
  EXPECT_THAT(run("inf", {"--line-time", "inf"}).err, HasSubstr("--line-time is 'inf'"));
}

// The plate at rest, lit by a distant lamp alone: rows have the share of their exposure that the
// lamp is on, to the bit where that is all.
TEST_P(Exposures, PulsedLampsLightTheirTime) {
  folder_.write("way.csv", "time[s],box.x[m],box.y[m],box.z[m]\n0,0,0,0\n3,0,0,0\n");
  const auto image_of = [&](const std::string& name, const std::string& pulse,
                            std::vector<std::string> words) {
    words.insert(words.end(),
                 {"--sun-irradiance", "0", "--lamp",
                  "point at 0 -1000 0 intensity 1e6" + (pulse.empty() ? "" : " pulse " + pulse)});
    const Outcome done = run(name, words);
    EXPECT_EQ(done.code, 0) << done.err;
    const auto image = oracles::read_npy(folder_ / (name + "/000000.npy"));
    std::vector<double> rows(kHeight);
    if (image)
      for (int y = 0; y < kHeight; ++y)
        rows[std::size_t(y)] = image->rgb[std::size_t(3 * (y * kWidth + 32))];
    return rows;
  };
  const auto always = image_of("always", "", {});
  const double full = always[kHeight / 2];
  ASSERT_GT(full, 0.1);
  // all rows at once: a fifth of the exposure
  EXPECT_NEAR(image_of("part", "-1 -40ms", {"--exposure", "0.1"})[16] / full, 0.1, 1e-5);
  EXPECT_NEAR(image_of("fifth", "10ms 30ms", {"--exposure", "0.1"})[16] / full, 0.2, 1e-5);
  EXPECT_EQ(image_of("now", "-1ms 1ms", {})[16], full);
  // row by row, 10 ms apart
  for (const char* line_time : {"0.01", "-0.01"})
    for (const double exposure : {0.0, 0.04}) {
      const auto rows =
          image_of(fmt::format("rows{}{}", line_time, exposure), "135ms 195ms",
                   {"--line-time", line_time, "--exposure", fmt::format("{}", exposure)});
      for (int y = 8; y < 24; ++y) {
        const double delay = 0.01 * (line_time[0] == '-' ? kHeight - 1 - y : y);
        const double common =
            std::min(delay + exposure / 2, 0.195) - std::max(delay - exposure / 2, 0.135);
        const double want =
            exposure > 0 ? std::max(common, 0.0) / exposure : delay >= 0.135 && delay < 0.195;
        EXPECT_NEAR(rows[std::size_t(y)] / full, want, 1e-5)
            << y << " " << line_time << " " << exposure;
      }
    }
  const Outcome dark = run("dark", {"--lamp", "point at 0 -9 0 intensity 1 pulse 1 2"});
  EXPECT_EQ(dark.code, 0);
  EXPECT_THAT(dark.err, HasSubstr("W5019"));
}

// A plate that moves by 16 pixels in the exposure, frozen by a short pulse.
TEST_P(Exposures, PulsesFreezeWhatMoves) {
  const auto image = rows("frozen", {"--exposure", "1", "--sun-irradiance", "0", "--lamp",
                                     "point at 0 -1000 0 intensity 1e8 pulse 0.2 0.21"});
  double edge = kWidth / 2.0;
  for (int x = kWidth / 2; x < kWidth; ++x) edge += image[16][std::size_t(x)];
  // a moment is half a pixel
  EXPECT_NEAR(edge, edge_at(kTime + 0.205), 0.5);
  int between = 0;
  for (int x = kWidth / 2; x < kWidth; ++x)
    between += image[16][std::size_t(x)] > 0.02 && image[16][std::size_t(x)] < 0.98;
  EXPECT_LE(between, 2);
}

#ifdef PANWRIGHT_GL
// Light is spread, not lost: a target of two pixels over ten.
TEST(ExposuresOfFarTargets, KeepTheirFlux) {
  const TemporaryFolder folder;
  folder.write("box.pxn", "<pangu_model ver=\"1\"><box size=\"1\"/></pangu_model>");
  folder.write("way.csv", "time[s],box.x[m],box.y[m],box.z[m]\n0,-5,0,0\n2,5,0,0\n");
  const std::string scenario = folder.write(
      "run.toml",
      "[targets]\nbox = \"box.pxn\"\n[[source]]\nfile = \"way.csv\"\n[view]\nsize = [40, 24]\n"
      "intrinsics = [4000, 4000, 20, 12]\ncamera = [0, -2000, 300]\nsun = [0.3, -1, 0.4]\n");
  double sums[2];
  int largest[2];
  for (int k = 0; k < 2; ++k) {
    const std::string output = folder / fmt::format("{}", k);
    const Outcome done = panwright({"run", scenario, "-o", output, "--type", "npy", "--at", "1",
                                    "--exposure", k == 0 ? "0" : "1"});
    ASSERT_EQ(done.code, 0) << done.err;
    const auto image = oracles::read_npy(output + "/000000.npy");
    ASSERT_TRUE(image);
    const oracles::ImageSum sum = oracles::pinhole_sum(*image, 4000, {20, 12});
    sums[k] = sum.sum.x;
    // at the same place
    EXPECT_NEAR(sum.centre[0].x, 20, 0.02);
    largest[k] = static_cast<int>(std::ranges::count_if(image->rgb, [](float v) { return v > 0; }));
  }
  EXPECT_GT(largest[1], 3 * largest[0]);
  // 1e-4 measured; 5e-4 is the error of an imposter's flux
  EXPECT_NEAR(sums[1] / sums[0], 1, 5e-4);
}
#endif

}  // namespace
}  // namespace panwright::exposures_test
