// Recipes of sheets with statistics that are asked for.
#pragma once

#include <cstdint>
#include <optional>

#include "base/job.h"
#include "base/result.h"
#include "mli/recipe.h"

namespace panwright::mli {

// What sheets shall have; at least one of them.
struct FitTarget {
  std::optional<double> slope_rms = std::nullopt;    // both axes together
  std::optional<double> correlation = std::nullopt;  // metres, mean of both axes
  std::optional<double> height_rms = std::nullopt;   // metres, about the mean
};

// A statistic over sheets of different seeds.
struct Spread {
  double mean = 0;
  double deviation = 0;  // of single sheets
  // of the mean, one standard deviation
  double error(std::uint32_t sheets) const;
};

struct FitStatistics {
  std::uint32_t first_seed = 0, sheets = 0;  // seeds first_seed, first_seed + 1, …, modulo 2^32
  Spread slope_rms, correlation, height_rms;
};

struct Fit {
  Recipe recipe;          // numbers of four significant digits, but for the asked slope
  double scale = 1;       // of the sizes of what it began with, heights too
  double wrinkles = 1;    // that the amplitudes of `wrinkle` were multiplied by beyond that
  FitStatistics fitted;   // of the sheets that it was found with
  FitStatistics checked;  // of as many others
};

struct FitOptions {
  // The sheet stays as large as it is. Else it is scaled with its wrinkles.
  bool keep_size = false;
  std::uint32_t sheets =
      0;  // to measure; 0: 64, fewer of sheets of over 300,000 vertices, 8 at least
};

// The recipe with every length multiplied by `scale`: cells, sizes along the sheet and heights.
// Slopes stay. keep_size: the sheet's sides and the places of its seams stay as they are.
Recipe scaled(const Recipe& recipe, double scale, bool keep_size);

// A recipe of the kind of `start` whose mean statistics over seeds are as asked.
//
// Sizes are scaled until the correlation length, or else the rms height, is right; a slope_rms at
// the end sets the slope. Where both length and height are asked, the share of `wrinkle` decides:
// an amplitude from 1/16 to 16 times the start's. Each is right within 0.5 % over the sheets that
// were measured; `checked` says what others have.
//
// Fails: E7001: nothing is asked, a target that is not above 0, no wrinkle where length and height
// are asked, what no sheet of this kind has (with the nearest that one has), a recipe that check()
// refuses, more than 10 million vertices; E0001. Cost: some ten times as many sheets as are
// measured.
Result<Fit> fit(const Recipe& start, const FitTarget& target, const FitOptions& options,
                DiagnosticLog& log, const SourceSpan& where = {}, const Job& job = {});

}  // namespace panwright::mli
