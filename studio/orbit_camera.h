// Camera on a sphere about a point, as mouse and sliders move it.
#pragma once

#include <string>

#include "base/math.h"
#include "workspace/targets.h"

namespace panwright::studio {

inline constexpr double kNearest = 1e-2;  // metres from the centre
inline constexpr double kFarthest = 1e9;

// Unit vector of an azimuth, from +x about +z, and an elevation, from the xy plane. Degrees.
Vec3 direction_of(double azimuth, double elevation);

// An angle within -180 to 180. Degrees.
double wrapped_degrees(double angle);

// Angles in degrees, as options take them.
struct OrbitCamera {
  Vec3 centre{0};  // world, metres: the point that the camera looks at
  double azimuth = -50;
  double elevation = 25;
  double range = 10;  // metres, kNearest to kFarthest
  double fov = 30;    // full horizontal angle
  std::string frame;  // not empty: the camera is in this frame of a model, "TARGET/FRAME"

  Vec3 direction() const;  // unit, from the centre to the camera
  Vec3 position() const;   // world, metres
  bool operator==(const OrbitCamera&) const = default;

  // Turns by a mouse movement, in parts of the image's height.
  void turn(double right, double down);
  // Moves the centre by a mouse movement, in parts of the image's height at its distance.
  void shift(double right, double down);
  // Moves the centre along the boresight, to the right and up, in parts of the range.
  void fly(double ahead, double right, double up);
  // Multiplies the range.
  void zoom(double factor);
  // Fits the sphere into the image, from above its ground. aspect: height over width
  void frame_all(const workspace::BoundingSphere& sphere, double aspect);
};

}  // namespace panwright::studio
