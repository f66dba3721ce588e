// Labels of one frame: which target and which part is where in the image, how much of it can be
// seen, and where its keypoints are. Plain data; conventions of pixels and axes: world/camera.h.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/math.h"
#include "world/camera.h"

namespace panwright::labels {

// Coverage of the pixels of a rectangle within the image: 0 to 255 for 0 to 1, rounded; 1 for less.
// Pixels outside are 0. The smallest rectangle of what is not 0; empty: nothing.
struct Mask {
  std::uint32_t left = 0, top = 0;      // pixels
  std::uint32_t width = 0, height = 0;  // pixels
  std::vector<std::uint8_t> coverage;   // height*width, rows from the top

  bool operator==(const Mask&) const = default;
};

// Rectangle in the image plane, edges in pixels: pixel (i, j) covers [i, i+1) × [j, j+1).
struct Box {
  double left = 0, top = 0, right = 0, bottom = 0;

  bool operator==(const Box&) const = default;
};

// Point named by the author of a model, in this frame.
struct Keypoint {
  std::string name;
  Vec3 position{0};           // metres, in the target's frame, joints as in this frame
  Vec3 in_camera{0};          // metres, camera axes
  std::optional<Vec2> pixel;  // none: behind the camera, or outside the domain of its lens
  bool truncated = false;     // outside the image, or no pixel
  bool occluded = false;      // something stands between it and the camera
  bool lit = false;  // nothing stands between it and the Sun's centre, and it faces the Sun

  bool operator==(const Keypoint&) const = default;
};

// A target, or a part of one that its author labelled.
struct Thing {
  std::uint32_t id = 0;  // in this frame's layers of labels, from 1; equal in all frames of a run
  std::string target;    // name in the world
  std::string label;     // of the part; empty: the whole target
  world::Pose camera_from_thing;  // of the target's frame, or of the part's own
  Mask amodal;                    // as if nothing else were there; its own other parts too
  Mask visible;                   // as in the image
  // Of the whole, beyond the image's edges too; of what reaches behind the camera, or outside its
  // lens's domain, the rest within three images' width and height around this one; none: no rest.
  std::optional<Box> amodal_box;
  std::optional<Box> visible_box;   // of what is visible, within the image; none: nothing
  double amodal_pixels = 0;         // area, within three images' width and height around this one
  double visible_pixels = 0;        // area of what is visible; at most amodal_pixels
  std::vector<Keypoint> keypoints;  // of a target: all; of a part: those within

  bool operator==(const Thing&) const = default;
};

// Motion of what each pixel's centre shows, pixels, to its place in another frame: hidden there or
// not, beyond the image's edges too.
struct Flow {
  std::uint32_t width = 0, height = 0;
  std::vector<float> motion;  // 2*height*width: right, down; NaN: background, or no pixel there

  bool operator==(const Flow&) const = default;
};

struct FrameLabels {
  std::string name;          // of the frame's files, without an extension
  std::string image;         // its file, relative to the folder of labels; empty: none
  std::uint64_t number = 0;  // of the frame, from 0
  double time = 0;           // seconds, of the sequence
  world::Camera camera;
  std::optional<Vec2> pixel_um;  // sides of a pixel of its detector, µm; none: not known
  Vec3 sun_in_camera{0};         // unit, to the Sun, camera axes
  std::vector<Thing> things;     // targets in the world's order, each followed by its parts
  std::optional<Flow> forward, backward;  // to the next and the previous frame
};

}  // namespace panwright::labels
