// Resampling of a pinhole view's texels to the pixels of a lens with distortion, by the areas of
// their images. Private to preview; nothing here needs OpenGL.
#pragma once

#include <vector>

#include "image/image.h"
#include "preview/frame/lens_views.h"

namespace panwright::preview {

// Light on cells of a part of an image.
struct LensLight {
  Tile part;           // of the image
  unsigned cells = 1;  // a pixel, along a side
  // Radiance of three channels and coverage, means over cells; 4*part.height*cells*part.width*cells
  std::vector<double> light;
};

// Adds texels to the cells under them: each is the quadrilateral between the places of its corners,
// and its light is spread evenly over it. So quadrilaterals cover the part once, and sums of light
// times area stay. Texels with a corner outside the domain add nothing. In double, in a fixed
// order, whatever the threads are.
void splat(const world::Camera& lens, const LensView& view, const image::Image& texels,
           LensLight& light);

// Adds light to pixels, or replaces them where there is no PSF; outside the image it is dropped.
//
//   sigma  of a Gaussian that it is convolved with before pixels integrate it, pixels; 0: none
void put(const LensLight& light, double sigma, image::Image& image);

// Sets the pixels of a part to background.
void clear(const Tile& part, image::Image& image);

}  // namespace panwright::preview
