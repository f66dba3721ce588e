// Resampling of imposters' texels to pixels, by exact overlap areas. Private to preview; nothing
// here needs OpenGL.
#pragma once

#include <span>
#include <vector>

#include "image/image.h"
#include "preview/frame/imposters.h"
#include "preview/frame/projection.h"

namespace panwright::preview {

// Contribution of an imposter's texels to the pixels of an image.
struct ImposterPatch {
  Tile part;                  // of the image
  std::vector<double> light;  // radiance of three channels and coverage; 4*part.height*part.width
};

// Adds texels to the pixels below them, by exact overlap areas, or, with a PSF, by the integrals of
// a Gaussian over pixels. All in double, in a fixed order.
//
//   texels         an image of the imposter's camera
//   others         the same without targets of imposters; null: empty. The image already contains
//                  it, so it is subtracted
//   finer          rectangles of smaller imposters, which are excluded from the texels
//   sigma          of the PSF, pixels; 0: none
//   width, height  of the image, pixels: the outside is left out
// Expects: a placed imposter with two texels a pixel or more.
ImposterPatch patch_of(const Imposter& imposter, const image::Image& texels,
                       const image::Image* others, std::span<const PlaneRect> finer, double sigma,
                       std::uint32_t width, std::uint32_t height);

// Estimates the relative error of the flux by point samples, from the differences of neighbouring
// texels: calibrated on discs, for which it is 0.29 times the radius to -3/2; texels that are lit
// alone count as hits of chance. 0 for an image without light.
double flux_error_of(const image::Image& texels);

// Estimates the error of the pixels, RMSE over RMS radiance, for independent errors.
//
//   rate  texels a pixel, along a side
double pixel_error_of(const image::Image& texels, double flux_error, double rate);

// Convolves pixels with a Gaussian PSF: the discrete kernel of its variance that adds up to 1.
// Light from beyond the border is missing.
void convolve(double sigma, image::Image& image);

// Adds imposters to an image. Negative results, from errors of the image's samples, become 0.
void add_patches(std::span<const ImposterPatch> patches, image::Image& image);

}  // namespace panwright::preview
