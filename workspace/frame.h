// Frames: moments to be measured by an instrument. Syntax of views: docs/conventions.md 2–7.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"
#include "base/result.h"
#include "sensor/camera_file.h"
#include "workspace/instrument.h"
#include "workspace/labelling.h"
#include "workspace/scene_settings.h"
#include "workspace/settings.h"
#include "workspace/shutter.h"
#include "workspace/sky_settings.h"
#include "workspace/targets.h"
#include "workspace/views.h"
#include "world/world.h"

namespace panwright::workspace {

struct TargetPose {
  std::string target;  // its name
  world::Pose pose;    // world_from_model
};

struct TargetJoint {
  std::string target;  // its name
  std::uint32_t joint = 0;
  geometry::JointValues values{};
};

// State of a world at one time.
struct WorldState {
  std::vector<TargetPose> poses;    // different from the world; later ones replace earlier ones
  std::vector<TargetJoint> joints;  // different from the world, aims resolved
  std::optional<world::Sun> sun;    // none: the world's
  std::optional<Vec3> white;        // none: the world's
  std::optional<std::vector<world::Lamp>> lamps;  // all of them; none: the world's
  std::shared_ptr<const SkyState> sky;            // null: the world's
};

// State of a world at one moment of an exposure, with the camera's pose.
struct Moment : WorldState {
  Vec3 position{0};
  Quat world_from_camera{1, 0, 0, 0};
};

// State of a world at one time, and what measures it.
struct Frame : WorldState {
  std::string label;  // name in diagnostics, as "view 3 ('far')"; empty: none
  double time = 0;    // seconds, of the sequence
  Instrument instrument;
  // Of an exposure over time in which the image moves; empty: the frame is drawn alone.
  std::vector<Moment> moments;
  std::optional<ShutterMoments> shutter;  // of these
  Settings settings;                      // of drawing and files, and the seed
  // Settings that the scene of a model gave, as "sun 1 0 0", and the target that has it.
  std::vector<std::string> of_scene;
  std::string scene_target;
  std::vector<std::string> outputs;              // files of one product
  std::shared_ptr<const sensor::Imager> imager;  // optics and detector; null: none
  std::shared_ptr<const FrameLabelling> labels;  // to write beside them; null: none

  // The camera. Expects: one.
  world::Camera& camera() { return std::get<CameraInstrument>(instrument).camera; }
  const world::Camera& camera() const { return std::get<CameraInstrument>(instrument).camera; }
};

// Sets a state in a shown world: its poses, joints, Sun and lamps, all else as in `world`.
// Unchanged parts keep their stamps, and all state derived from them.
//
// Expects: `shown` was copied from `world`; targets and joints of the world.
void show(const WorldState& state, const world::World& world, world::World& shown);

// Maker of frames of one world from views. What they leave out is that of the scene of the first
// target that has one. Without a lens, the visible targets fill the image,
// by their outline if the camera is not given either, else by their sphere.
// Without a position, the camera is in front of them, above the ground. Without a direction, it
// looks at the origin if a position is given and there is no terrain, else at their centre. Without
// a Sun, it shines from behind the camera's left shoulder. From one moment of an exposure over time
// to the next, the image moves by half a pixel, with quality draft by one.
class FrameMaker {
 public:
  // Expects: world outlives the maker.
  explicit FrameMaker(const world::World& world) : world_(world) {}

  // Reports: N5004, W5008 where an exposure needs more moments than are drawn, W5015, W5019.
  // Fails: E8003, E0201 (of a view with a label: E0203), E0202, E5005, E5011, E5013, E5014.
  Result<Frame> frame(const View& view, DiagnosticLog& log);

 private:
  Result<Frame> made(const View& view, DiagnosticLog& log);
  bool set_labels(const ViewLabels& of, Frame& frame, DiagnosticLog& log);
  Result<Frame> at_once(const View& view, DiagnosticLog& log);
  bool expose(const View& view, Frame& frame, DiagnosticLog& log);
  bool switch_lamps(const View& view, Frame& frame, DiagnosticLog& log);
  bool use_camera_file(Settings& settings, DiagnosticLog& log);
  bool use_detector(Settings& settings, Frame& frame, DiagnosticLog& log);
  const world::World& world_;
  BoundingSpheres spheres_;
  SkyReader sky_;
  SceneReader scene_;
  std::map<std::string, sensor::CameraFile> cameras_;  // read so far, by path
  std::set<std::string> refused_;  // of them, those that were reported; options too
  std::map<std::string, std::shared_ptr<const sensor::Imager>> imagers_;  // by text
};

}  // namespace panwright::workspace
