// Light of the bodies at a point: of all of their visible parts, or as a few distant lights.
#pragma once

#include <cstddef>
#include <vector>

#include "base/math.h"
#include "light/ground_shine.h"
#include "materials/incidence.h"
#include "sky/sky.h"

namespace panwright::sky {

// Grid of directions over the disc of a body, of equal solid angles from the nearest place on.
struct CapGrid {
  int rings = 96;
  int sectors = 192;
};

// Returns the irradiance per band that a plate gets of all bodies, unoccluded.
//
//   normal   unit
// Error: 5e-4 of the largest over all tilts with the default grid. Cost: O(bodies·rings·sectors).
Vec3 irradiance(const Sky& sky, const Vec3& point, const Vec3& normal, const CapGrid& grid = {});

// Returns lights in the place of the bodies' sunlit discs, from the strongest: distant discs of
// their directions, irradiances and sizes, as a light of materials::Incidence. Their irradiances
// are exact on plates that see a whole cell. Bodies smaller than a degree are one light each.
// The same point makes the same lights; no body in view: none.
//
//   count   upper bound, at least 1
//   ground  terrain, whose light is among them and which hides bodies; null: none
// Error: worst and rms irradiance of plates over all tilts, in parts of the largest (docs/sky.md).
// Cost: 4,608 radiances for each body.
std::vector<materials::Incidence> planet_lights(const Sky& sky, const Vec3& point,
                                                std::size_t count,
                                                const light::GroundShine* ground = nullptr);

}  // namespace panwright::sky
