// Photometric laws: the light that a rough surface of a planet or moon returns.
//
// The radiance factor is I/F = π·L/E, with E the Sun's irradiance on a plane that faces it. mu0 and
// mu are the cosines of incidence and emission, phase the angle between Sun and viewer, radians.
#pragma once

#include <cstdint>

#include "base/math.h"

namespace panwright::light {

enum class Law : std::uint8_t {
  lambert,          // mu0
  lommel_seeliger,  // 2·mu0/(mu0 + mu)
  lunar_lambert,    // their mixture, by phase (McEwen 1996)
  hapke,            // isotropic multiple scattering and an opposition surge (Hapke 1993, 8.89)
};

struct Photometry {
  Law law = Law::lambert;
  // The whole disc has the Moon's brightness at every phase (ROLO: Kieffer, Stone 2005), without
  // librations; 1.55 to 97 degrees, continued by its formula to 150, constant beyond.
  bool rolo = false;
  // of Hapke's law
  double single_scattering = 0.25;  // 0 to 1
  double asymmetry = -0.3;          // of Henyey and Greenstein, −1 to 1; < 0: backwards
  double surge = 1;                 // amplitude at phase 0
  double surge_width = 0.05;        // > 0
  bool operator==(const Photometry&) const = default;
};

// Returns I/F for an albedo of 1, without `rolo`. 0 where mu0 or mu is.
double radiance_factor(const Photometry& law, double mu0, double mu, double phase);

// Returns the mean I/F of the disc of a sphere, seen from afar. Hapke's law by quadrature.
double disc_reflectance(const Photometry& law, double phase);

// Returns the Moon's mean I/F by phase, for bands at 665, 554 and 487 nm.
Vec3 rolo_reflectance(double phase);

// Returns the factors that make a disc's reflectance the Moon's; 1 without `rolo`.
Vec3 phase_factor(const Photometry& law, double phase);

}  // namespace panwright::light
