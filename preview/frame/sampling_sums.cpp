#include <algorithm>
#include <cmath>
#include <iterator>

#include "preview/frame/sampling_frame.h"

namespace panwright::preview {

bool Sampling::read_means(std::uint32_t width, std::uint32_t height, std::size_t area,
                          unsigned samples, DiagnosticLog& log) {
  if (!ensure_render_target(gl_, mean_, kMeanFormats, false, width, height, area, log) ||
      !resolve(mean_, width, height, samples, true, log))
    return false;
  const std::size_t floats = std::size_t{4} * width * height;
  floats_.resize(std::max(floats_.size(), 2 * floats));
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
  for (unsigned i = 0; i < std::size(kMeanFormats); ++i) {
    gl_.ReadBuffer(GL_COLOR_ATTACHMENT0 + i);
    gl_.ReadPixels(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height), GL_RGBA,
                   GL_FLOAT, floats_.data() + i * floats);
  }
  gl_.ReadBuffer(GL_COLOR_ATTACHMENT0);
  return true;
}

bool Sampling::add_errors(std::uint32_t width, std::uint32_t height, unsigned samples, Sums& sums,
                          DiagnosticLog& log) {
  if (!read_means(width, height, std::size_t{width} * height, samples, log)) return false;
  const std::size_t floats = std::size_t{4} * width * height;
  for (std::size_t at = 0; at < floats; at += 4) {
    double off = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto radiance = static_cast<double>(floats_[at + k]);
      const auto spread = static_cast<double>(floats_[floats + at + k]);
      sums.radiance += radiance;
      sums.squares += radiance * radiance / 3;
      off += spread * spread / 3;
    }
    const double error = static_cast<double>(kGain) * std::sqrt(off);
    sums.errors += error;
    sums.error_squares += error * error;
  }
  return true;
}

void Sampling::Sums::state(SamplingReport& report) const {
  report.rmse = squares > 0 ? std::sqrt(error_squares / squares) : kNothingLit;
  report.flux = squares > 0 ? 3 * errors / radiance : kNothingLit;
}

}  // namespace panwright::preview
