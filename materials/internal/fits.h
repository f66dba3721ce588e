// The parts of fit(). Private to materials.
#pragma once

#include <array>
#include <functional>

#include "materials/material.h"

namespace panwright::materials {

// Microfacets that lose less than this share of the light are not compensated.
inline constexpr double kWorthCompensation = 0.01;

// fits.albedo_deficit and fits.compensation_scale of beckmann and ggx where compensation asks for
// them; fits.error where it grows.
void fit_microfacets(Material& material);

// fits.coat_return, and for a rough coat fits.albedo_deficit unless fit_microfacets() filled it.
// Needs what fit_hapke() and fit_microfacets() give.
void fit_coat(Material& material);

// 2∫ f loss μ dμ of a fitted material, f what its smooth coat passes: see microfacet_albedo_deficit
// in materials/formulas/microfacets.glsl.
double mean_albedo_deficit(const Material& material);

// What the outer surface of a rough coat reflects of light from a direction, and what comes out
// again of the light that microfacets below it reflect, once. nodes: see microfacet_albedo().
//
// Expects: to_viewer above the horizon; the coat rough; the material one of microfacets, without
// tint
double coat_peak_albedo(const Coat& coat, const Vec3& to_viewer, int nodes);
double coated_microfacets_albedo(const Material& material, const Vec3& to_viewer, int nodes);

// ∫ f(μ) dμ from 0 to 1, of functions that are smooth in √μ.
Vec3 mean_over_cosines(const std::function<Vec3(double)>& f);

// The albedo of the diffuse BRDF under an even sky, by itself: weight 1, no coat. RGB.
Vec3 mean_diffuse_albedo(const Material& material);

// material.fits.hapke_h and, where it grows, fits.error.
void fit_hapke(Material& material);

}  // namespace panwright::materials
