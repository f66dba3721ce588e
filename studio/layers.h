// What the window shows in place of an image's light: what else is known of its pixels, and how far it is from the
// reference renderer's.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "preview/image.h"
#include "preview/reference/reference.h"

namespace panwright::studio {

// light apart, all but false colours need an image with ground truth
inline constexpr const char* kLayers[] = {"light", "false colours", "depth", "normals",
                                          "parts", "materials",     "levels"};
inline constexpr const char* kComparisons[] = {"off", "split", "flicker", "difference"};

// 4*H*W bytes, sRGB, and what the two ends of their colours stand for.
struct Pixels {
  std::vector<std::uint8_t> rgba;
  double low = 0, high = 0;  // both 0: there is no scale
  bool logarithmic = false;
  std::string unit;
};

// layer: one of kLayers, but light and levels (studio/details.h)
Pixels layer_pixels(const preview::Image& image, const std::string& layer);

// Stripes over pixels whose code is 255 in a channel.
void mark_white(std::uint32_t width, std::vector<std::uint8_t>& rgba);

// How an image of the preview differs from one of the reference, of the same pixels.
struct Comparison {
  double flux = 0;        // preview's sum over the reference's less 1, worst channel
  double flux_error = 0;  // one standard error of it, of the reference
  double rmse = 0;        // over the RMS of the reference's radiance
  double noise = 0;       // of that, the part that the reference's own standard errors make up, RMS
  double rms = 0;         // of the reference's radiance
};
Comparison compared(const preview::Image& image, const preview::ReferenceImage& reference);

// Blue where the preview is darker, orange where it is brighter; range: of the difference of the channels' mean at
// the ends of the colours, in parts of `rms`.
Pixels difference_pixels(const preview::Image& image, const preview::Image& reference, double rms, double range);

// The colour of a share, 0 to 1, in dark blue to yellow, of even steps in lightness, which colour-blind people see alike.
void scale_color(double share, std::uint8_t* rgb);

}  // namespace panwright::studio
