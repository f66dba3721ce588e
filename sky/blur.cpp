#include "sky/internal/blur.h"

#include <cmath>

#include "base/math.h"

namespace panwright::sky {

// The mean of exp(t·(cos a − 1))·cos(n·a), exact with more angles than terms. T. Lindeberg,
// "Scale-space for discrete signals", 1990.
std::vector<double> kernel_of_psf(double sigma, std::uint32_t reach) {
  const int angles = 64 + 2 * static_cast<int>(reach);
  const double t = sigma * sigma;
  std::vector<double> kernel;
  for (std::uint32_t n = 0; n <= reach; ++n) {
    double sum = 0;
    for (int i = 0; i < angles; ++i) {
      const double angle = kPi * (i + 0.5) / angles;
      sum += det::exp(t * (det::cos(angle) - 1)) * det::cos(n * angle);
    }
    kernel.push_back(sum / angles);
  }
  return kernel;
}

void convolve(std::span<const float> in, std::size_t lines, std::size_t length, std::size_t step,
              std::size_t next, std::span<const double> kernel, std::vector<float>& out,
              std::size_t out_step, std::size_t out_next) {
  const std::size_t reach = kernel.size() - 1;
  for (std::size_t line = 0; line < lines; ++line)
    for (std::size_t i = reach; i + reach < length; ++i)
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const float* at = &in[line * next + i * step + channel];
        double sum = kernel[0] * *at;
        for (std::size_t k = 1; k <= reach; ++k)
          sum += kernel[k] * (static_cast<double>(at[k * step]) + *(at - k * step));
        out[line * out_next + (i - reach) * out_step + channel] = static_cast<float>(sum);
      }
}

}  // namespace panwright::sky
