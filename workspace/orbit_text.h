// Orbits of a world's origin, from settings (docs/sky-by-date.md).
#pragma once

#include <string>
#include <string_view>

#include "scenario/dated_sky.h"

namespace panwright::workspace {

// Reads "earth" or "moon" (the origin is that centre), elements ("a=6778km e=0 i=51.6 raan=30 aop=0
// nu=90") or a state ("r=X Y Z v=VX VY VZ"), then if need be about=, epoch= and axes=. Bare numbers
// are metres, metres per second and degrees.
//
// Returns what is expected instead; empty: it is read.
std::string read_orbit(std::string_view text, scenario::Orbit& out);

// Returns an orbit with an epoch, where it has none and needs one, and with axes, where it has
// none.
std::string completed_orbit(std::string_view text, const scenario::Epoch& epoch,
                            std::string_view axes);

}  // namespace panwright::workspace
