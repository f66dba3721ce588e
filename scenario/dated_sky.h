// The Earth, the Moon and the Sun about the origin of a world, by its date and orbit.
//
// Sources: those of ephemeris/analytic.h; Bate, Mueller and White, Fundamentals of Astrodynamics, 2
// (elements of an orbit).
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "base/math.h"
#include "scenario/formulas.h"
#include "scenario/time.h"

namespace panwright::scenario {

enum class Centre : std::uint8_t { earth, moon };

// Gravitational parameter, m³/s² (DE430), and the least radius of a body, metres.
double gravity_of(Centre centre);
double least_radius(Centre centre);

// Axes of a world.
enum class WorldAxes : std::uint8_t {
  j2000,  // of the ICRF, those of J2000 within 0.02″
  rtn,  // x away from the orbit's centre, y along the motion, z along the orbit's normal: those of
        // clohessy_wiltshire()
};

// Elements of an orbit: angles in radians.
struct OrbitElements {
  double semi_major = 0;    // metres; below 0 for hyperbolas
  double eccentricity = 0;  // not 1
  double inclination = 0;
  double node = 0;       // right ascension of the ascending node
  double periapsis = 0;  // argument
  double true_anomaly = 0;
};

// State in axes of J2000. Nothing for elements of no orbit: a·(1 − e²) <= 0, or a true anomaly
// beyond the asymptotes.
std::optional<OrbitState> state_of(const OrbitElements& elements, double mu);

// Place of the origin of a world.
struct Orbit {
  Centre about = Centre::earth;
  bool at_centre = false;      // the origin is that centre, at rest; `start` has no meaning
  OrbitState start;            // about the centre, axes of J2000
  std::optional<Epoch> epoch;  // of the start; none: the date that is asked for
  WorldAxes axes = WorldAxes::j2000;
};

struct DatedBody {
  Vec3 centre{0};                    // metres from the origin, world axes
  Quat world_from_body{1, 0, 0, 0};  // unit; z to the north pole, x to longitude 0
};

struct DatedSky {
  DatedBody earth, moon;
  Vec3 sun_direction{0, 0, 1};  // unit, world axes; turned by the aberration of the origin's motion
  double sun_distance = 1;      // AU
  Vec3 velocity{0};             // of the origin about the Sun, m/s, axes of the ICRF
  Quat world_from_icrf{1, 0, 0, 0};
};

// Motion of the Earth about the Sun, m/s in axes of the ICRF: within 15 m/s of that from the
// barycentre of the solar system.
Vec3 earth_velocity(const Epoch& date);

// Returns the bodies about the origin of a world at a date. The orbit is that of two bodies: the
// Earth's flattening turns low orbits by up to 8° a day from the epoch on.
//
// Error: Sun 30″ and 2e-4, Moon 35 km, the Earth's rotation 13.5″ (UTC in place of UT1), the Moon's
// 0.005°; places of the Earth and Moon without light time and aberration (5″ from a low orbit).
// Nothing where the orbit has no state, and outside 1800 to 2050.
std::optional<DatedSky> dated_sky(const Orbit& orbit, const Epoch& date);

}  // namespace panwright::scenario
