// Measured reflectance, and BRDFs fitted to it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/math.h"
#include "base/result.h"
#include "materials/material.h"

namespace panwright::materials {

// One reading: directions are unit vectors about the normal +z, away from the surface.
struct Reading {
  Vec3 to_light{0};
  Vec3 to_viewer{0};
  double reflectance = 0;  // 1/sr, one band, or the mean of three
  Vec3 rgb{0};             // 1/sr, the bands; all equal for a single one
};

// Reads a table of measured reflectance: text with five numbers a line, separated by spaces, tabs,
// commas or semicolons: zenith angle and azimuth of the light, zenith angle and azimuth of the
// viewer, in degrees, and the reflectance in 1/sr; or seven, with the reflectance in red, green and
// blue. Zenith angles may be negative: the other side. Lines that begin with # or a letter are
// skipped. Any order; the same number of columns in all lines.
//
// This is the layout of the tables of G. Fankhauser, J. A. Tyson, J. Askari, "Satellite optical
// brightness", 2023.
//
// Fails: E0101, E0102; E1409 at the first invalid line of each kind, with the number of similar
// ones; also for fewer than 8 readings of light and viewer above the horizon.
Result<std::vector<Reading>> read_measured(const std::filesystem::path& path, DiagnosticLog& log);

// Returns true if any reading differs between the bands.
bool has_color(const std::vector<Reading>& readings);

// BRDF with the parameters that fit readings best.
struct Fit {
  std::string brdf;        // in words
  std::string text;        // its fields as pxn
  Material material;       // fitted; equal channels unless the readings have colour
  double rms_decades = 0;  // root of the mean square of log10(BRDF/reading)
  double max_decades = 0;  // the largest of them
  double rms = 0;          // root of the mean square of BRDF − reading, 1/sr
};

// Fits each BRDF that a single band can determine: Lambert, EON, and microfacets and lacquers over
// them. For readings with colour the mean decides slopes, roughness and index, and each band its
// diffuse and specular shares. Logarithms are compared, so that the glint does not dominate;
// readings are raised to `floor`, the noise of instruments.
//
//   returns  the best first
//
// Deterministic: simplices of J. A. Nelder, R. Mead, "A simplex method for function minimization",
// 1965, from several starts. Larger tables are fitted by kMostSearched readings spread over the
// table; the residuals are of all. Cost: a few seconds for a thousand readings on one core, a
// minute for kMostSearched and more.
inline constexpr std::size_t kMostSearched = 10'000;
std::vector<Fit> fitted_brdfs(const std::vector<Reading>& readings, double floor = 1e-3,
                              const Job& job = {});

}  // namespace panwright::materials
