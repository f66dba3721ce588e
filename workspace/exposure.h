// Automatic exposure of an image.
#pragma once

#include "image/image.h"
#include "world/world.h"

namespace panwright::workspace {

// Returns by how much --ev is more than write_image's exposure, stops: a PNG shows a white plate as
// white whatever the irradiance is measured in; where the Sun is off, white emission.
double stops_of_sun(const world::World& world);

// Returns the exposure, as of --ev, at which 99 of 100 lit pixels are below 0.8 of white, in steps
// of 1/8: their largest channel, without background. Lit: with a target and not black.
//
//   stops_of_sun  of the world
//   returns       stops; 0: nothing is lit
// Cost: a copy of a number for each lit pixel.
double auto_exposure(const image::Image& image, double stops_of_sun);

}  // namespace panwright::workspace
