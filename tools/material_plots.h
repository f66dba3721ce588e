// Plots of a material as SVG. The same bytes for the same material.
#pragma once

#include <string>
#include <vector>

#include "materials/material.h"
#include "materials/measured.h"
#include "materials/report.h"

namespace panwright::tools {

// Plots the directional albedo over the angle from the normal, one curve for each channel.
std::string albedo_plot(const materials::Material& material);

// Plots the reflectance π f in the plane of incidence over the viewing angle, −90° to 90°,
// logarithmic, for light from 0°, 30°, 60° and 80°; mean of the channels, under the Sun's disc.
std::string slices_plot(const materials::Material& material);

// Plots readings in the plane of incidence as dots, and a BRDF fitted to them as lines, over the
// viewing angle; one colour for each of up to four angles of the light. Logarithmic.
//
//   name  of the sample
//   band  0 red, 1 green, 2 blue; -1: readings without colour
std::string fit_plot(const std::vector<materials::Reading>& readings, const materials::Fit& fit,
                     const std::string& name, int band);

}  // namespace panwright::tools
