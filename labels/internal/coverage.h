// Coverage of pixels by the things of a world, as if alone and as visible.
//
// Surfaces are sampled at 8×8 points a pixel, finer where they are narrow: all their triangles are
// converted to spans of samples. Where several leaves have a sample, rays find the nearest. Where
// all have whole pixels, the layers of ids of an image stand for rays, where a pixel and its
// neighbours agree. Terrain is sampled by rays.
#pragma once

#include <cstdint>
#include <vector>

#include "base/axis_box.h"
#include "base/job.h"
#include "image/image.h"
#include "labels/internal/image_plane.h"
#include "labels/internal/surfaces.h"
#include "labels/labels.h"
#include "labels/parts.h"
#include "trace/scene.h"

namespace panwright::labels {

// Frame to be labelled. Members outlive it.
struct Shown {
  const trace::Scene& scene;  // its observer: the camera
  const ImagePlane& plane;
  const Things& things;
  const image::Image* layers = nullptr;  // of the camera, with ground truth; null: none
  AxisRectangle canvas;                  // within which things are counted
};

// Coverage by one thing.
struct Coverage {
  AxisRectangle box;  // of the whole; of what is cut, within the canvas
  Mask amodal, visible;
  double amodal_pixels = 0, visible_pixels = 0;
  AxisRectangle visible_box;  // within the image, to 1/8 of a pixel
};

// Returns the coverage by each thing. Throws Cancelled.
std::vector<Coverage> covered(const Shown& shown, const Surfaces& surfaces, const Job& job);

}  // namespace panwright::labels
