// Pinhole views that together cover the image of a lens with distortion. Private to preview;
// nothing here needs OpenGL. Reasons and accuracy: docs/accuracy/lenses.md.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/axis_box.h"
#include "preview/frame/projection.h"
#include "world/camera.h"

namespace panwright::preview {

// Pinhole view of a part of the image plane, from the same eye.
struct LensView {
  world::Camera camera;    // its pixels are texels
  Mat3 lens_from_view{1};  // rotation between the cameras' axes
  double pixels = 0;       // of the area that have a ray
  double waste = 1;        // texels, relative to rate² a pixel
};

// Turn of a view about its boresight.
enum class LensTurn {
  none,     // the lens's own axes: fields up to kWidestTangent off the boresight
  centred,  // boresight in the middle, rows along those of the image
  golden,   // the same, turned by the golden angle: as imposters
};

// Widest tangent of a direction to the boresight of a view.
inline constexpr double kWidestTangent = 2;

// Returns the view of an area of the image, with two texels around it.
//
//   rate     texels a pixel, along a side, where texels are widest in pixels; > 0
//   returns  nothing: no ray falls on the area (why: none), or the field is too wide (why: wide)
enum class NoView { none, wide };
std::optional<LensView> lens_view(const world::Camera& lens, const AxisRectangle& area, double rate,
                                  LensTurn turn, NoView& why);

// Part of an image, and its view.
struct LensPart {
  Tile part;
  LensView view;
};

// Divides a part of the image into parts with a view each, of at most `most_texels` texels.
//
// Returns false: a part would be smaller than 8 pixels.
bool divide(const world::Camera& lens, const Tile& part, double rate, double most_texels,
            std::vector<LensPart>& parts);

// Returns the rectangle of pixels around the image of a box, slightly larger; all of the plane:
// some of the box has no place on it.
AxisRectangle lens_area(const world::Camera& lens, const world::Pose& pose, const AxisBox& box);

// Returns the whole pixels of the image that a rectangle touches; a width or height of 0: none.
Tile touched_pixels(const world::Camera& lens, const AxisRectangle& area);

}  // namespace panwright::preview
