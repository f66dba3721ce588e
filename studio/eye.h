// Where one looks from, and where the Sun is: what the mouse and sliders of the window move.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/math.h"
#include "workspace/targets.h"
#include "workspace/views.h"

namespace panwright::studio {

inline constexpr double kNearest = 1e-2;  // metres from the point that is looked at
inline constexpr double kFarthest = 1e9;

// Where a target stands: world_from_model.
struct Standing {
  Vec3 position{0};  // world, metres
  Vec3 turned{0};    // degrees: first about x, then y, then z of the world (roll, pitch, yaw)
  Quat rotation() const;
  bool operator==(const Standing&) const = default;
};

// A camera on a sphere about the point that it looks at, and the Sun. Angles in degrees, as people
// and options have them; azimuths from +x about +z, elevations from the plane of x and y.
struct Eye {
  Vec3 centre{0};  // world, metres: what is looked at
  double azimuth = -50;
  double elevation = 25;
  double range = 10;            // metres, kNearest to kFarthest
  double fov = 30;              // full horizontal angle
  std::string frame;            // not empty: the camera is in this frame, "TARGET/FRAME"
  double sun_azimuth = -20;
  double sun_elevation = 30;
  double sun_distance = 1;      // AU
  double ev = 0;                // stops
  bool auto_ev = true;          // found from the image, once it is exact
  std::string shadows = "auto";    // as --shadows
  std::string imposters = "auto";  // as --imposters
  std::map<std::string, Standing> poses;      // of targets by name; others stand at the origin
  std::map<std::string, std::string> joints;  // "TARGET/JOINT": value as --joint takes it

  Vec3 direction() const;  // unit, from what is looked at to the camera
  Vec3 sun() const;        // unit, to the Sun
  double phase() const;    // degrees, the angle between the two
  bool operator==(const Eye&) const = default;

  // Turns by a mouse's way, in parts of the image's height.
  void turn(double right, double down);
  void turn_sun(double right, double down);
  // Moves what is looked at by so much of what the image shows at its distance.
  void shift(double right, double down);
  // Moves what is looked at along the boresight, to the right, up, in parts of the range.
  void fly(double ahead, double right, double up);
  void zoom(double factor);  // of the range
  // So that all of it is in the image. aspect: height over width
  void frame_all(const workspace::BoundingSphere& sphere, double aspect);
};

// The same as options of `panwright render`: what is seen is what they make.
workspace::ViewText view_text(const Eye& eye, std::uint32_t width, std::uint32_t height);

// `panwright render …` as one types it. files: NAME=FILE
std::string command_line(const Eye& eye, std::uint32_t width, std::uint32_t height,
                         const std::vector<std::string>& files, const std::string& output);

}  // namespace panwright::studio
