// Numbers of detectors in files, from the command line.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/file.h"
#include "image/arrays.h"
#include "image/decode.h"
#include "tests/support/process.h"

namespace panwright::detector_test {
namespace {

using support::contents;
using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;

constexpr const char* kBall = "<pangu_model ver=\"1\"><sphere radius=\"1\"/></pangu_model>";
// f = 64 mm, 10 µm: 6400 pixels, of which the image has 40
constexpr const char* kCamera =
    "size = [40, 30]\nfocal_length_mm = 64\npixel_um = 10\n[optics]\naperture_mm = 16\n";
constexpr const char* kDetector =
    "[detector]\nexposure_s = 2e-5\nread_noise_e = 8\nbias_dn = 50\nfull_well_e = 20000\nprnu = "
    "0.02\n";

std::vector<std::string> render(const TemporaryFolder& folder, const std::string& output,
                                std::vector<std::string> more = {}) {
  std::vector<std::string> words = {
      "render",   folder / "ball.pxn", "-o",        folder / output, "--camera",
      "0 -400 0", "--engine",          "reference", "--sun",         "0 -1 0"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

template <class T>
std::vector<T> layer(const std::string& file, const char* name) {
  DiagnosticLog log;
  const std::string_view names[] = {name};
  const auto arrays = image::read_arrays(file, names, 1 << 24, log);
  if (!arrays || arrays->size() != 1) return {};
  std::vector<T> out((*arrays)[0].data.size() / sizeof(T));
  std::memcpy(out.data(), (*arrays)[0].data.data(), out.size() * sizeof(T));
  return out;
}

// The same numbers in each file, which make the same image again.
TEST(DetectorFiles, HoldTheSameNumbers) {
  const TemporaryFolder folder;
  folder.write("ball.pxn", kBall);
  const std::string camera = folder.write("camera.toml", std::string(kCamera) + kDetector);
  const std::vector<std::string> options = {"--camera-file", camera, "--layers",
                                            "dn electrons stages"};
  for (const char* name : {"a.npz", "a.fits", "a.tif", "a.png"}) {
    const Outcome done = panwright(render(folder, name, options));
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_THAT(done.out, HasSubstr("12 bits, exposure 2e-05 s"));
  }
  const auto dn = layer<std::uint16_t>(folder / "a.npz", "dn");
  ASSERT_EQ(dn.size(), 1200u);
  EXPECT_GT(*std::max_element(dn.begin(), dn.end()), 200);
  const std::string fits = contents(folder / "a.fits"), tiff = contents(folder / "a.tif");
  const auto byte = [](const std::string& text, std::size_t at) {
    return static_cast<unsigned>(static_cast<unsigned char>(text.at(at)));
  };
  const std::size_t end = fits.find("END" + std::string(77, ' '));
  ASSERT_NE(end, fits.npos);
  const std::size_t data = (end + 80 + 2879) / 2880 * 2880;
  ASSERT_EQ(fits.size() % 2880, 0u);
  const std::size_t samples = tiff.size() - 2400;
  for (std::size_t i = 0; i < dn.size(); ++i) {
    const std::size_t row = 29 - i / 40, at = data + 2 * (row * 40 + i % 40);
    ASSERT_EQ((byte(fits, at) << 8 | byte(fits, at + 1)) ^ 0x8000u, dn[i]);
    ASSERT_EQ(byte(tiff, samples + 2 * i) | byte(tiff, samples + 2 * i + 1) << 8, dn[i]);
  }
  for (const char* name : {"a.fits", "a.tif", "a.png", "a.npz"}) {
    const std::string again = folder / (std::string("again") + std::string(name).substr(1));
    const Outcome done = panwright({"render", "--again", folder / name, "-o", again});
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(contents(again), contents(folder / name)) << name;
  }
  // the layers of stages add up to the numbers
  const auto signal = layer<float>(folder / "a.npz", "stage_signal");
  const auto shot = layer<float>(folder / "a.npz", "stage_shot");
  ASSERT_EQ(signal.size(), 1200u);
  ASSERT_EQ(shot.size(), 1200u);
  EXPECT_TRUE(layer<float>(folder / "a.npz", "radiance").empty());
}

// Runs keep whole files of numbers, and make cut ones again.
TEST(DetectorFiles, AreTypesOfRuns) {
  const TemporaryFolder folder;
  folder.write("ball.pxn", kBall);
  folder.write("camera.toml", std::string(kCamera) + kDetector);
  const std::string scenario = folder.write("run.toml", R"(begin = 0
end = 1
step = 1
look_at = "ball"
[targets]
ball = "ball.pxn"
[[source]]
formula = "fixed"
position = [0, -400, 0]
sun = [0, -1, 0]
[view]
camera_file = "camera.toml"
)");
  const auto run = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"run", scenario, "-o", folder / "frames"};
    words.insert(words.end(), more.begin(), more.end());
    return panwright(words);
  };
  const Outcome done = run({"--type", "fits", "--type", "tif"});
  ASSERT_EQ(done.code, 0) << done.err;
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "frames"))
    if (entry.path().extension() == ".fits" || entry.path().extension() == ".tif")
      files.push_back(entry.path());
  ASSERT_EQ(files.size(), 4u);
  const std::string whole = contents(files[0]);
  std::filesystem::resize_file(files[0], whole.size() / 2);
  const Outcome again = run({"--type", "fits", "--type", "tif", "--resume"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("made again"));
  EXPECT_EQ(contents(files[0]), whole);
  const Outcome none = panwright({"run", scenario, "-o", folder / "others", "--type", "jpeg"});
  EXPECT_EQ(none.code, 2);
}

// A contact sheet is for people: numbers of 12 bits are not black in it; the files keep them.
TEST(DetectorFiles, AreSeenInContactSheets) {
  const TemporaryFolder folder;
  folder.write("ball.pxn", kBall);
  folder.write("camera.toml", std::string(kCamera) + kDetector);
  const std::string scenario =
      folder.write("run.toml",
                   "begin = 0\nend = 0\nstep = 1\nlook_at = \"ball\"\n[targets]\nball = "
                   "\"ball.pxn\"\n[[source]]\n"
                   "formula = \"fixed\"\nposition = [0, -400, 0]\nsun = [0, -1, 0]\n[view]\n"
                   "exposure = \"auto\"\ncamera_file = \"camera.toml\"\n");
  const Outcome done =
      panwright({"run", scenario, "-o", folder / "frames", "--sheet", folder / "sheet.png"});
  ASSERT_EQ(done.code, 0) << done.err;
  image::DecodedImage numbers, sheet;
  ASSERT_FALSE(
      image::decode_image(as_bytes(contents(folder / "frames/000000.png")), 1 << 20, numbers).code);
  ASSERT_FALSE(image::decode_image(as_bytes(contents(folder / "sheet.png")), 1 << 20, sheet).code);
  const auto most = [](const image::DecodedImage& image) {
    std::uint8_t out = 0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) out = std::max(out, image.rgba[i]);
    return out;
  };
  EXPECT_LT(most(numbers), 16);  // upper halves of numbers of 12 bits
  EXPECT_GT(most(sheet), 200);   // `auto` exposes to 0.8 of the largest
}

// A white plate facing the Sun: the electrons of the lens equation.
TEST(DetectorFiles, AreInElectronsOfTheSun) {
  const TemporaryFolder folder;
  folder.write("ball.pxn", kBall);
  const std::string camera =
      folder.write("camera.toml",
                   std::string(kCamera) +
                       "[detector]\nexposure_s = 1e-4\nqe = [0.4, 0.5, 0.3]\nfull_well_e = 1e6\n");
  ASSERT_EQ(panwright(render(folder, "d.npz", {"--camera-file", camera})).code, 0);
  ASSERT_EQ(panwright(render(folder, "r.npz",
                             {"--intrinsics", "6400 6400 20 15", "--size", "40x30",
                              "--sun-irradiance", "158.6 186.2 191.4"}))
                .code,
            0);
  const auto radiance = layer<float>(folder / "r.npz", "radiance");
  EXPECT_EQ(layer<float>(folder / "d.npz", "radiance"), radiance);
  double expected = 0, electrons = 0;
  const double nm[] = {650, 550, 450}, qe[] = {0.4, 0.5, 0.3};
  for (std::size_t i = 0; i < radiance.size(); ++i)
    expected += radiance[i] * qe[i % 3] * nm[i % 3] * 1e-9 / 1.98644586e-25;  // h c
  expected *= 1e-4 * 3.14159265 * 0.008 * 0.008 / (6400.0 * 6400);
  for (const float each : layer<float>(folder / "d.npz", "electrons")) electrons += each;
  EXPECT_NEAR(electrons, expected, 5 * std::sqrt(expected) + 1e-5 * expected);
  // at 2 AU a quarter
  ASSERT_EQ(
      panwright(render(folder, "f.npz", {"--camera-file", camera, "--sun-distance", "2"})).code, 0);
  double far = 0;
  for (const float each : layer<float>(folder / "f.npz", "electrons")) far += each;
  EXPECT_NEAR(far / electrons, 0.25, 0.005);
}

TEST(DetectorFiles, HaveTheirExposureAndNoise) {
  const TemporaryFolder folder;
  folder.write("ball.pxn", kBall);
  const std::string camera = folder.write("camera.toml", std::string(kCamera) + kDetector);
  const auto numbers = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--camera-file", camera});
    const Outcome done = panwright(render(folder, "n.npz", more));
    EXPECT_EQ(done.code, 0) << done.err;
    return layer<std::uint16_t>(folder / "n.npz", "dn");
  };
  const auto first = numbers({});
  EXPECT_EQ(numbers({"--threads", "1"}), first);
  EXPECT_NE(numbers({"--noise-seed", "1"}), first);
  EXPECT_NE(numbers({"--frame-number", "1"}), first);
  const auto brightest = [](const auto& dn) { return *std::max_element(dn.begin(), dn.end()); };
  EXPECT_LT(brightest(numbers({"--exposure", "1e-5"})), 0.6 * brightest(first));
  // 80 % of the full well: 50 + 0.8 · 4045
  const auto chosen = numbers({"--exposure", "auto"});
  EXPECT_NEAR(brightest(chosen), 3286, 250);
  EXPECT_EQ(numbers({"--ev", "auto"}), chosen);
  EXPECT_EQ(numbers({"--ev", "auto", "--exposure", "1e-5"}), numbers({"--exposure", "1e-5"}));
}

// Stops of a PNG are not those of a detector, and that is said, once for all views.
TEST(DetectorFiles, SayThatStopsChangeNothing) {
  const TemporaryFolder folder;
  folder.write("ball.pxn", kBall);
  const std::string camera = folder.write("camera.toml", std::string(kCamera) + kDetector);
  const auto errors_of = [&](const char* name, std::vector<std::string> more) {
    more.insert(more.end(), {"--camera-file", camera});
    const Outcome done = panwright(render(folder, name, more));
    EXPECT_EQ(done.code, 0) << done.err;
    return done.err;
  };
  EXPECT_THAT(errors_of("a.npz", {}), testing::Not(HasSubstr("N0205")));
  const std::string brighter = errors_of("b.npz", {"--ev", "2"});
  EXPECT_THAT(brighter, HasSubstr("--ev has no effect on the numbers of a detector"));
  EXPECT_THAT(brighter, HasSubstr("--exposure SECONDS"));
  EXPECT_EQ(layer<std::uint16_t>(folder / "a.npz", "dn"),
            layer<std::uint16_t>(folder / "b.npz", "dn"));
  EXPECT_THAT(errors_of("c.npz", {"--ev", "auto"}), testing::Not(HasSubstr("N0205")));
  const std::string views = folder.write("views.json", R"([{"output": ")" + (folder / "d.png") +
                                                           R"(", "ev": 1}, {"output": ")" +
                                                           (folder / "e.png") + R"(", "ev": 3}])");
  const Outcome both = panwright({"render", folder / "ball.pxn", "--camera", "0 -400 0", "--engine",
                                  "reference", "--camera-file", camera, "--views", views});
  EXPECT_EQ(both.code, 0) << both.err;
  EXPECT_THAT(both.err, HasSubstr("N0205"));
  EXPECT_EQ(both.err.find("N0205"), both.err.rfind("N0205")) << both.err;
}

// A gain and a temperature in place of the file's, which the record of the image has.
TEST(DetectorFiles, HaveAnotherGainAndTemperature) {
  const TemporaryFolder folder;
  folder.write("ball.pxn", kBall);
  const std::string dark = "dark_e_per_s = 1e7\noff = [\"shot\", \"read\", \"prnu\"]\n";
  const std::string camera = folder.write("camera.toml", std::string(kCamera) + kDetector + dark);
  const auto corner = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--camera-file", camera});
    const Outcome done = panwright(render(folder, "n.npz", more));
    EXPECT_EQ(done.code, 0) << done.err;
    const auto numbers = layer<std::uint16_t>(folder / "n.npz", "dn");
    return numbers.empty() ? 0 : numbers[0];
  };
  // 200 electrons of dark current at 293.15 K, 4045 numbers for 20000; at 308.15 K 3.5 times that
  EXPECT_EQ(corner({}), 50 + 40);
  EXPECT_EQ(corner({"--gain", "0.7"}), 50 + 140);
  const double warm = 50 + 0.7 * 200 * 3.1;
  EXPECT_NEAR(corner({"--gain", "0.7", "--temperature", "308.15"}), warm, 0.15 * warm);
  const Outcome again = panwright({"render", "--again", folder / "n.npz", "-o", folder / "a.npz"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(contents(folder / "a.npz"), contents(folder / "n.npz"));
  const Outcome none = panwright(render(folder, "a.png", {"--gain", "0.7"}));
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(none.err, HasSubstr("--gain needs a detector"));
  EXPECT_THAT(
      panwright(render(folder, "a.png", {"--camera-file", camera, "--temperature", "400"})).err,
      HasSubstr("--temperature is '400'"));
}

// Blocks of 2 × 2 pixels collect what the pixels do, on an image of half the sides.
TEST(DetectorFiles, AreBinned) {
  const TemporaryFolder folder;
  folder.write("ball.pxn", kBall);
  const std::string detector = "[detector]\nexposure_s = 1e-4\nfull_well_e = 1e6\n";
  const std::string optics = "psf_px = 0.8\n";
  const auto drawn = [&](const std::string& name, const std::string& binning) {
    const std::string camera =
        folder.write(name + ".toml", "binning = " + binning + "\n" + kCamera + optics + detector);
    const Outcome done = panwright(render(folder, name + ".npz", {"--camera-file", camera}));
    EXPECT_EQ(done.code, 0) << done.err;
    return layer<float>(folder / (name + ".npz"), "electrons");
  };
  const auto fine = drawn("fine", "[1, 1]"), binned = drawn("binned", "[2, 2]");
  ASSERT_EQ(fine.size(), 1200u);
  ASSERT_EQ(binned.size(), 300u);
  double all = 0, sum = 0, off = 0;
  for (std::size_t i = 0; i < binned.size(); ++i) {
    const std::size_t at = i / 20 * 2 * 40 + i % 20 * 2;
    const double block = double{fine[at]} + fine[at + 1] + fine[at + 40] + fine[at + 41];
    all += block;
    sum += binned[i];
    off += std::fabs(block - binned[i]);
  }
  EXPECT_NEAR(sum / all, 1, 0.005);
  EXPECT_LT(off / all, 0.03);  // noise, samples, and the Gaussian of pixels in place of blocks
  const Outcome report = panwright({"camera", folder / "binned.toml", "--json"});
  ASSERT_EQ(report.code, 0) << report.err;
  const auto json = nlohmann::json::parse(report.out);
  EXPECT_NEAR(json["full_well_e"].get<double>(), 4e6, 1);
  EXPECT_NEAR(json["focal_length_mm"].get<double>(), 64, 1e-9);
}

// Optics in thirds of pixels keep the light, and the truth of the pixel's centre.
TEST(DetectorFiles, AreBlurredByTheirOptics) {
  const TemporaryFolder folder;
  folder.write("ball.pxn", kBall);
  const std::string sharp =
      folder.write("sharp.toml", std::string(kCamera) +
                                     "[detector]\nexposure_s = 1e-4\noff = [\"shot\"]\n"
                                     "full_well_e = 1e6\n");
  const std::string airy =
      folder.write("airy.toml", std::string(kCamera) +
                                    "diffraction = true\ndefocus_px = 3\n[detector]\n"
                                    "exposure_s = 1e-4\noff = [\"shot\"]\nfull_well_e = 1e6\n");
  ASSERT_EQ(panwright(render(folder, "s.npz", {"--camera-file", sharp})).code, 0);
  ASSERT_EQ(panwright(render(folder, "b.npz", {"--camera-file", airy})).code, 0);
  const auto a = layer<float>(folder / "s.npz", "electrons"),
             b = layer<float>(folder / "b.npz", "electrons");
  double sum_a = 0, sum_b = 0;
  for (const float each : a) sum_a += each;
  for (const float each : b) sum_b += each;
  EXPECT_NEAR(sum_b / sum_a, 1, 0.01);  // with the noise of sampling
  // across the edge
  const std::size_t row = 15 * 40;
  EXPECT_LT(b[row + 20], a[row + 20] * 1.02);
  EXPECT_EQ(layer<std::uint32_t>(folder / "b.npz", "target_id"),
            layer<std::uint32_t>(folder / "s.npz", "target_id"));
}

TEST(DetectorFiles, NeedADetector) {
  const TemporaryFolder folder;
  folder.write("ball.pxn", kBall);
  Outcome done = panwright(render(folder, "a.fits"));
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, HasSubstr("holds numbers of a detector"));
  const std::string plain = folder.write("plain.toml", "size = 40\nfocal = 640\n");
  EXPECT_THAT(panwright(render(folder, "a.tif", {"--camera-file", plain})).err,
              HasSubstr("holds numbers of a detector"));
  done = panwright(render(folder, "a.png", {"--exposure", "0.1"}));
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, HasSubstr("--exposure is '0.1'"));
}

TEST(CameraCommand, SaysWhatAFileMakes) {
  const TemporaryFolder folder;
  const std::string camera = folder.write(
      "camera.toml", std::string(kCamera) + "diffraction = true\npsf_px = 0.3\n" + kDetector);
  const Outcome done = panwright({"camera", camera, "--json", "--svg", folder / "plots"});
  ASSERT_EQ(done.code, 0) << done.err;
  const auto json = nlohmann::json::parse(done.out);
  EXPECT_NEAR(json["range_of_1m"].get<double>(), 6400, 1e-6);
  EXPECT_NEAR(json["field_of_view_deg"][0].get<double>(), 2 * std::atan(20 / 6400.0) * 57.29578,
              1e-6);
  EXPECT_NEAR(json["f_number"].get<double>(), 4, 1e-9);
  EXPECT_NEAR(json["airy_px"].get<double>(), 0.55 * 4 / 10, 1e-9);
  EXPECT_NEAR(json["mtf_nyquist"]["pixel"].get<double>(), 0.6366, 1e-4);
  EXPECT_NEAR(json["noise"][4]["shot"].get<double>(), std::sqrt(20000), 0.1);
  EXPECT_NEAR(json["noise"][4]["prnu"].get<double>(), 400, 0.1);
  for (const char* name : {"transfer", "mtf", "energy"})
    EXPECT_THAT(contents(folder / ("plots/camera-" + std::string(name) + ".svg")),
                HasSubstr("</svg>"));
}

// Each format of a lens and back: the same numbers, half a pixel apart inside the files of others.
TEST(CameraCommand, ConvertsLenses) {
  const TemporaryFolder folder;
  const std::string camera = folder.write("a.toml",
                                          "size = [64, 48]\nfocal = [80.5, 80.25]\n"
                                          "principal = [31.5, 23.75]\ndistortion = \"brown\"\n"
                                          "coefficients = [-0.25, 0.125, 0.5, 0.0625]\n");
  const auto converted = [&](const std::string& from, const std::string& to, const char* format) {
    const Outcome done = panwright({"camera", from, "-o", folder / to, "--format", format});
    EXPECT_EQ(done.code, 0) << done.err;
    return contents(folder / to);
  };
  const std::string own = converted(camera, "own.toml", "toml");
  EXPECT_THAT(own, HasSubstr("principal = [31.5, 23.75]"));
  for (const char* format : {"opencv", "ros", "kalibr", "speed"}) {
    const std::string text = converted(camera, format + std::string(".yaml"), format);
    EXPECT_THAT(text, HasSubstr("31.0")) << format;
    // SPEED's has metres: of its own camera's pixels, where they are not known
    std::string expected = own;
    if (format == std::string("speed"))
      expected.insert(expected.find("distortion"), "pixel_um = [5.86, 5.86]\n");
    EXPECT_EQ(converted(folder / (format + std::string(".yaml")), "back.toml", "toml"), expected)
        << format;
  }
  const std::string real = folder.write("real.toml", std::string(kCamera) + kDetector);
  EXPECT_THAT(panwright({"camera", real, "-o", folder / "real.yaml", "--format", "ros"}).err,
              HasSubstr("holds no optics and no detector"));
  EXPECT_THAT(panwright({"camera", real, "-o", folder / "b", "--format", "matlab"}).err,
              HasSubstr("--format is 'matlab'"));
  EXPECT_THAT(panwright({"camera", real, "--format", "ros"}).err, HasSubstr("needs -o"));
  EXPECT_EQ(panwright({"camera", camera, "-o", camera}).code, 2);
}

}  // namespace
}  // namespace panwright::detector_test
