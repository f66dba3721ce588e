#include "workspace/detecting.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/text.h"
#include "sensor/focus.h"

namespace panwright::workspace {

namespace {

constexpr double kShortest = 1e-6, kLongest = 1000;  // seconds, of automatic exposures

sensor::PixelGrid grid_of(const world::Camera& camera) {
  return {camera.width, camera.height, camera.focal, camera.principal, camera.distortion.get()};
}

bool same_lens(const world::Camera& a, const world::Camera& b) {
  return a.width == b.width && a.height == b.height && a.focal == b.focal &&
         a.principal == b.principal && a.distortion == b.distortion;
}

// The means of steps × steps values, and the middle ones of truth layers.
void reduce(std::uint32_t steps, image::Image& image) {
  if (steps == 1) return;
  const std::size_t width = image.width / steps, height = image.height / steps;
  const auto mean = [&](std::vector<float>& values, std::size_t channels, bool squares) {
    if (values.empty()) return;
    std::vector<float> out(width * height * channels);
    const double count = steps * steps;
    parallel_for(height, [&](std::size_t y) {
      for (std::size_t x = 0; x < width * channels; ++x) {
        double sum = 0;
        for (std::size_t j = 0; j < steps; ++j)
          for (std::size_t i = 0; i < steps; ++i) {
            const double value =
                values[((y * steps + j) * image.width + x / channels * steps + i) * channels +
                       x % channels];
            sum += squares ? value * value : value;
          }
        out[y * width * channels + x] =
            static_cast<float>((squares ? std::sqrt(sum) : sum) / count);
      }
    });
    values = std::move(out);
  };
  const auto middle = [&](auto& values, std::size_t channels) {
    if (values.empty()) return;
    auto out = values;
    out.resize(width * height * channels);
    for (std::size_t y = 0; y < height; ++y)
      for (std::size_t x = 0; x < width; ++x)
        for (std::size_t k = 0; k < channels; ++k)
          out[(y * width + x) * channels + k] =
              values[((y * steps + steps / 2) * image.width + x * steps + steps / 2) * channels +
                     k];
    values = std::move(out);
  };
  mean(image.radiance, 3, false);
  mean(image.coverage, 1, false);
  mean(image.standard_error, 3, true);
  middle(image.depth, 1);
  middle(image.range, 1);
  middle(image.normal, 3);
  middle(image.target_id, 1);
  middle(image.node_id, 1);
  middle(image.material_id, 1);
  image.width = static_cast<std::uint32_t>(width);
  image.height = static_cast<std::uint32_t>(height);
}

// Number of values that no light has; they are dark then.
std::size_t clean(std::span<float> radiance) {
  std::size_t wrong = 0;
  for (float& value : radiance) {
    if (value >= 0 && value <= 1e30f) continue;
    value = 0;
    ++wrong;
  }
  return wrong;
}

// The time at which 99 of 100 lit pixels are below 0.8 of the full well and of the largest number.
double fitted_exposure(const sensor::Detector& of_pixels, std::span<const float> rates,
                       std::uint32_t width) {
  const sensor::Detector detector = sensor::detector_of_blocks(of_pixels);
  constexpr double kShare = 0.99, kBright = 0.8;
  std::vector<float> lit;
  for (std::size_t i = 0; i < rates.size() / 3; ++i) {
    float rate = rates[3 * i] + rates[3 * i + 1] + rates[3 * i + 2];
    if (!detector.is_mono()) {
      const char filter = detector.bayer[(i / width & 1) * 2 + (i % width & 1)];
      rate = rates[3 * i + (filter == 'r' ? 0 : filter == 'g' ? 1 : 2)];
    }
    if (rate > 0) lit.push_back(rate);
  }
  if (lit.empty()) return 0;
  // the halo of a small source is no part of it
  const float largest = *std::ranges::max_element(lit);
  std::erase_if(lit, [&](float rate) { return rate < 1e-3f * largest; });
  const auto at =
      lit.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(lit.size() - 1));
  std::nth_element(lit.begin(), at, lit.end());
  const double most = std::min(
      detector.full_well_e,
      (static_cast<double>((1u << detector.bits) - 1) - detector.bias_dn) / detector.dn_per_e);
  // three digits, so that a later look at the file gives the same
  const double seconds = kBright * most / static_cast<double>(*at);
  const double unit = det::pow(10, std::floor(det::log10(seconds)) - 2);
  return std::floor(seconds / unit) * unit;
}

}  // namespace

bool needs_depth(const Frame& frame) {
  return frame.imager != nullptr && frame.imager->optics.focus_m > 0;
}

void Detecting::prepare(const Frame& frame) {
  const world::Camera& camera = frame.camera();
  if (imager_ != nullptr && *imager_ == *frame.imager && same_lens(camera, camera_)) return;
  imager_ = frame.imager;
  camera_ = camera;
  const sensor::PixelGrid grid = grid_of(camera);
  sensitivity_.emplace(imager_->optics, grid);
  blur_.reset();
}

std::uint32_t Detecting::steps(const Frame& frame) {
  if (frame.imager == nullptr || !frame.imager->optics.has_kernel()) return 1;
  return frame.moments.empty() ? sensor::Blur::kFine : 1;
}

world::Camera Detecting::drawn_camera(const Frame& frame, DrawOptions& options) {
  world::Camera camera = frame.camera();
  if (frame.imager == nullptr) return camera;
  const sensor::Optics& optics = frame.imager->optics;
  double sigma = options.gl.psf_sigma;
  if (!optics.has_kernel()) {
    sigma = std::sqrt(sigma * sigma + optics.gaussian_px() * optics.gaussian_px());
  } else {
    const std::uint32_t fine = steps(frame);
    prepare(frame);
    if (!blur_ || blur_->fine() != fine) {
      const sensor::Detector& detector = frame.imager->detector;
      const Vec2 pitch = detector.pixel_um * static_cast<double>(detector.binning);
      std::array<double, sensor::kBands> airy{};
      for (std::size_t k = 0; k < sensor::kBands; ++k)
        airy[k] = sensor::airy_px(optics, grid_of(camera), pitch, sensor::kBandNm[k]);
      blur_.emplace(optics, airy, fine);
    }
    camera.width *= fine;
    camera.height *= fine;
    camera.focal *= double(fine);
    camera.principal *= double(fine);
    sigma =
        std::sqrt(fine * fine * sigma * sigma + blur_->rendered_sigma() * blur_->rendered_sigma());
  }
  options.gl.psf_sigma = options.reference.psf_sigma = sigma;
  return camera;
}

Detected Detecting::develop(const Frame& frame, bool stages, image::Image& image,
                            DiagnosticLog& log) {
  prepare(frame);
  const sensor::Optics& optics = imager_->optics;
  std::size_t wrong = clean(image.radiance);
  if (optics.has_kernel()) {
    if (!blur_ || blur_->fine() != steps(frame)) {
      DrawOptions ignored;
      (void)drawn_camera(frame, ignored);
    }
    if (needs_depth(frame)) {
      sensor::DepthImage drawn{image.width, image.height, image.radiance, image.depth,
                               blur_->rendered_sigma()};
      sensor::defocus(optics, frame.camera().focal * double(blur_->fine()), drawn);
    }
    blur_->apply(image.radiance, image.width, image.height);
    reduce(blur_->fine(), image);
    // what rings around a source in the last digits
    for (float& value : image.radiance) value = std::max(value, 0.0f);
  }
  sensor::add_glare(optics, grid_of(frame.camera()), image.radiance);
  sensor::Detector detector = imager_->detector;
  const auto& exposure = *frame.settings.exposure;
  if (exposure.number && *exposure.number > 0) {
    detector.exposure_s = *exposure.number;
  } else if (imager_->auto_exposure || !exposure.number) {
    const auto rates = sensor::mean_electrons(image.radiance, *sensitivity_, 1);
    const double fitted = fitted_exposure(detector, rates, image.width);
    const double least = std::max(kShortest, 1.001 * detector.smear_row_s);
    if (fitted > 0) detector.exposure_s = std::clamp(fitted, least, kLongest);
    if (fitted != detector.exposure_s)
      log.report_file(
          Code("W5018"), {},
          fitted > 0 ? fmt::format("an exposure of {:.3g} s fits the image; it is {} s", fitted,
                                   detector.exposure_s)
                     : fmt::format("nothing is lit; the exposure is {} s", detector.exposure_s));
  }
  const auto values = sensor::mean_electrons(image.radiance, *sensitivity_, detector.exposure_s);
  sensor::MeanElectrons means;
  means.width = image.width;
  means.height = image.height;
  means.bands = sensor::kBands;
  means.values = values;
  sensor::Readout out =
      sensor::read_out(detector, means, *frame.settings.noise_seed,
                       static_cast<std::uint32_t>(*frame.settings.frame_number), stages);
  wrong += out.invalid;
  if (wrong > 0)
    log.report_file(Code("W5017"), {},
                    fmt::format("{} of radiance are negative or not finite: dark, or saturated",
                                counted(wrong, "value")));
  image.dn = std::move(out.dn);
  image.dn_bits = detector.stored_bits();
  if (!detector.is_mono()) image.filters.assign(detector.bayer.begin(), detector.bayer.end());
  image.electrons = std::move(out.electrons);
  if (stages) {
    image.stages.emplace_back("signal", std::move(out.signal));
    for (std::size_t k = 0; k < sensor::kDetectorStages; ++k)
      if (!out.added[k].empty())
        image.stages.emplace_back(sensor::kDetectorStageNames[k], std::move(out.added[k]));
  }
  return {detector.exposure_s, out.saturated, image.dn_bits};
}

}  // namespace panwright::workspace
