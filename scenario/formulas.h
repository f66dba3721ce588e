// Sources without files: fixed members, relative and two-body orbits, even spins, hold points.
//
// Sources: Clohessy and Wiltshire 1960; Bate, Mueller and White, Fundamentals of Astrodynamics, 4
// (universal variables).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "scenario/source.h"

namespace panwright::scenario {

inline constexpr double kEarthGravity = 3.986004418e14;  // m³/s²

struct OrbitState {
  Vec3 position{0};  // metres
  Vec3 velocity{0};  // m/s
};

// Returns the motion beside a circular orbit, in its rotating frame: x away from the centre, y
// along the motion, z along the orbit's normal. Linear: the error grows with the square of the
// distance (2.8 cm in an orbit at 100 m, 278 m at 10 km, in low orbits of the Earth).
//
//   rate     of the orbit, rad/s, > 0
//   seconds  after the start, of either sign
OrbitState clohessy_wiltshire(const OrbitState& start, double rate, double seconds);

// Returns the motion about a centre: ellipses, parabolas, hyperbolas and straight lines, which turn
// back at the centre. Nothing at the centre, or where the start is there.
//
//   mu  m³/s², > 0
std::optional<OrbitState> two_body(const OrbitState& start, double mu, double seconds);

// The members that a frame has, at all times. Its name, seed and time are left out.
SourcePtr fixed_source(std::string name, const Frame& frame);

// Name of the axes of clohessy_wiltshire(), as CCSDS has it.
inline constexpr std::string_view kRtnFrame = "RTN";

// Position of a target (empty: of the camera) that starts at time 0, at all times; axes kRtnFrame.
SourcePtr clohessy_wiltshire_source(const std::string& target, const OrbitState& start,
                                    double rate);
// With kEarthGravity its centre is the Earth. where: of the formula, for diagnostics.
// Fails: E8003 for a straight line, and for a start that is no state of an orbit.
Result<SourcePtr> two_body_source(const std::string& target, const OrbitState& start, double mu,
                                  const TimeSpan& span, SourceSpan where, DiagnosticLog& log);

// Rotation that turns evenly, at all times.
//
//   start  unit, world_from_model (world_from_camera) at time 0
//   rate   rad/s, in the axes of the model or camera
SourcePtr spin_source(const std::string& target, const Quat& start, const Vec3& rate);

// Stay at a point.
struct HoldPoint {
  double arrive = 0;  // seconds
  double leave = 0;   // >= arrive
  Vec3 position{0};   // metres
};

// Position that stays at points and moves on straight lines between them, with speed and
// acceleration 0 at both ends (a polynomial of degree 5). Its own frames are at arrivals and
// departures.
//
// Fails: E8004 where times do not ascend, or no point is given; E8001 for numbers that are not
// finite.
Result<SourcePtr> hold_point_source(const std::string& target, std::vector<HoldPoint> points,
                                    DiagnosticLog& log);

}  // namespace panwright::scenario
