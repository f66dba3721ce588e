// Tracks of a scenario and its camera's field of view, as lines over an image from outside.
#pragma once

#include <vector>

#include "base/math.h"
#include "studio/play.h"
#include "world/camera.h"

namespace panwright::studio {

struct TrackLine {
  enum class Kind {
    past,          // of a track, up to the moment
    future,        // after it
    target,        // of a target's track
    field_of_view  // of the camera
  };
  Kind kind = Kind::past;
  Vec2 from{0}, to{0};  // pixels of the image
};

// Lines in an image, clipped to it. Field of view: corner rays and border of the camera's image, at
// the distance of `centre`, with a triangle above.
//
//   camera  of the image
//   centre  of the targets, world, metres
std::vector<TrackLine> track_lines(const world::Camera& camera, const Play& play,
                                   const Moment& moment, const Vec3& centre);

}  // namespace panwright::studio
