// Recipes of foil: the operations that make a sheet, and their checks.
#pragma once

#include <cstdint>
#include <string_view>
#include <variant>
#include <vector>

#include "base/diagnostic.h"

namespace panwright::mli {

// Operations: heights in metres over a flat sheet, x from its left edge, y from its lower edge.
// Unless stated otherwise, an operation adds to the present heights. Wavelengths, pitches and other
// sizes along the sheet are two cells of its grid at least.

// Independent uniform heights in [-amplitude, amplitude] at every vertex of the recipe's grid.
struct Random {
  double amplitude = 0;
};

// Passes of a mean over 3 × 3 vertices; edge samples are repeated beyond the edges, which preserves
// the mean of all heights. Equal heights stay equal, to the bit.
struct Smooth {
  std::uint32_t passes = 0;
};

struct Constant {
  double height = 0;
};

// Factor f(x)·g(y). f is 0 within x0 of the left and right edges, 1 from x1 on, 3t² − 2t³ between
// them; g likewise with y0 and y1. x1 = 0: f is 1.
struct Taper {
  double x0 = 0, x1 = 0, y0 = 0, y1 = 0;
};

// Wrinkles with sharp crests and flat flanks across one direction, which continue, end and fork.
//
// h = a·|z|·tri(arg z) with tri(φ) = 1 − 2|φ|/π and z a sum of 24 plane waves of random phases,
// E|z|² = 1.5. So the mean of h² is a²/2, as for a sine wave of amplitude a. Their wave numbers are
// uniform within 20 % of 2π/wavelength, their directions within ±Θ of `direction`. Θ is such that
// rms wave numbers along and across the direction are as `anisotropy` to 1.
struct Wrinkle {
  double wavelength = 0;  // metres
  double amplitude = 0;
  double direction = 0;   // radians from x, across the crests
  double anisotropy = 3;  // 1 (every direction) to 100 (parallel crests)
};

// A network of ridges and valleys: pyramids of four flat facets over the ridge, each at a place,
// in a direction and with a sign of its own.
//
// Lengths: a share of 1 − tail_share is log-normal (median `length`, `spread` the standard
// deviation of ln L); the rest has a density ∝ L^-tail from `length` on. All end at 20 lengths. A
// ridge is depth·L/length high and reaches 0.15 to 0.6 L to either side, so that facets of all
// sizes are equally steep. A. Andresen, A. Hansen, J. Schmittbuhl, "Ridge network in crumpled
// paper", 2007, find such lengths in paper; their use for foil, and the default numbers, are
// guesses.
struct Crease {
  double density = 0;  // ridges per square metre
  double depth = 0;    // height of a ridge of median length, metres
  double length = 0;   // metres
  double spread = 0.5;
  double tail = 2.5;
  double tail_share = 0.1;
};

// A self-affine surface: octaves of cubic splines through independent heights on square grids, of
// spacings longest/2^k, variances ∝ 2^-2Hk. The sum over all octaves has the given rms height;
// those finer than two cells of the recipe's grid are left out.
struct Fractal {
  double hurst = 0.7;  // H, in (0, 1]; the spectrum falls with q^(-2 - 2H)
  double rms = 0;      // metres, of an infinitely large sheet
  double longest = 0;  // spacing of the first octave, metres; 0: a quarter of the width
};

enum class Pattern { quilt, diamond };

// A regular pattern. quilt: pillows 16·s(1 − s)·t(1 − t) between lines of stitches along x and y.
// diamond: four-sided pyramids between lines at ±45°.
struct Emboss {
  Pattern pattern = Pattern::quilt;
  double pitch = 0;  // between lines, metres
  double depth = 0;  // of the middle above the lines
};

// Lap or tape across the whole sheet: a step of the given height, flat on top, whose flanks take a
// fifth of its width each. Folds beside it, up and down in turn, half a stitch apart and of varied
// heights, fade out within two and a half widths.
struct Seam {
  bool along_x = true;
  double position = 0;  // of its middle line: y if along_x, else x
  double width = 0;
  double height = 0;  // may be negative
  double stitch = 0;  // 0: no folds
  double pucker = 0;  // largest height of a fold
};

// Pins of the sheet to its base on a grid of points, a pitch apart and centred: multiplies by 0
// within `radius` of one, by 1 from `reach` on, and adds radial puckers between.
struct Button {
  double pitch = 0;
  double radius = 0;
  double reach = 0;
  double pucker = 0;
};

// Dents that meet in sharp straight crests: heights follow the squared distance to the nearest of
// irregular points. Three sizes, each half as large and half as deep as the one before; those
// smaller than two cells of the recipe's grid are left out.
struct Crush {
  double size = 0;   // mean distance of the largest dents, metres
  double depth = 0;  // rms height of the largest
};

// Scale of all heights to a root mean squared slope, both axes together. It is the m of `cook`: α²
// of a surface seen only from afar (Beckmann).
struct SlopeRms {
  double slope = 0;
};

using Operation = std::variant<Random, Smooth, Constant, Taper, Wrinkle, Crease, Fractal, Emboss,
                               Seam, Button, Crush, SlopeRms>;

// Returns the operation's word in the language: "random", "slope_rms"….
std::string_view name_of(const Operation& operation);

struct Recipe {
  double width = 0;         // metres
  double height = 0;        // metres
  std::uint32_t xgrid = 0;  // square cells across the width, at the recipe's own detail
  std::uint32_t seed = 0;
  std::vector<Operation> operations;  // applied in order, any number of times

  double cell() const { return width / xgrid; }  // metres
  // Returns the cells across the height: the sheet is cell()·ygrid() high, within half a cell of
  // `height`.
  double ygrid() const;
};

// Places of a recipe's parts, for diagnostics.
struct RecipePlaces {
  SourceSpan recipe;                   // the element
  SourceSpan width, height, xgrid;     // none: that of the recipe
  std::vector<SourceSpan> operations;  // none if shorter
};

inline constexpr std::uint32_t kMaxCells = 100'000;            // across, and up
inline constexpr double kMaxVertices = 70e6;                   // 0.5 GB of heights
inline constexpr double kMinLength = 1e-9, kMaxLength = 1e9;   // metres
inline constexpr double kMaxPasses = 10'000, kMaxWork = 1e11;  // of smooth; passes · vertices
inline constexpr double kMaxRidges = 2e6;   // of a crease, those beyond the edges too
inline constexpr double kMaxOverlap = 100;  // ridges of a crease over a point, on average
inline constexpr std::size_t kMaxOperations = 1000;

// Checks that a sheet can be made. Reports E7001 for each invalid number, with its place.
bool check(const Recipe& recipe, DiagnosticLog& log, const RecipePlaces& places = {});

}  // namespace panwright::mli
