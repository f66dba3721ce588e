// Predicted errors of pixels, and the choice of those that need more samples. Private to preview;
// nothing here needs OpenGL.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "image/image.h"
#include "preview/frame/samples.h"

namespace panwright::preview {

// Sums over the pixels of an image that show a target.
struct ImageSums {
  double radiance = 0;  // of all channels
  double squares = 0;   // the mean of the channels
};

ImageSums sums_of(const image::Image& image);

// Takes what shading.frag says beside the coverage of what relief finer than the shadow maps'
// texels may add: returns its share of the flux, and sets the coverage.
//
//   unit  told_irradiance()
double taken_relief(double unit, image::Image& image);

// Share of it that stands for the error.
inline constexpr double kReliefShare = 0.5;

// Predictor of the error of pixels with one sample each. The error of a pixel's mean follows the
// largest second difference of radiance along rows, columns and both diagonals. It detects edges,
// borders of shadows and highlights, and no linear slope. A share of the neighbours' differences is
// added, for thin parts that continue between the samples. The factors are measured
// (docs/accuracy/sampling.md).
class ErrorPredictor {
 public:
  // patternless: of each pixel of the part, its radiance without patterns (solar cells, which are
  //              no error), below 0: as it is; empty: no patterns.
  // errors: of each pixel of the part, radiance, rms over the channels; resized.
  void predict(const image::Image& image, std::span<const float> patternless, const Tile& part,
               std::vector<float>& errors);

  // Raises the errors of predict() by the corners of a pixel: the second differences along its
  // diagonals.
  //
  //   corners  an image whose samples lie half a pixel left of and above those of the first
  void look_at_corners(const image::Image& image, std::span<const float> patternless,
                       const image::Image& corners, std::span<const float> corner_patternless,
                       const Tile& part, std::span<float> errors) const;

 private:
  std::vector<float> values_;       // RGB of the part and a pixel around it
  std::vector<float> means_;        // the same with patternless values; or empty
  std::vector<std::uint8_t> flat_;  // 1: patternless, of each pixel
  std::vector<float> bends_;        // of the same
};

// Returns the smallest error whose lower ones have squares summing to at most `budget`; infinite if
// all do. Off by at most 0.4 %, to the smaller side. errors: ≥ 0.
float least_error_above(std::span<const float> errors, double budget);

// Allocation of further samples to pixels. The error of N×N samples is assumed to fall with N^1.4
// (measured: docs/accuracy/sampling.md) and their cost grows with N². The fewest samples for a sum
// of squares are N proportional to the error to the power of 1 / 2.4, in steps of `sides`. Levels
// for few pixels are skipped, as a draw costs more than it saves.
class Allocation {
 public:
  // errors: of each pixel, with its present samples; levels: into sides, which ascend. Pixels of
  // the last level stay, whatever their error. budget: of the sum of squares.
  Allocation(std::span<const float> errors, std::span<const std::uint8_t> levels,
             std::span<const unsigned> sides, double budget);

  // Returns the level of a pixel, at least its present one.
  std::size_t level(float error, std::size_t level) const {
    return level_above(least_, highest_, error, level);
  }

 private:
  std::size_t level_above(float least, std::size_t highest, float error, std::size_t level) const;

  std::span<const unsigned> sides_;
  float least_ = 0;  // smallest error refined
  std::size_t highest_ = 0;
};

}  // namespace panwright::preview
