// FLIP, the perceived difference of two alternating images.
#pragma once

#include <cstdint>
#include <vector>

namespace panwright::bench {

// Returns the mean FLIP over the image, 0 (equal) to 1.
//
//   reference, test   3*width*height linear RGB, shown on a display whose white is 1; clamped to
//   0..1 pixels_per_degree of visual angle; 67: 0.7 m from a 0.7 m wide screen of 3840 pixels
//
// P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. Fairchild, "FLIP: A
// difference evaluator for alternating images", 2020. Its authors recommend the mean.
double mean_flip(const std::vector<float>& reference, const std::vector<float>& test,
                 std::uint32_t width, std::uint32_t height, double pixels_per_degree = 67);

}  // namespace panwright::bench
