// Layers of an image as colours, and its comparison with a reference image.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "image/image.h"
#include "preview/reference/reference.h"

namespace panwright::studio {

// All but light and false colours need an image with ground truth.
inline constexpr const char* kLayers[] = {"light", "false colours", "depth", "normals",
                                          "parts", "materials",     "levels"};
inline constexpr const char* kComparisons[] = {"off", "split", "flicker", "difference"};

// Pixels with their colour scale.
struct Pixels {
  std::vector<std::uint8_t> rgba;  // 4*H*W, sRGB
  double low = 0, high = 0;        // values of the ends of the colours; both 0: no scale
  bool logarithmic = false;
  std::string unit;
};

// Pixels of a layer. layer: one of kLayers, except light and levels (studio/details.h)
Pixels layer_pixels(const image::Image& image, const std::string& layer);

// Numbers of a detector as grey, 4*H*W: black is 0, white the largest number.
std::vector<std::uint8_t> dn_pixels(const image::Image& image);

// Draws stripes over pixels with a code of 255 in a channel; or over those of `marked`, 1 each.
void mark_white(std::uint32_t width, std::vector<std::uint8_t>& rgba);
void mark_pixels(std::uint32_t width, std::span<const std::uint8_t> marked,
                 std::vector<std::uint8_t>& rgba);

// Difference between an image of the preview and a reference image of the same size.
struct Comparison {
  double flux = 0;        // relative difference of the sum, worst channel
  double flux_error = 0;  // standard error of `flux`, of the reference
  double rmse = 0;        // over the RMS of the reference's radiance
  double noise = 0;       // RMS of the standard errors of the reference, over the same
  double rms = 0;         // of the reference's radiance
};
Comparison compared(const image::Image& image, const preview::ReferenceImage& reference);

// Difference of the mean of the channels: blue where the preview is darker, orange where it is
// brighter. range: at the ends of the colours, in parts of `rms`
Pixels difference_pixels(const image::Image& image, const image::Image& reference, double rms,
                         double range);

// Colour of a share from 0 to 1, dark blue to yellow in equal steps of lightness, suited to colour
// blindness.
void scale_color(double share, std::uint8_t* rgb);

}  // namespace panwright::studio
