// The image of the window against that of `panwright render`: the numbers of a detector.
#include "studio/render_thread.h"

#include <gtest/gtest.h>

#include <chrono>
#include <span>
#include <thread>

#include "tests/support/process.h"
#include "workspace/run.h"
#include "workspace/targets.h"

namespace panwright::studio {
namespace {

using support::TemporaryFolder;

constexpr const char* kBall =
    "<pangu_model ver=\"1\"><sphere name=\"ball\" radius=\"1\"/></pangu_model>";
// with noise, fixed patterns and a point spread function that is no Gaussian
constexpr const char* kCamera =
    "size = [60, 40]\nfocal_length_mm = 8\npixel_um = 10\n[optics]\nf_number = 4\ndiffraction = "
    "true\ndefocus_px = 1.2\n[detector]\nexposure_s = 3e-4\nread_noise_e = 8\nbias_dn = 50\n"
    "full_well_e = 20000\nprnu = 0.02\ndark_e_per_s = 1e5\nhot_pixels = 0.01\nhot_e_per_s = 1e7\n";

std::shared_ptr<const RenderResult> exact(RenderThread& thread, const RenderRequest& request) {
  thread.request(request);
  std::shared_ptr<const RenderResult> newest;
  for (int i = 0; i < 24000; ++i) {
    if (auto result = thread.take(); result && result->request == request) newest = result;
    if (newest && (newest->exact || newest->failed)) return newest;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return newest;
}

// The product of `panwright render` with these settings.
workspace::Kept rendered(const world::World& world, const workspace::Settings& settings,
                         DiagnosticLog& log) {
  workspace::Kept out;
  const auto frame = workspace::FrameMaker(world).frame(settings, log);
  workspace::RunOptions options{preview::ContextKind::osmesa, {}, {}};
  options.listener.kept = [&](workspace::Kept& kept) { out = std::move(kept); };
  if (frame) (void)workspace::run_frames(world, std::span(&*frame, 1), options, log);
  return out;
}

TEST(DetectorInTheWindow, HasTheNumbersOfRender) {
  const TemporaryFolder folder;
  const workspace::TargetFile ball = workspace::target_file(folder.write("ball.pxn", kBall));
  DiagnosticLog log;
  auto world = workspace::open_world(std::span(&ball, 1), {}, log);
  ASSERT_TRUE(world) << to_text(log);
  RenderRequest request;
  request.world = std::make_shared<const world::World>(*std::move(world));
  request.view.detector.camera_file = folder.write("camera.toml", kCamera);
  request.view.has_detector = true;
  request.width = 60;
  request.height = 40;
  RenderThread thread(preview::ContextKind::osmesa);
  std::vector<std::uint16_t> first;
  for (const bool changed : {false, true}) {
    if (changed) {
      request.view.detector.exposure = 4e-4;
      request.view.detector.gain = 0.3;
      request.view.detector.temperature = 310;
    }
    const auto result = exact(thread, request);
    ASSERT_TRUE(result && result->exact && !result->failed);
    const workspace::Kept kept =
        rendered(*request.world, settings_of(request.view, request.width, request.height), log);
    ASSERT_FALSE(log.has_errors()) << to_text(log);
    const image::Image& image = std::get<workspace::ImageProduct>(kept.product).image;
    ASSERT_EQ(image.dn.size(), 60u * 40u);
    EXPECT_EQ(result->image.dn, image.dn);
    EXPECT_EQ(result->image.electrons, image.electrons);
    EXPECT_EQ(result->detected.saturated, kept.what.saturated);
    EXPECT_EQ(result->detected.exposure_s, changed ? 4e-4 : 3e-4);
    // grey: as far from black as the number from the largest
    ASSERT_EQ(result->rgba.size(), 4 * image.dn.size());
    for (std::size_t i = 0; i < image.dn.size(); ++i)
      ASSERT_EQ(result->rgba[4 * i], (image.dn[i] * 510u + 4095) / 8190);
    if (changed) EXPECT_NE(first, image.dn);
    first = image.dn;
  }
}

// The gain of an image while it moves: without noise, of any number of pixels.
TEST(DetectorInTheWindow, IsAsBrightWhileItMoves) {
  sensor::Imager imager;
  imager.optics.psf_px = 2;
  imager.optics.defocus_px = 3;
  imager.optics.transmission = {0.8, 0.8, 0.8};
  imager.detector.read_noise_e = 9;
  imager.detector.blooming = true;
  const sensor::Imager quick = interactive_imager(imager, 0.25);
  EXPECT_FALSE(quick.optics.has_kernel());
  EXPECT_EQ(quick.optics.gaussian_px(), 0);
  EXPECT_DOUBLE_EQ(quick.optics.transmission[1], 0.2);
  sensor::MeanElectrons means;
  const std::vector<float> values(100, 4000.0f);
  means.width = means.height = 10;
  means.values = values;
  const auto out = sensor::read_out(quick.detector, means, 1, 1);
  for (const std::uint16_t dn : out.dn) EXPECT_EQ(dn, 4000);
}

}  // namespace
}  // namespace panwright::studio
