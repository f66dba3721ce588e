#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "preview/reference/internal/batches.h"
#include "preview/reference/internal/pixel_errors.h"

namespace panwright::preview::reference {
namespace {

// sigmas; what lies beyond, 6e-7 of the light an axis, is put into what lies within
constexpr double kBlurReach = 5;

// The share of a Gaussian of sigma 1 below x: cubic between tabulated values and slopes, within
// 1e-10 of the integral.
class GaussianShare {
 public:
  GaussianShare() {
    // Simpson's rule between neighbours
    double sum = 0;
    for (int i = 0; i <= kSteps; ++i) {
      value_[static_cast<std::size_t>(i)] = sum;
      const double x = place(i);
      sum += kStep / 6 * (density(x) + 4 * density(x + kStep / 2) + density(x + kStep));
    }
    const double all = value_[kSteps];
    for (int i = 0; i <= kSteps; ++i) {
      value_[static_cast<std::size_t>(i)] /= all;
      slope_[static_cast<std::size_t>(i)] = density(place(i)) / all * kStep;
    }
  }

  double operator()(double x) const {
    const double at = (x + kBlurReach) / kStep;
    if (!(at > 0)) return 0;
    if (!(at < kSteps)) return 1;
    const auto i = static_cast<std::size_t>(at);
    const double t = at - static_cast<double>(i);
    const double rise = value_[i + 1] - value_[i];
    return value_[i] + t * (slope_[i] + t * (3 * rise - 2 * slope_[i] - slope_[i + 1] +
                                             t * (slope_[i] + slope_[i + 1] - 2 * rise)));
  }

 private:
  static constexpr int kSteps = 640;
  static constexpr double kStep = 2 * kBlurReach / kSteps;
  static double place(int i) { return i * kStep - kBlurReach; }
  static double density(double x) { return det::exp(-0.5 * x * x); }

  std::array<double, kSteps + 1> value_;
  std::array<double, kSteps + 1> slope_;
};

// Part of the blurred image.
struct Patch {
  std::int64_t left = 0, top = 0, width = 0, height = 0;  // pixels of the wanted image
  std::vector<Light> light;                               // width*height
  RayCounts counts;
};

class BlurredBatches final : public Batches {
 public:
  BlurredBatches(const ViewSamples& view, std::span<const Cell> cells, double sigma,
                 std::uint32_t margin, std::function<double(std::uint32_t, std::uint32_t)> weight)
      : view_(view), cells_(cells), sigma_(sigma), margin_(margin) {
    whole_ = patch_of(0, cells.size());
    statistics_ = RunningStatistics(whole_.light.size());
    for (std::int64_t y = 0; y < whole_.height; ++y)
      for (std::int64_t x = 0; x < whole_.width; ++x)
        weights_.push_back(weight(static_cast<std::uint32_t>(whole_.left + x),
                                  static_cast<std::uint32_t>(whole_.top + y)));
    units_ = units_of(cells.size(), view.batch_samples());
  }

  void add(std::uint32_t batches) override {
    for (std::uint32_t r = 0; r < batches; ++r) add_one();
  }

  void write(ReferenceImage& result) const override {
    std::vector<Cell> pixels;
    for (std::int64_t y = 0; y < whole_.height; ++y)
      for (std::int64_t x = 0; x < whole_.width; ++x)
        pixels.push_back({static_cast<std::uint32_t>(whole_.left + x),
                          static_cast<std::uint32_t>(whole_.top + y), Vec2(0), Vec2(1)});
    const std::vector<Vec3> errors =
        pixel_errors(pixels, statistics_, batches_, view_.batch_samples(), job);
    for (std::int64_t y = 0; y < whole_.height; ++y)
      for (std::int64_t x = 0; x < whole_.width; ++x) {
        const auto i = static_cast<std::size_t>(y * whole_.width + x);
        const std::size_t pixel = static_cast<std::size_t>(whole_.top + y) * result.image.width +
                                  static_cast<std::size_t>(whole_.left + x);
        for (std::size_t k = 0; k < 3; ++k) {
          result.image.radiance[3 * pixel + k] =
              static_cast<float>(statistics_.mean(i)[static_cast<int>(k)]);
          result.standard_error[3 * pixel + k] = static_cast<float>(errors[i][static_cast<int>(k)]);
        }
        result.image.coverage[pixel] =
            static_cast<float>(std::clamp(statistics_.mean(i).w, 0.0, 1.0));
      }
  }

 private:
  // an empty patch for what some cells spread over
  Patch patch_of(std::size_t begin, std::size_t end) const {
    const std::int64_t margin = margin_;
    const std::int64_t image_width = view_.camera.width - 2 * margin;
    const std::int64_t image_height = view_.camera.height - 2 * margin;
    std::int64_t left = image_width, right = 0, top = image_height, bottom = 0;
    for (std::size_t i = begin; i < end; ++i) {
      // the cell's own pixel lies `margin` further left in the wanted image
      const std::int64_t x = std::int64_t{cells_[i].column} - margin;
      const std::int64_t y = std::int64_t{cells_[i].row} - margin;
      left = std::min(left, std::max<std::int64_t>(0, x - margin));
      right = std::max(right, std::min(image_width, x + margin + 1));
      top = std::min(top, std::max<std::int64_t>(0, y - margin));
      bottom = std::max(bottom, std::min(image_height, y + margin + 1));
    }
    Patch patch{
        left, top, std::max<std::int64_t>(0, right - left), std::max<std::int64_t>(0, bottom - top),
        {},   {}};
    patch.light.resize(static_cast<std::size_t>(patch.width * patch.height));
    return patch;
  }

  void spread(const Sample& sample, double share, Patch& patch,
              std::vector<double>& columns) const {
    const Vec2 at = sample.place - static_cast<double>(margin_);
    const auto x = static_cast<std::int64_t>(std::floor(at.x));
    const auto y = static_cast<std::int64_t>(std::floor(at.y));
    const std::int64_t margin = margin_;
    const auto part = [&](std::int64_t pixel, double centre) {
      const auto edge = static_cast<double>(pixel);
      return share_((edge + 1 - centre) / sigma_) - share_((edge - centre) / sigma_);
    };
    const std::int64_t x0 = std::max(patch.left, x - margin);
    const std::int64_t x1 = std::min(patch.left + patch.width, x + margin + 1);
    columns.clear();
    for (std::int64_t i = x0; i < x1; ++i) columns.push_back(share * part(i, at.x));
    for (std::int64_t j = std::max(patch.top, y - margin);
         j < std::min(patch.top + patch.height, y + margin + 1); ++j) {
      const double row = part(j, at.y);
      Light* to = &patch.light[static_cast<std::size_t>((j - patch.top) * patch.width)];
      for (std::int64_t i = x0; i < x1; ++i)
        to[i - patch.left] += sample.light * (row * columns[static_cast<std::size_t>(i - x0)]);
    }
  }

  Patch traced_unit(const Unit& unit) const {
    Patch patch = patch_of(unit.begin, unit.end);
    std::vector<double> columns;
    for (std::size_t c = unit.begin; c < unit.end; ++c) {
      const Vec2 size = cells_[c].high - cells_[c].low;
      const double share = size.x * size.y / view_.batch_samples();
      const CellSampler sampler(view_, cells_[c], batches_);
      for (std::uint32_t k = 0; k < unit.count; ++k) {
        const Sample sample = sampler(unit.first + k, patch.counts);
        if (sample.light.w > 0) spread(sample, share, patch, columns);
      }
    }
    return patch;
  }

  void merge(const Patch& patch) {
    for (std::int64_t y = 0; y < patch.height; ++y)
      for (std::int64_t x = 0; x < patch.width; ++x)
        whole_.light[static_cast<std::size_t>((patch.top + y - whole_.top) * whole_.width +
                                              patch.left + x - whole_.left)] +=
            patch.light[static_cast<std::size_t>(y * patch.width + x)];
    counts_.camera += patch.counts.camera;
    counts_.shadow += patch.counts.shadow;
    counts_.bounce += patch.counts.bounce;
  }

  void add_one() {
    std::fill(whole_.light.begin(), whole_.light.end(), Light(0));
    // a few at a time, for patches overlap and take more memory than the image
    constexpr std::size_t kWave = 256;
    for (std::size_t first = 0; first < units_.size(); first += kWave) {
      std::vector<Patch> patches(std::min(kWave, units_.size() - first));
      parallel_for(
          patches.size(), [&](std::size_t i) { patches[i] = traced_unit(units_[first + i]); }, job);
      for (const Patch& patch : patches) merge(patch);
    }
    ++batches_;
    Light total(0);
    for (std::size_t i = 0; i < whole_.light.size(); ++i) {
      statistics_.add(i, whole_.light[i], batches_);
      total += whole_.light[i] * weights_[i];
    }
    total_.add(0, total, batches_);
  }

  const ViewSamples& view_;
  std::span<const Cell> cells_;
  double sigma_;
  std::uint32_t margin_;
  GaussianShare share_;
  std::vector<Unit> units_;
  std::vector<double> weights_;
  Patch whole_;
  RunningStatistics statistics_;
};

}  // namespace

std::uint32_t blur_margin(double sigma) {
  return static_cast<std::uint32_t>(std::ceil(kBlurReach * sigma)) + 1;
}

std::unique_ptr<Batches> blurred_batches(
    const ViewSamples& view, std::span<const Cell> cells, double sigma, std::uint32_t margin,
    std::function<double(std::uint32_t, std::uint32_t)> weight) {
  return std::make_unique<BlurredBatches>(view, cells, sigma, margin, std::move(weight));
}

}  // namespace panwright::preview::reference
