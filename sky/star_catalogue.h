// Catalogues of stars: positions, motions and magnitudes.
//
// Directions are in the axes of the ICRS, which are those of J2000 within 0.02 arcsec.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"
#include "base/result.h"

namespace panwright::sky {

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

// The stars of the Hipparcos catalogue (ESA 1997, I/239) with V below 8: 41,057, to 1 mas at
// 1991.25. Parsed at the first call, some 20 ms.
const StarCatalogue& hipparcos_stars();

// Reads a catalogue as text: lines of numbers with commas below a line of their names
// `ra[deg],dec[deg],v[mag]`, in any order, with pm_ra[mas/yr] (times cos dec), pm_dec[mas/yr],
// b_v[mag], hip and name as they are known. `# epoch 2016` before it gives the Julian year
// (default 2000). Other lines that begin with # are comments; other columns are ignored.
//
//   name  of the text in diagnostics
//
// Reports: W5020 for lines left out, each of the first ten at its place. Fails: E5019 without the
// three columns, a star, or a year.
Result<StarCatalogue> parse_stars(std::string text, std::string name, DiagnosticLog& log);

// The same of a file. Fails: also E0101, E0102; E0104 beyond 1 GB.
Result<StarCatalogue> read_stars(const std::filesystem::path& path, DiagnosticLog& log);

}  // namespace panwright::sky
