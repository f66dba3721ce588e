// Optical constants of metals and films over the solar spectrum.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "base/math.h"
#include "materials/material.h"

namespace panwright::materials {

// Wavelengths of the channels, µm.
inline constexpr std::array<double, 3> kBands_um{0.65, 0.55, 0.45};

// Complex index n + ik for the bands about 650, 550 and 450 nm.
struct Conductor {
  Vec3 n{1};
  Vec3 k{0};
};

// Returns optical constants by chemical symbol or name, as "Al"; nothing for an unknown one. Opaque
// thickness; values of one published set (internal/optical_tables.h). Others differ by 1 to 2 % in
// reflectance, gold at 550 nm by 6 %.
std::optional<Conductor> metal(std::string_view name);

// Returns the names of metal(), in alphabetical order.
std::span<const std::string_view> metal_names();

// The same for a clear film: "Kapton", "MgF2" or "SiO2", interpolated linearly between wavelengths.
// For absorption in a coat use coat_of_film(name, thickness).
std::optional<Conductor> film(std::string_view name);

// Returns the names of film(), in alphabetical order.
std::span<const std::string_view> film_names();

// Returns a film as a coat with a plane outer face: its index at 550 nm, and its absorption per
// channel.
//
//   thickness  metres
Coat coat_of_film(const Conductor& film, double thickness);

// Returns a film of film_names() as a coat of its true colour. Samples at three wavelengths would
// turn amber to lemon, as an absorption edge lies between the bands (Kapton's at 500 nm). Sunlight
// that passes the film twice at normal incidence is converted by the CIE 1931 observer to linear
// sRGB, the Sun being white. It keeps the chromaticity and luminance of the spectrum within sRGB's
// gamut; other channels are clamped to 0..1. No absorption for k = 0.
//
//   thickness  metres
//   returns    none for an unknown name
std::optional<Coat> coat_of_film(std::string_view name, double thickness);

// Optical constants n and k, one for each of wavelengths_um().
struct OpticalConstants {
  std::string_view what;
  std::span<const double> n;
  std::span<const double> k;
};
std::span<const double> wavelengths_um();  // 0.3 to 2.5

// Returns constants by the names of metal(), and the films "Kapton", "MgF2" and "SiO2".
std::optional<OpticalConstants> optical_constants(std::string_view name);

// Opaque body, bare or under a film that is thick compared to the wavelength: a second-surface
// mirror, an absorbing film over metal.
struct Stack {
  OpticalConstants body;
  std::optional<OpticalConstants> film;
  double thickness = 0;  // of the film, metres
};

// Returns the reflectance of unpolarised light in vacuum; reflections in the film are added
// incoherently, R1 + (1 − R1)² T² R2/(1 − R1 R2 T²).
//
//   wavelength  into wavelengths_um()
//   cosine      of the angle of incidence, 0..1
double reflectance(const Stack& stack, std::size_t wavelength, double cosine);

// Returns 1 − the reflectance weighted with the Sun's irradiance outside the atmosphere from 0.3 to
// 2.5 µm (ASTM E490-00a; 4.4 % of it lie outside). Cost: 45 reflectances.
double solar_absorptance(const Stack& stack, double cosine);

// The same under diffuse light, with directions weighted by their cosine. Within 2e-5 of the
// integral.
double hemispherical_solar_absorptance(const Stack& stack);

}  // namespace panwright::materials
