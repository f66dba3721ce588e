// Tables [optics] and [detector] of camera files: values, bad values, the way back.
#include "sensor/imager.h"

#include <gtest/gtest.h>

#include <string>

#include "sensor/camera_file.h"

namespace panwright::sensor::imager_test {
namespace {

const std::string kCamera = "size = [64, 48]\nfocal_length_mm = 50\npixel_um = 5\n";

Result<CameraFile> read(const std::string& optics, const std::string& detector,
                        std::string* problems = nullptr) {
  DiagnosticLog log;
  auto camera = read_camera(kCamera + "[optics]\n" + optics + "[detector]\n" + detector, "c", log);
  EXPECT_EQ(camera.ok(), !log.has_errors()) << to_text(log);
  if (problems != nullptr) *problems = to_text(log);
  return camera;
}

TEST(Imager, ReadsItsTables) {
  const auto camera = read(
      "f_number = 5\ntransmission = 0.8\ndiffraction = true\njitter_px = 0.1\n"
      "vignetting = [[0, 1], [3, 0.9]]\nghosts = [[1e-4, -0.8]]\n",
      "exposure_s = 0.02\nqe = [0.4, 0.5, 0.3]\nbayer = \"rggb\"\nfull_well_e = 20000\nbits = 10\n"
      "dark_na_per_cm2 = 1\ntemperature_k = 273\noff = [\"cosmic\", \"smear\"]\nserial = 7\n");
  ASSERT_TRUE(camera && camera->imager);
  const Optics& o = camera->imager->optics;
  const Detector& d = camera->imager->detector;
  EXPECT_NEAR(o.aperture_mm, 10, 1e-12);
  EXPECT_EQ(o.transmission[2], 0.8);
  EXPECT_EQ(o.qe[1], 0.5);
  EXPECT_EQ(o.vignetting.size(), 2u);
  EXPECT_EQ(o.ghosts.at(0).scale, -0.8);
  EXPECT_EQ(d.pixel_um, Vec2(5, 5));
  EXPECT_EQ(d.exposure_s, 0.02);
  EXPECT_EQ(d.bits, 10u);
  EXPECT_NEAR(d.dn_per_e, 1023.0 / 20000, 1e-15);  // the full well at the largest number
  EXPECT_NEAR(d.dark_e_per_s * dark_ratio(293), 1040 * 25 / 30.25, 5);
  EXPECT_FALSE(d.has(DetectorStage::cosmic));
  EXPECT_TRUE(d.has(DetectorStage::shot));
  EXPECT_EQ(d.serial, 7u);
}

TEST(Imager, TextReadsBackToTheSameNumbers) {
  const auto camera = read(
      "aperture_mm = 12.3\nveiling_glare = 0.01\npsf_px = 0.3\ndefocus_px = 1.1\n"
      "kernel = [[0, 0.1, 0], [0.1, 0.5, 0.1], [0, 0.1, 0]]\nkernel_energy = 0.9\n"
      "kernel_oversampling = 3\nvignetting = [[0, 1], [3, 0.9]]\nghosts = [[1e-4, -0.8]]\n",
      "exposure_s = 0.1\nprnu = 0.013\ndark_e_per_s = 33.3\ntelegraph_pixels = 1e-4\n"
      "telegraph_e_per_s = 3\ntelegraph_frames = 4\nblooming = true\nsmear_row_s = 1e-6\n"
      "smear_flush = true\nnonlinearity = [-0.01, 0.002]\nread_noise_e = 9.1\nbias_dn = 32\n"
      "compressed_bits = 8\nbayer = \"gbrg\"\noff = [\"prnu\"]\n");
  ASSERT_TRUE(camera);
  DiagnosticLog log;
  const auto again = parse_imager(imager_text(*camera->imager), log);
  ASSERT_TRUE(again) << to_text(log) << imager_text(*camera->imager);
  EXPECT_EQ(*again, *camera->imager);
  const auto text = camera_text(*camera, CameraFormat::toml, log);
  ASSERT_TRUE(text);
  const auto file = read_camera(*text, "again", log);
  ASSERT_TRUE(file && file->imager) << to_text(log);
  EXPECT_EQ(*file->imager, *camera->imager);
  const auto timed = read("aperture_mm = 5\n", "exposure_s = \"auto\"\n");
  EXPECT_TRUE(parse_imager(imager_text(*timed->imager), log)->auto_exposure);
}

TEST(Imager, RefusesWhatNoDetectorIs) {
  const std::string lens = "aperture_mm = 10\n", time = "exposure_s = 0.01\n";
  const struct {
    std::string optics, detector, says;
  } kWrong[] = {
      {lens, time + "qe = 1.2\n", "qe is 1.2, expected shares from 0 to 1"},
      {lens, time + "qe = [0.5, 0.5]\n", "qe has 2 numbers, expected 1 or 3"},
      {lens, "exposure_s = 0\n", "exposure_s is 0"},
      {lens, "exposure_s = \"long\"\n", "expected seconds or \"auto\""},
      {lens, "", "exposure_s"},
      {lens, time + "full_well_e = 5\nread_noise_e = 6\n", "more than the read noise"},
      {lens, time + "bits = 1\n", "bits is 1, expected 2 to 16"},
      {lens, time + "bits = 12.5\n", "whole number"},
      {lens, time + "temperature_k = 400\n", "temperature_k is 400, expected 100 to 350"},
      {lens, time + "bias_dn = 5000\n", "less than the largest number"},
      {lens, time + "compressed_bits = 14\n", "compressed_bits is 14"},
      {lens, time + "smear_row_s = 0.02\n", "less than the exposure time"},
      {lens, time + "cosmic_per_cm2_s = 1e9\npixel_um = 1000\n", "tracks of particles"},
      {lens, time + "off = [\"cosmics\"]\n", "did you mean 'cosmic'"},
      {lens, time + "off = [\"adc\"]\n", "off has"},
      {lens, time + "bayer = \"rgbg\"\n", "bayer is"},
      {lens, time + "gain = 2\n", "'gain' is no member"},
      {lens, time + "dark_e_per_s = 1\ndark_na_per_cm2 = 1\n", "not both"},
      {"", time, "expected aperture_mm or f_number"},
      {lens + "f_number = 2\n", time, "expected aperture_mm or f_number"},
      {lens + "transmission = -0.1\n", time, "transmission is -0.1"},
      {lens + "kernel = [[0.1, 0.2, 0.1]]\n", time, "kernel"},
      {lens + "kernel = [[0, 0, 0], [0, 0.8, 0], [0, 0, 0]]\n", time,
       "the kernel sums to 0.8, expected its energy 1"},
      {lens + "kernel = [[0, 0, 0], [0, 2, 0], [0, -1, 0]]\n", time, "expected 0 or more"},
      {lens + "vignetting = [[5, 1], [3, 0.9]]\n", time, "vignetting is no list of pairs"},
  };
  for (const auto& wrong : kWrong) {
    std::string problems;
    EXPECT_FALSE(read(wrong.optics, wrong.detector, &problems)) << wrong.says;
    EXPECT_NE(problems.find(wrong.says), problems.npos) << problems;
    EXPECT_NE(problems.find("E0220"), problems.npos) << problems;
  }
  DiagnosticLog log;
  EXPECT_FALSE(
      read_camera("size = 8\nwidth_m = 3\n[detector]\npixel_um = 5\nexposure_s = 1\n", "c", log));
  EXPECT_FALSE(read_camera("size = 8\nfocal = 8\n[optics]\naperture_mm = 5\n", "c", log));
  EXPECT_FALSE(parse_imager("[optics]\n", log));
  EXPECT_FALSE(parse_imager("detector = 3", log));
}

}  // namespace
}  // namespace panwright::sensor::imager_test
