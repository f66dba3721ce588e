// Keyframes: a few states of camera, targets, joints and Sun as JSON, with curves between them; and
// views, states one by one.
//
//   {"epoch": "2026-01-01T00:00:00 UTC", "interpolation": "cubic",
//    "keyframes": [{"time": 0, "camera": [0, -20, 5], "look_at": [0, 0, 0]},
//                  {"time": 60, "camera": [0, -2, 0], "joint": {"client/wing": "90deg"}}]}
//
// Members of a keyframe are those of views (docs/views.md) and `time`, seconds:
//   camera        position, metres
//   quat          world_from_camera, w x y z; or look_at, a point, which is a curve of its own
//   pose          {"TARGET": [x, y, z, qw, qx, qy, qz]} or [x, y, z], world_from_model
//   joint         {"TARGET/JOINT": "30deg"}, or a list of such values; deg, rad, m, cm, mm, and x
//   for
//                 factors
//   sun           direction in world axes, any length; sun_distance, AU
//   fov           full horizontal angle, degrees, or with deg or rad
//   name, seed    of the frame at its time
// A member that a keyframe leaves out is on the curve through the others, and constant before the
// first and after the last.
#pragma once

#include "base/result.h"
#include "scenario/source.h"
#include "scenario/text.h"

namespace panwright::scenario {

struct KeyframeOptions {
  bool strict = false;  // unknown members are errors
};

// Reads keyframes. "interpolation" is "cubic" (the default: continuous velocities) or "linear"
// (rotations by slerp). Its own frames are at the keyframes.
//
// Reports: W8002, W8006. Fails: E8001, E8004, E8005, E8007, E8008.
Result<SourcePtr> read_keyframes(const Text& text, const KeyframeOptions& options,
                                 DiagnosticLog& log);

// Reads views (docs/views.md), a list of them or one a line, as frames by their order or, where all
// have a `time`, by time; the motion between these is even, by slerp. They have the members of
// keyframes and `intrinsics`, "fx fy cx cy"; numbers may be text. Each has the same ones.
//
// Reports: W8002 for other members, once each, and W8006. Fails: E8001, E8004, E8005, E8008.
Result<SourcePtr> read_views(const Text& text, const KeyframeOptions& options, DiagnosticLog& log);

}  // namespace panwright::scenario
