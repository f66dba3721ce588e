// The parts of fit(). Private to materials.
#pragma once

#include "materials/material.h"

namespace panwright::materials {

// material.fits.hapke_h and, where it is larger than what stands there, fits.error.
void fit_hapke(Material& material);

}  // namespace panwright::materials
