// Frames of scenarios as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "scenario/frame.h"

namespace panwright::tools {

// Returns one object: number, time, epoch, name, seed, camera, quat, fov, intrinsics, poses,
// joints, sun, sun_distance; those that the frame has. Metres, seconds, radians, AU; quaternions w
// x y z as world_from_camera and world_from_model.
nlohmann::ordered_json frame_json(const scenario::Frame& frame, std::uint64_t number);

}  // namespace panwright::tools
