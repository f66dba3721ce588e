// Parts of fit(). Private to materials.
#pragma once

#include <array>
#include <functional>

#include "materials/material.h"

namespace panwright::materials {

// Microfacets that lose less than this share of the light are not compensated.
inline constexpr double kWorthCompensation = 0.01;

// Fits fits.albedo_deficit and fits.compensation_scale of beckmann and ggx if compensation requires
// them, and raises fits.error.
void fit_microfacets(Material& material);

// Fits fits.coat_return, and for a rough coat fits.albedo_deficit unless fit_microfacets() did.
// Needs the results of fit_hapke() and fit_microfacets().
void fit_coat(Material& material);

// Returns 2∫ f loss μ dμ of a fitted material, f the transmittance of its smooth coat: see
// microfacet_albedo_deficit in materials/formulas/microfacets.glsl.
double mean_albedo_deficit(const Material& material);

// Returns the reflectance of a rough coat's outer surface, plus the light transmitted after one
// reflection by the microfacets below. nodes: see microfacet_albedo().
//
// Expects: to_viewer above the horizon; the coat rough; the material one of microfacets, without
// tint
double coat_peak_albedo(const Coat& coat, const Vec3& to_viewer, int nodes);
double coated_microfacets_albedo(const Material& material, const Vec3& to_viewer, int nodes);

// Returns ∫ f(μ) dμ from 0 to 1, of functions that are smooth in √μ.
Vec3 mean_over_cosines(const std::function<Vec3(double)>& f);

// Returns the albedo of the diffuse BRDF alone under a uniform sky: weight 1, no coat. RGB.
Vec3 mean_diffuse_albedo(const Material& material);

// Fits material.fits.hapke_h, and raises fits.error.
void fit_hapke(Material& material);

}  // namespace panwright::materials
