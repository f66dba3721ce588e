// Blur by distance: what is nearer or farther than the focus is spread over discs. Pure functions.
#pragma once

#include <cstdint>
#include <span>

#include "base/math.h"
#include "sensor/optics.h"

namespace panwright::sensor {

// Diameter of the disc that a point makes, pixels: D f |1/z − 1/focus|, D of the pupil (thin lens).
//
//   focal_px  focal length
//   depth_m   z, along the boresight; infinite: 1/z is 0. Expects: > 0
// Expects: a focus.
double blur_px(const Optics& optics, double focal_px, double depth_m);

// Largest diameter that is drawn, pixels of the image.
inline constexpr double kMostBlur = 256;

struct DepthImage {
  std::uint32_t width = 0, height = 0;
  std::span<float> radiance;     // 3*width*height
  std::span<const float> depth;  // width*height, metres along the boresight; infinite: background
  double psf_px = 0;             // Gaussian that the radiance has been convolved with, RMS
};

// Spreads the light of each pixel over the disc of its depth, in place. The sum stays, less what
// leaves the image. A pixel without depth beside ones that have it takes the nearest of theirs:
// edges of a target are blurred as it is. So do pixels farther off whose light may be the
// Gaussian's.
//
// One behind the other: light of both is added, as if neither hid parts of the other's disc.
//
//   focal_px  of both axes
void defocus(const Optics& optics, const Vec2& focal_px, DepthImage& image);

}  // namespace panwright::sensor
