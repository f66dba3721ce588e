// How far pixels may be off, from what they show: which ones need more samples. Private to preview;
// nothing here needs OpenGL.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preview/frame/samples.h"
#include "preview/image.h"

namespace panwright::preview {

// Predicts the error of pixels that have one sample each. A mean over a pixel differs from its
// centre by what bends: the largest second difference of the radiance along the rows, the columns
// and both diagonals, which sees edges, the borders of shadows and highlights alike, and no even
// slope; and a part of what its neighbours bend, where thin things may run on between the samples.
// The factors are measured (docs/accuracy/sampling.md).
class ErrorPredictor {
 public:
  // patternless: of each pixel of the part, what stands for its radiance (solar cells, whose
  // pattern
  //              is no error), below 0: nothing does; empty: nowhere.
  // errors: of each pixel of the part, radiance, rms over the channels; resized.
  void predict(const Image& image, std::span<const float> patternless, const Tile& part,
               std::vector<float>& errors);

  // Raises the errors of predict() where the corners of a pixel show what its centre does not: the
  // second differences along its diagonals.
  //
  //   corners  an image whose samples lie half a pixel left of and above those of the first
  void look_at_corners(const Image& image, std::span<const float> patternless, const Image& corners,
                       std::span<const float> corner_patternless, const Tile& part,
                       std::span<float> errors) const;

 private:
  std::vector<float> values_;       // RGB of the part and a pixel around it
  std::vector<float> means_;        // the same, with what is patternless in its place; or empty
  std::vector<std::uint8_t> flat_;  // whether it is, of each pixel
  std::vector<float> bends_;        // of the same
};

// The least error that is too large, so that the squares of all below it add up to at most
// `budget`; infinite where all do. Off by at most 0.4 %, to the smaller side. errors: ≥ 0.
float least_error_above(std::span<const float> errors, double budget);

// Which pixels get how many samples next. The error of N×N samples is taken to fall with N^1.4
// (measured: docs/accuracy/sampling.md) and their cost grows with N², so the fewest samples for a
// sum of squares go to each pixel with N as its error to the power of 1 / 2.4, in steps of `sides`.
// A draw of its own for a few pixels costs more than it saves: no level is used that the budget can
// do without.
class Allocation {
 public:
  // errors: of each pixel, with as many samples as it has; levels: into sides, which ascend.
  // Those of the last level stay, whatever they are off. budget: of the sum of squares.
  Allocation(std::span<const float> errors, std::span<const std::uint8_t> levels,
             std::span<const unsigned> sides, double budget);

  // The level that a pixel gets, at least the one it has.
  std::size_t level(float error, std::size_t level) const {
    return level_above(least_, highest_, error, level);
  }

 private:
  std::size_t level_above(float least, std::size_t highest, float error, std::size_t level) const;

  std::span<const unsigned> sides_;
  float least_ = 0;  // what gets more samples
  std::size_t highest_ = 0;
};

}  // namespace panwright::preview
