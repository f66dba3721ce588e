// Shared state of one image's sampling. Private to Sampling.
#pragma once

#include <cstdint>
#include <span>

#include "preview/frame/sampling.h"

namespace panwright::preview {

// Error of N×N samples, in parts of how far the four grids of N/2×N/2 in them lie apart.
// Edges along the axes, which all four may miss alike, halve with N.
inline constexpr float kGain = 0.5f;

// Means of N×N samples, and their spread.
inline constexpr GLenum kMeanFormats[] = {GL_RGBA32F, GL_RGBA32F};

struct Sampling::Frame {
  const FrameScene& scene;
  const RenderOptions& options;
  std::span<const GLenum> formats;
  image::Image& image;
  const Job& job;
  DiagnosticLog& log;
  std::uint32_t width = 0;   // of the largest tile, samples
  std::uint32_t height = 0;  // the same
  Tile part;                 // of the image that anything may fall on
  double triangles = 0;      // on it

  bool cancelled() const {  // reports E0001 then
    if (job.cancelled()) report_cancelled(log);
    return job.cancelled();
  }

  std::uint64_t area() const { return std::uint64_t{width} * height; }

  // Of pixels of the part, row by row.
  std::size_t count() const { return std::size_t{part.width} * part.height; }
  std::size_t index(const Pixel& pixel) const {
    return std::size_t{pixel.y - part.y} * part.width + pixel.x - part.x;
  }
  Pixel pixel(std::size_t index) const {
    return {part.x + static_cast<std::uint32_t>(index % part.width),
            part.y + static_cast<std::uint32_t>(index / part.width)};
  }

  // Of a pixel in the layers of the image.
  std::size_t at(const Pixel& pixel) const { return std::size_t{pixel.y} * image.width + pixel.x; }

  // The samples a pixel of the image that `pixels` of them with N×N add.
  double added(std::size_t pixels, unsigned n) const {
    return static_cast<double>(pixels) * n * n / static_cast<double>(image.pixels());
  }
};

}  // namespace panwright::preview
