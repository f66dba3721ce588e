// View of the window, as options of `panwright render`: camera, Sun, exposure, poses, joints.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/math.h"
#include "studio/orbit_camera.h"
#include "workspace/settings.h"

namespace panwright::studio {

struct Moment;  // studio/play.h

// Pose of a target in the world.
struct TargetPose {
  Vec3 position{0};  // world, metres
  Vec3 angles{0};    // degrees: roll, pitch, yaw about x, then y, then z of the world
  Quat rotation() const;
  bool operator==(const TargetPose&) const = default;
};

// Sky and lamps, where they are not those of the models.
struct SkyChoice {
  workspace::Settings settings;  // planets, stars, the Sun's disc and light, date
  // "TARGET/NAME" of a lamp of a model: words of --lamp behind its name
  std::map<std::string, std::string> lamps;
  std::optional<double> camera_lamp;  // intensity of a spot at the camera
  bool operator==(const SkyChoice&) const = default;
};

// Angles in degrees, as options take them.
struct ViewState {
  OrbitCamera camera;
  double sun_azimuth = -20;
  double sun_elevation = 30;
  double sun_distance = 1;    // AU
  double scene_distance = 1;  // of the Sun in the scene of a model: left out of settings
  SkyChoice sky;
  // Camera file, unless a scenario plays; and what is not as in its [detector], or the scenario's:
  // exposure, gain and temperature.
  workspace::Settings detector;
  bool has_detector = false;  // of the camera file
  double ev = 0;              // stops
  bool auto_ev = true;        // exposure is found from the exact image
  // as of Settings
  workspace::Settings::Shadows shadows = workspace::Settings::Shadows::automatic;
  workspace::Settings::Imposters imposters = workspace::Settings::Imposters::automatic;
  workspace::Settings::Indirect indirect = workspace::Settings::Indirect::off;
  std::map<std::string, TargetPose> poses;    // of targets by name; others are at the origin
  std::map<std::string, std::string> joints;  // "TARGET/JOINT": value as --joint takes it
  // Of a scenario: its poses, joints and Sun replace those above. Null: there is none.
  std::shared_ptr<const Moment> moment;
  bool from_outside =
      false;  // false: the image is that of the scenario's camera, where there is one

  Vec3 sun() const;      // unit, to the Sun
  double phase() const;  // degrees, between the directions to the camera and to the Sun
  // Turns the Sun by a mouse movement, in parts of the image's height.
  void turn_sun(double right, double down);
  // Moves a Sun below a horizon to where `panwright render` has it: behind the camera, over its
  // left shoulder. up: unit, of the ground
  void raise_sun(const Vec3& up);
  // The moment whose camera the image is of; null: `camera`.
  const Moment* own() const { return from_outside ? nullptr : moment.get(); }
  // The image has a size of its own, that of a scenario's camera or of a file.
  bool sized() const { return own() != nullptr || (!moment && detector.camera_file); }
  bool changes_detector() const {
    return detector.exposure || detector.gain || detector.temperature;
  }
  bool operator==(const ViewState&) const = default;
};

// The settings that make the same image, with few enough digits to be typed; those of a scenario
// with all, and of its camera's size. width, height: unless a camera has its own
workspace::Settings settings_of(const ViewState& view, std::uint32_t width, std::uint32_t height);

// `panwright render …`, quoted for a shell. files: NAME=FILE
std::string command_line(const ViewState& view, std::uint32_t width, std::uint32_t height,
                         const std::vector<std::string>& files, const std::string& output);

}  // namespace panwright::studio
