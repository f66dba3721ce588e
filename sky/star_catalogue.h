// Catalogues of stars, as text.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "base/diagnostic.h"
#include "base/result.h"
#include "light/stars.h"

namespace panwright::sky {

using light::Star;
using light::StarCatalogue;

// The stars of the Hipparcos catalogue (ESA 1997, I/239) with V below 8: 41,057, to 1 mas at
// 1991.25. Parsed at the first call, some 20 ms.
std::shared_ptr<const StarCatalogue> hipparcos_stars();

// Reads a catalogue as text: a line of column names, then a line of numbers with commas for each
// star. Columns: ra[deg], dec[deg], v[mag]; and as known pm_ra[mas/yr] (times cos dec),
// pm_dec[mas/yr], b_v[mag], hip, name. Others are ignored. `# epoch 2016` before them gives the
// Julian year (default 2000); other lines that begin with # are comments.
//
//   name  of the text in diagnostics
//
// Reports: W5041 for lines left out, those of another number of columns too, each of the first ten
// at its place. Fails: E5040 without the three columns, a star, or a year.
Result<StarCatalogue> parse_stars(std::string text, std::string name, DiagnosticLog& log);

// The same of a file. Fails: also E0101, E0102; E0104 beyond 1 GB.
Result<StarCatalogue> read_stars(const std::filesystem::path& path, DiagnosticLog& log);

}  // namespace panwright::sky
