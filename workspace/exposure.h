// The exposure that shows an image well.
#pragma once

#include "preview/image.h"

namespace panwright::workspace {

// The exposure, as --ev has it, at which 99 of 100 lit pixels lie below 0.8 of white, in steps of
// 1/8: their largest channel, without the background that they may show. Lit: it shows a target and
// is not black.
//
//   stops_of_sun  by which write_image is given less than --ev says: log2 of the irradiance
//   returns       stops; 0: nothing is lit
// Cost: a copy of a number for each lit pixel.
double auto_exposure(const preview::Image& image, double stops_of_sun);

}  // namespace panwright::workspace
