// The parts of fit(). Private to materials.
#pragma once

#include <array>
#include <functional>

#include "materials/material.h"

namespace panwright::materials {

// Facets whose lost light is less than this part of what falls on them are left as they are.
inline constexpr double kWorthCompensation = 0.01;

// fits.loss and fits.many_scale of beckmann and ggx where compensation asks for them; fits.error
// where it is larger than what stands there.
void fit_facets(Material& material);

// fits.coat_return. Needs what fit_hapke() gives.
void fit_coat(Material& material);

// 2∫ loss μ dμ of coefficients as facet_loss (materials/formulas/facets.glsl) takes them.
double mean_loss(const std::array<double, 8>& coefficients);

// ∫ f(μ) dμ from 0 to 1, of functions that are smooth in √μ.
Vec3 mean_over_cosines(const std::function<Vec3(double)>& f);

// The albedo of the diffuse law under an even sky, by itself: weight 1, no coat. RGB.
Vec3 mean_diffuse_albedo(const Material& material);

// material.fits.hapke_h and, where it is larger than what stands there, fits.error.
void fit_hapke(Material& material);

}  // namespace panwright::materials
