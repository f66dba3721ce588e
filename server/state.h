// State of a session: a world of its own, cameras, light and sky as requests set them.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "base/math.h"
#include "image/image.h"
#include "server/packing.h"
#include "world/world.h"

namespace panwright::server {

// The session's own cameras; others are frames of objects, kFirstFrameCamera + their number.
constexpr std::uint32_t kFirstFrameCamera = 2;

// Rates of a camera or a LiDAR: position p + v·t + a·t²/2 + j·t³/6 in world axes, attitude
// q·exp(w·t + s·t²/2 + u·t³/6) with the rotation vector in its own axes. Metres, radians, seconds.
struct Motion {
  Vec3 velocity{0}, acceleration{0}, jerk{0};
  Vec3 turn{0}, turn_acceleration{0}, turn_jerk{0};
  bool operator==(const Motion&) const = default;
  bool still() const { return *this == Motion(); }
  // Returns the pose at a time, seconds after that of `start`.
  world::Pose at(const world::Pose& start, double time) const;
};

// Lens of one camera, where it differs from that of the command line.
struct Lens {
  std::optional<double> field_of_view;  // across the image, radians
  std::optional<double> aspect;         // angle of a pixel across over that of it down
  bool orthographic = false;
  Vec2 ortho{10, 10};  // metres across and down
  Motion motion;
};

// Light that a camera carries; position and axis in the camera's frame.
struct CameraLight {
  bool on = false;
  std::uint32_t camera = 0;
  Vec3 intensity{1};
  double half_angle = kPi / 6;  // radians
  double exponent = 0;
  Vec3 position{0};  // metres
  Vec3 axis{0, 0, 1};
};

enum class FogMode : std::uint8_t { none, linear, exponential, squared };

// Homogeneous fog, by the range d: transmission (l1-d)/(l1-l0), exp(-rho·d) or exp(-(rho·d)²).
struct Fog {
  FogMode mode = FogMode::none;
  double radius = 0;   // metres, of the dome that ends it; 0: none
  double density = 0;  // 1/m
  double begin = 0, end = 1;
  // Returns the share of light that comes through. range: metres, infinite for the background.
  double transmission(double range) const;
};

struct SkyColor {
  std::uint32_t type = 0;
  Vec3 rgb{0};  // of type 8
  Vec3 cie{0};  // x, y, Y of type 9
  // Returns the colour of the background, 1: white; none: no colour, or stars.
  Vec3 color() const;
  bool shows_stars() const { return type == 2 || type == 7; }
};

struct CornerCube {
  Vec3 position{0}, normal{0, 0, 1};
  double radius = 0;
};

// Settings of the LiDAR as SetLidarParameters has them.
struct LidarParameters {
  double width = 20, height = 20;         // degrees
  std::uint32_t columns = 64, rows = 64;  // beams
  double time_x = 0, time_y = 0;
  std::uint32_t samples_x = 1, samples_y = 1;  // of each beam
  std::uint32_t type = 0, flags = 1;
  std::array<double, 10> others{};  // azimuth, elevation and half-angle first
};

struct LidarPulse {
  double time = 0;  // seconds
  Quat direction{1, 0, 0, 0};
};

struct State {
  world::World world;
  world::Pose viewpoint;                 // world_from_camera of the session's own cameras
  std::map<std::uint32_t, Lens> lenses;  // by camera; the session's own are one: 0
  std::uint32_t camera = 0;              // selected
  CameraLight light;
  Vec3 ambient{0};
  SkyColor sky;
  Fog fog;
  Quat world_from_icrs{1, 0, 0, 0};
  double faintest = 8;               // magnitude of stars
  double time = 0;                   // global time, seconds
  std::optional<double> image_time;  // global time of the last image
  LidarParameters lidar;
  std::vector<LidarPulse> pulses;
  std::vector<CornerCube> cubes;
  Quat cube_attitude{1, 0, 0, 0};
  Motion cube_motion;                 // its turn alone
  std::shared_ptr<const Bytes> held;  // image of the hold buffer, as a reply
  bool shows_held = false;            // the next GetImage answers it
};

// Returns the camera whose lens and pose a number means: 0 for both of the session's own.
constexpr std::uint32_t own_camera(std::uint32_t camera) {
  return camera < kFirstFrameCamera ? 0 : camera;
}

}  // namespace panwright::server
