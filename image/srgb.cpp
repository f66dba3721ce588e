#include "image/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math.h"

namespace panwright::image {

namespace {

// threshold[k]: the least linear value whose code is k+1
std::array<double, 255> made_thresholds() {
  std::array<double, 255> thresholds{};
  for (std::size_t k = 0; k < thresholds.size(); ++k)
    thresholds[k] = linear_from_srgb((static_cast<double>(k) + 0.5) / 255.0);
  return thresholds;
}

}  // namespace

double linear_from_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : det::pow((encoded + 0.055) / 1.055, 2.4);
}

double srgb_decoded(std::uint8_t code) {
  static const std::array<double, 256> values = [] {
    std::array<double, 256> all{};
    for (std::size_t i = 0; i < all.size(); ++i)
      all[i] = linear_from_srgb(static_cast<double>(i) / 255);
    return all;
  }();
  return values[code];
}

std::uint8_t srgb_code(double linear) {
  static const std::array<double, 255> thresholds = made_thresholds();
  if (std::isnan(linear)) return 0;
  return static_cast<std::uint8_t>(std::upper_bound(thresholds.begin(), thresholds.end(), linear) -
                                   thresholds.begin());
}

}  // namespace panwright::image
