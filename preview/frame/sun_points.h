// The Sun's disc as points that cast hard shadows. Private to preview; nothing here needs OpenGL.
#pragma once

#include <cstddef>
#include <vector>

#include "base/math.h"

namespace panwright::preview {

// The disc of a Sun for shadows.
struct SunDisc {
  double tangent = 0;         // of its angular radius; 0: a point
  double limb_darkening = 0;  // u of I = 1 − u·(1 − μ), 0 to 1
  unsigned points = 1;        // that stand for it, at most
  bool always = false;        // also where its penumbra is narrower than half a pixel
  bool operator==(const SunDisc&) const = default;
};

// Places on the disc, in tangents of angles from its centre, each worth the same light: a Vogel
// spiral whose radii are the quantiles of the disc's light. One point: the centre.
//
// The share of the disc that a straight edge leaves is off by what light.md 1.1 gives: 16 points
// 0.037 rms and 0.14 at most, over all edges of the penumbra; 64: 0.0125 and 0.05.
void find_sun_points(const SunDisc& disc, unsigned points, std::vector<Vec2>& places);

// Of so many points: what a straight edge leaves of the disc's light is off by this, rms over all
// places in the penumbra and all directions of the edge. 1: 0, as nothing is said of penumbrae.
double error_of_sun_points(unsigned points);

// As many points as leave an error no larger than that, by the eight.
unsigned sun_points_for(double error);

// The share of the disc's light from within a share of its radius, 0 to 1.
double light_within(double radius, double limb_darkening);

inline constexpr std::size_t kMostSunPoints = 256;  // shadow.glsl

// Whether so wide a penumbra shows (physics 2.4), pixels.
inline constexpr double kShownPenumbra = 0.5;

}  // namespace panwright::preview
