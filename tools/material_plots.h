// Plots of a material as SVG. The same bytes for the same material.
#pragma once

#include <string>

#include "materials/certificate.h"
#include "materials/material.h"

namespace panwright::tools {

// Directional albedo over the angle from the normal, one curve for each channel.
std::string albedo_plot(const materials::Material& material);

// Reflectance π f in the plane of incidence over the viewing angle, −90° to 90°, logarithmic, for
// light from 0°, 30°, 60° and 80°; mean of the channels, under the Sun's disc.
std::string slices_plot(const materials::Material& material);

}  // namespace panwright::tools
