// Convolution of images with a Gaussian. Private to sky.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace panwright::sky {

// Returns the discrete Gaussian of a variance t, exp(−t)·I_n(t), to `reach`.
std::vector<double> kernel_of_psf(double sigma, std::uint32_t reach);

// Convolves rows or columns of three channels and keeps what lies within the margin.
void convolve(std::span<const float> in, std::size_t lines, std::size_t length, std::size_t step,
              std::size_t next, std::span<const double> kernel, std::vector<float>& out,
              std::size_t out_step, std::size_t out_next);

}  // namespace panwright::sky
