// Automatic exposure of an image.
#pragma once

#include "image/image.h"

namespace panwright::workspace {

// Returns the exposure, as of --ev, at which 99 of 100 lit pixels are below 0.8 of white, in steps
// of 1/8: their largest channel, without background. Lit: with a target and not black.
//
//   stops_of_sun  difference of --ev from write_image's exposure: log2 of the irradiance
//   returns       stops; 0: nothing is lit
// Cost: a copy of a number for each lit pixel.
double auto_exposure(const image::Image& image, double stops_of_sun);

}  // namespace panwright::workspace
