// Fit of recipes to given statistics of sheets.
#pragma once

#include <cstdint>
#include <optional>

#include "base/job.h"
#include "base/result.h"
#include "mli/recipe.h"

namespace panwright::mli {

// Target statistics; at least one.
struct FitTarget {
  std::optional<double> slope_rms = std::nullopt;    // both axes together
  std::optional<double> correlation = std::nullopt;  // metres, mean of both axes
  std::optional<double> height_rms = std::nullopt;   // metres, about the mean
};

// Statistic over sheets of different seeds.
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
  Recipe recipe;          // numbers of four significant digits, except the target slope
  double scale = 1;       // of the initial sizes, heights too
  double wrinkles = 1;    // further factor on the amplitudes of `wrinkle`
  FitStatistics fitted;   // of the sheets used for the fit
  FitStatistics checked;  // of as many others
};

struct FitOptions {
  // Keeps the sheet's size; else it is scaled with its wrinkles.
  bool keep_size = false;
  std::uint32_t sheets =
      0;  // to measure; 0: 64, fewer of sheets of over 300,000 vertices, 8 at least
};

// Returns the recipe with every length multiplied by `scale`: cells, sizes along the sheet and
// heights. Slopes stay. keep_size: the sheet's sides and the places of its seams stay too.
Recipe scaled(const Recipe& recipe, double scale, bool keep_size);

// Finds a recipe of the kind of `start` with the target's mean statistics over seeds.
//
// Sizes are scaled until the correlation length, or else the rms height, is right; a slope_rms at
// the end sets the slope. For both length and height, the amplitude of `wrinkle` varies from 1/16
// to 16 times the start's. Each is right within 0.5 % over the measured sheets; `checked` has the
// statistics of others.
//
// Fails: E7001: no target, a target not above 0, no wrinkle for both length and height, an
// unreachable target (with the nearest reachable one), a recipe that check() refuses, more than 10
// million vertices; E0001. Cost: some ten times the measured sheets.
Result<Fit> fit(const Recipe& start, const FitTarget& target, const FitOptions& options,
                DiagnosticLog& log, const SourceSpan& where = {}, const Job& job = {});

}  // namespace panwright::mli
