// Detectors of cameras: digital numbers of a rendered image.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "base/diagnostic.h"
#include "image/image.h"
#include "sensor/imager.h"
#include "sensor/psf.h"
#include "workspace/drawer.h"
#include "workspace/frame.h"

namespace panwright::workspace {

struct Detected {
  double exposure_s = 0;
  std::size_t saturated = 0;  // pixels
  unsigned bits = 0;
};

// True: the optics blur by distance, and images of the frame are to be drawn with ground truth.
bool needs_depth(const Frame& frame);

// Optics and detectors of frames, with what is kept between images of one camera.
class Detecting {
 public:
  // Steps of a pixel in which a frame's image is to be drawn; 1: the image itself.
  std::uint32_t steps(const Frame& frame);

  // Camera of these steps, and its Gaussian in `options`.
  world::Camera drawn_camera(const Frame& frame, DrawOptions& options);

  // Turns a drawn image into that of the camera, with its numbers. Negative or infinite radiance is
  // reported (W5017), as is an automatic exposure at its bounds (W5018).
  //
  // Expects: a frame with an imager; ground truth where needs_depth().
  Detected develop(const Frame& frame, bool stages, image::Image& image, DiagnosticLog& log);

 private:
  void prepare(const Frame& frame);
  std::shared_ptr<const sensor::Imager> imager_;
  world::Camera camera_;
  std::optional<sensor::Sensitivity> sensitivity_;
  std::optional<sensor::Blur> blur_;  // of images in steps
};

}  // namespace panwright::workspace
