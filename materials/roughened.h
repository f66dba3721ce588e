// Materials of surfaces seen from so far that their relief is part of the material.
#pragma once

#include "materials/material.h"

namespace panwright::materials {

// The material of a surface that was bumpy, with facets of this material, and is flat now: what its
// bumps did to the light is in its roughness.
//
// Slopes of Gaussian bumps and those of microfacets add as variances do: α² becomes α² + 2σ² along
// each axis (Olano and Baker, "LEAN mapping", 2010), of blinn_phong, cook_torrance and coats with
// the mean of both axes. ggx becomes beckmann where the bumps have the larger part; so does mirror.
// Lambert's surface becomes Oren and Nayar's, whose facets have the bumps' slopes; the variances
// are added where it has some, to the roughness angle of hapke too. Lommel and Seeliger's surface
// and corner cubes stay. Axes that differ by less than a tenth are taken as equal. Light that
// bumps hide from or send to each other is known to the BRDF only as its own masking.
//
//   variance  of the lost slopes along u and v, ≥ 0; 0: returns the material as it is
Material roughened(const Material& material, const Vec2& variance);

}  // namespace panwright::materials
