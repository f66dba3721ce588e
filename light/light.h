// Lights as plain data, and the light that each gives a point.
//
// Positions and directions are in one frame, that of the caller: world axes in a world.
#pragma once

#include <optional>
#include <variant>

#include "base/math.h"
#include "base/stamp.h"
#include "materials/incidence.h"

namespace panwright::light {

using materials::Incidence;

// Sine of the Sun's angular radius at 1 AU: the nominal solar radius (IAU 2015 B3) over the
// astronomical unit (IAU 2012 B2).
inline constexpr double kSunSineAtOneAu = 695700e3 / 149597870700.0;

// Irradiance of the Sun at 1 AU, W/m², in bands 100 nm wide about 650, 550 and 450 nm: 40 nm means
// of ASTM E490-00a times the width.
inline constexpr Vec3 kSolarIrradiance(158.6, 186.2, 191.4);

// The Sun, at infinity: the same direction and irradiance everywhere.
struct Sun {
  Vec3 direction{0, 0, 1};         // from the origin to the Sun, any non-zero length
  double distance = 1;             // AU, > 0; sets the disc's angular size, not the irradiance
  std::optional<Vec3> irradiance;  // W/m² per band on a plane that faces it; none: 1, radiance in
                                   // 1/sr
  double limb_darkening = 0;       // u of I = 1 − u·(1 − μ), 0 to 1
  bool operator==(const Sun&) const = default;
};

// Lamp of one side: intensity·cos(angle to the axis)^exponent up to a half-angle, 0 beyond.
struct Spot {
  Vec3 position{0};             // metres
  Vec3 axis{0, 0, 1};           // any non-zero length
  Vec3 intensity{1};            // on the axis, W/sr per band
  double half_angle = kPi / 6;  // radians, above 0 to π
  double exponent = 0;          // >= 0; above 0 only directions up to π/2 are lit; 1: a LED
  double radius = 0;            // of its disc, metres; 0: a point
  bool operator==(const Spot&) const = default;
};

// Lamp of all directions: a sphere of even radiance.
struct Point {
  Vec3 position{0};   // metres
  Vec3 intensity{1};  // W/sr per band
  double radius = 0;  // metres; 0: a point
  bool operator==(const Point&) const = default;
};

// Lamp of one side: a flat disc of even radiance, intensity/(π·radius²).
struct Disc {
  Vec3 position{0};     // metres
  Vec3 axis{0, 0, 1};   // out of the side that shines, any non-zero length
  Vec3 intensity{1};    // on the axis far away, W/sr per band
  double radius = 0.1;  // metres, > 0
  bool operator==(const Disc&) const = default;
};

using Source = std::variant<Sun, Spot, Point, Disc>;

// Returns whether all numbers are finite and within the limits above; radiant quantities >= 0.
[[nodiscard]] bool is_sound(const Source& source);

// Returns the light that a source gives an unoccluded point. The irradiance of a point and a spot
// is intensity/distance²; that of a disc is intensity·cos/(distance² + radius²), exact on its axis
// for a parallel plane. Within a source it is that on its surface; at the place of one without a
// size it is 0. Expects: is_sound(). Cost: O(1).
[[nodiscard]] Incidence incidence(const Source& source, const Vec3& point);

// A source with a stamp, the key of what is derived from it.
class Light {
 public:
  Light() = default;  // the Sun as it is by default
  explicit Light(const Source& source) : source_(source), stamp_(next_stamp()) {}

  const Source& source() const { return source_; }
  Stamp stamp() const { return stamp_; }
  // Setting an equal source changes no stamp. Returns whether it changed. Expects: is_sound().
  bool set(const Source& source);

 private:
  Source source_;
  Stamp stamp_ = kFirstStamp;
};

}  // namespace panwright::light
