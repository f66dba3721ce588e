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
  Vec3 rgb{0};             // 1/sr, the bands; all the same where there is one
};

// Reads a table of measured reflectance: text with five numbers a line, parted by spaces, tabs,
// commas or semicolons: zenith angle and azimuth of the light, zenith angle and azimuth of the
// viewer, in degrees, and the reflectance in 1/sr; or seven, with the reflectance in red, green and
// blue. Zenith angles may be negative: the other side. Lines that begin with # or with a letter are
// not read. In any order, all lines with as many numbers.
//
// This is the layout of the tables that G. Fankhauser, J. A. Tyson, J. Askari published with
// "Satellite optical brightness", 2023.
//
// Fails: E0101, E0102; E1409 at the first invalid line of each kind, with the number of those like
// it, and for fewer than 8 readings of light and viewer above the horizon.
Result<std::vector<Reading>> read_measured(const std::filesystem::path& path, DiagnosticLog& log);

// Whether any reading differs between the bands.
bool has_color(const std::vector<Reading>& readings);

// A BRDF with the parameters that fit readings best.
struct Fit {
  std::string brdf;        // in words
  std::string text;        // its fields as pxn
  Material material;       // fitted; the same in all channels but for readings with colour
  double rms_decades = 0;  // root of the mean square of log10(BRDF/reading)
  double max_decades = 0;  // the largest of them
  double rms = 0;          // root of the mean square of BRDF − reading, 1/sr
};

// Fits each BRDF that a single band can determine: Lambert, EON, and microfacets and lacquers
// over them. Of readings with colour the mean decides slopes, roughness and index, and each band
// then how much of it is diffuse and how much of microfacets. Logarithms are compared, so that the
// glint does not outweigh everything else; readings below `floor` count as that much, where
// instruments see their own noise.
//
//   returns  the best first
//
// Deterministic: simplices of J. A. Nelder, R. Mead, "A simplex method for function minimization",
// 1965, from several starts. Of tables of more, kMostSearched readings spread over the table
// decide; the residuals are of all. Cost: a few seconds for a thousand readings on one core, a
// minute for kMostSearched and more.
inline constexpr std::size_t kMostSearched = 10'000;
std::vector<Fit> fitted_brdfs(const std::vector<Reading>& readings, double floor = 1e-3,
                              const Job& job = {});

}  // namespace panwright::materials
