// Texels of imposters to pixels, by the exact areas in common. Private to preview; nothing here
// needs OpenGL.
#pragma once

#include <span>
#include <vector>

#include "preview/frame/imposters.h"
#include "preview/frame/projection.h"
#include "preview/image.h"

namespace panwright::preview {

// What the texels of an imposter add to the pixels of an image.
struct ImposterPatch {
  Tile part;                  // of the image
  std::vector<double> light;  // radiance of three channels and coverage; 4*part.height*part.width
};

// Adds texels to pixels: each to those below it, by the exact areas in common, or, with a PSF, by
// the integrals of a Gaussian over pixels. All in double, in a fixed order.
//
//   texels         an image of the imposter's camera
//   others         the same without what has an imposter; null: nothing is there. It is what the
//                  image has already, and is subtracted
//   finer          rectangles of smaller imposters: texels count for what these leave of them
//   sigma          of the PSF, pixels; 0: none
//   width, height  of the image, pixels: what lies outside is left out
// Expects: a placed imposter with two texels a pixel or more.
ImposterPatch patch_of(const Imposter& imposter, const Image& texels, const Image* others,
                       std::span<const PlaneRect> finer, double sigma, std::uint32_t width,
                       std::uint32_t height);

// What point samples leave of the flux, relative, as the steps from texel to texel tell it: as of
// discs, where this is 0.29 times the radius to -3/2. 0 for an image without light.
double flux_error_of(const Image& texels);

// The same of the pixels, RMSE over RMS radiance: where errors of pixels are independent.
//
//   rate  texels a pixel, along a side
double pixel_error_of(const Image& texels, double flux_error, double rate);

// From pixels without to pixels with a Gaussian PSF: the discrete kernel that has its variance and
// adds up to 1. Light from beyond the border is missing.
void convolve(double sigma, Image& image);

// Adds what imposters show to an image. What is less than nothing then, as samples of the image
// have errors, is nothing.
void add_patches(std::span<const ImposterPatch> patches, Image& image);

}  // namespace panwright::preview
