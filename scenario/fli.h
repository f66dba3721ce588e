// PANGU flight files (.fli), as far as their commands are public.
//
// Commands, one a line; # begins a comment anywhere:
//   start x y z yaw pitch roll          camera, degrees: world_from_camera =
//                                       Rz(yaw)·Rx(pitch)·Rx(−90)·Rz(−roll); makes a frame
//   x y z yaw pitch roll                change from the camera before; makes a frame
//   quaternion x y z q0 q1 q2 q3        camera, world_from_camera, scalar first; makes a frame
//   update                              makes a frame of the state as it is
//   dynamic_object ID x y z q0 q1 q2 q3 pose of an object, world_from_model, for frames that follow
//   sun_position r azimuth elevation    metres, degrees; azimuth from +x towards +y (N8010)
//   set_time t                          seconds, of frames that follow
//   pause s                             without effect
//   view NAME                           skipped (W8002)
#pragma once

#include <map>
#include <optional>
#include <string>

#include "base/math.h"
#include "base/result.h"
#include "scenario/source.h"
#include "scenario/text.h"

namespace panwright::scenario {

struct FliOptions {
  std::map<std::string, std::string> targets;  // name of an object's target by its ID; else the ID
  std::optional<double> frame_rate;            // frames/s; none: as the file says
  bool strict = false;                         // unknown commands are errors
};

// Attitude of a camera as flight files and the PANGU protocol have it, degrees. At yaw 0 and pitch
// 0 the boresight is +y; yaw is counted about +z, pitch upwards, roll clockwise about the
// boresight.
struct FlightAngles {
  double yaw = 0, pitch = 0, roll = 0;
};
// Returns world_from_camera.
Quat rotation_of(const FlightAngles& angles);
// Returns the angles of a world_from_camera: pitch from -90 to 90; yaw 0 where the boresight is
// vertical.
FlightAngles angles_of(const Quat& world_from_camera);

// Reads a flight. Frames have the times of set_time where these ascend from frame to frame; else
// those of the frame rate, which is an option or a comment "# Frame rate: 10" (N8010); else an
// order alone. Between frames with times the camera and objects move straight and turn evenly.
//
// Reports: N8010, W8002, W8006, W8012. Fails: E8001, E8005.
Result<SourcePtr> read_fli(const Text& text, const FliOptions& options, DiagnosticLog& log);

}  // namespace panwright::scenario
