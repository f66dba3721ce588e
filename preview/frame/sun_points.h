// Points of the Sun's disc that cast hard shadows. Private to preview; nothing here needs OpenGL.
#pragma once

#include <cstddef>
#include <vector>

#include "base/math.h"
#include "preview/gl/uniforms.h"

namespace panwright::preview {

// Disc of a Sun for shadows.
struct SunDisc {
  double tangent = 0;         // of its angular radius; 0: a point
  double limb_darkening = 0;  // u of I = 1 − u·(1 − μ), 0 to 1
  unsigned points = 1;        // upper bound of its point samples
  unsigned most = 1;          // the same in an eclipse: the penumbra is wider than what it falls on
  bool always = false;        // even for penumbrae narrower than half a pixel
  bool limited = false;  // time is: at most kFewSunPoints, except in an eclipse and in imposters
  bool operator==(const SunDisc&) const = default;
};

// Finds places on the disc, in tangents of angles from its centre, of equal light: a Vogel spiral
// whose radii are the quantiles of the disc's light. One point: the centre. Every fourth point is a
// part of the disc about its centre.
//
// Error of the disc's share beyond a straight edge, over all edges of the penumbra: 16 points 0.037
// rms and 0.14 at most; 64: 0.0125 and 0.05.
void find_sun_points(const SunDisc& disc, unsigned points, std::vector<Vec2>& places);

// Returns the rms error of the disc's light beyond a straight edge for a number of points, over all
// places in the penumbra and directions. 1: 0, for hard shadows.
double error_of_sun_points(unsigned points);

// Returns the fewest points within an error, in steps of eight.
unsigned sun_points_for(double error);

// Returns the share of the disc's light within a share of its radius, 0 to 1.
double light_within(double radius, double limb_darkening);

inline constexpr unsigned kFewSunPoints = 8;  // more have coarser maps

// Smallest visible width of a penumbra, pixels.
inline constexpr double kShownPenumbra = 0.5;
// With a limit of time, half of kFewSunPoints up to this width, pixels.
inline constexpr double kWidePenumbra = 16;

}  // namespace panwright::preview
