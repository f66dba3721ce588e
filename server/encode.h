// Drawn images as replies: background, fog and the bytes of an image file.
#pragma once

#include <cstdint>

#include "base/job.h"
#include "server/packing.h"
#include "server/stage.h"
#include "server/state.h"

namespace panwright::server {

enum class WireFormat : std::uint8_t {
  ppm,     // a binary PPM, 8 bits, linear; of a detector a PGM of its numbers
  raw,     // the same without its header
  floats,  // a PFM: radiance, float32, little-endian, from the bottom row
};

struct WireImages {
  WireFormat format = WireFormat::ppm;
  bool grey = false;  // one channel: the mean of the bands
};

// Adds the background's colour and the fog to an image.
//
//   white  irradiance of a white plate, of SkyColor's 1
// Expects: ranges where there is fog.
void add_sky_and_fog(const State& state, double white, image::Image& image, const Job& job);

// Appends an image reply: its code, the number of bytes, the bytes.
void append_image(const Drawing& drawing, const WireImages& images, WireWriter& out,
                  const Job& job);

// Appends an image of greys, one byte a pixel, in the form of the others.
//
//   greys  H*W, row 0 the top row
void append_greys(std::span<const std::uint8_t> greys, std::uint32_t width, std::uint32_t height,
                  const WireImages& images, WireWriter& out);

}  // namespace panwright::server
