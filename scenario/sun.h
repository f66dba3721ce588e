// The Sun as seen from the Earth, by date alone.
#pragma once

#include "scenario/source.h"

namespace panwright::scenario {

// Direction and distance of the Sun from the Earth's centre, in axes of J2000, without aberration:
// within 30″ and 2e-4 from 1800 to 2050, to which it is bounded. On an orbit of the Moon's radius
// the direction differs by up to 0.15°.
//
//   epoch  of time 0, written in a system
SourcePtr sun_source(const Epoch& epoch, TimeSystem system);

}  // namespace panwright::scenario
