// Stars as plain data: a catalogue, and what of it stands in a world.
//
// Directions are in the axes of the ICRS, which are those of J2000 within 0.02 arcsec.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/math.h"

namespace panwright::light {

struct Star {
  Vec3 direction{0, 0, 1};  // unit, at the catalogue's epoch
  Vec3 motion{0};           // across the direction, radians a Julian year
  double v = 0;             // magnitude, Johnson V
  double b_v = 0;           // colour B − V, magnitudes; NaN: unknown
  std::uint32_t hip = 0;    // number in the Hipparcos catalogue; 0: none
  std::string name;         // empty: none
};

struct StarCatalogue {
  double epoch = 2000;      // Julian year of the directions
  std::vector<Star> stars;  // from the brightest to the faintest
};

// Stars behind a world, as its observer has them at a time.
struct Stars {
  std::shared_ptr<const StarCatalogue> catalogue;  // null: none
  double faintest = 8;                             // V; fainter stars are left out
  double year = 2000;                              // Julian year: directions move from the epoch's
  Vec3 velocity{0};                  // of the observer from the solar system's barycentre, ICRS
                                     // axes, m/s, below the speed of light
  Quat world_from_icrs{1, 0, 0, 0};  // unit
  bool operator==(const Stars&) const = default;
};

}  // namespace panwright::light
