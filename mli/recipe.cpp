#include "mli/recipe.h"

#include <fmt/core.h>

#include <cmath>

#include "mli/internal/crease.h"

namespace panwright::mli {
namespace {

constexpr std::string_view kNames[] = {"random",  "smooth", "constant", "taper",
                                       "wrinkle", "crease", "fractal",  "emboss",
                                       "seam",    "button", "crush",    "slope_rms"};
static_assert(std::size(kNames) == std::variant_size_v<Operation>);

// Says what is wrong with the numbers of one place.
class Checker {
 public:
  Checker(const Recipe& recipe, DiagnosticLog& log) : recipe_(recipe), log_(log) {}

  void at(SourceSpan where, std::string name) {
    where_ = where;
    name_ = std::move(name);
  }
  bool good() const { return good_; }
  void wrong(std::string_view what) {
    good_ = false;
    log_.report(Code("E7001"), where_,
                fmt::format("{}{}{}", name_, name_.empty() ? "" : ": ", what));
  }
  // what: "width"
  bool within(std::string_view what, double value, double low, double high,
              std::string_view unit = "") {
    if (value >= low && value <= high) return true;
    wrong(fmt::format("{} is {}, expected a number from {} to {}{}", what, value, low, high, unit));
    return false;
  }
  bool length(std::string_view what, double value) {
    return within(what, value, kMinLength, kMaxLength, " m");
  }
  // A length that the grid can show.
  void pitch(std::string_view what, double value) {
    if (!length(what, value) || value >= 2 * recipe_.cell() * (1 - 1e-12)) return;
    wrong(
        fmt::format("{} {} m is less than two cells of the grid, {:.4g} m; expected a larger one, "
                    "or cells (width / xgrid) of at most {:.4g} m",
                    what, value, 2 * recipe_.cell(), value / 2));
  }
  // 0 is a length too
  bool size(std::string_view what, double value) {
    return within(what, value, 0, kMaxLength, " m");
  }
  bool height(std::string_view what, double value) {
    return within(what, value, -kMaxLength, kMaxLength, " m");
  }

  void operator()(const Random& op) { size("amplitude", op.amplitude); }
  void operator()(const Smooth& op) {
    const double vertices = (recipe_.xgrid + 1.0) * (recipe_.ygrid() + 1);
    within("number of passes", op.passes, 0, std::min(kMaxPasses, std::floor(kMaxWork / vertices)));
  }
  void operator()(const Constant& op) { height("height", op.height); }
  void operator()(const Taper& op) {
    edges("x", "width", op.x0, op.x1, recipe_.width);
    edges("y", "height", op.y0, op.y1, recipe_.cell() * recipe_.ygrid());
  }
  void operator()(const Wrinkle& op) {
    pitch("wavelength", op.wavelength);
    height("amplitude", op.amplitude);
    within("direction", op.direction, -1e6, 1e6, " rad");
    within("anisotropy", op.anisotropy, 1, 100);
  }
  void operator()(const Crease& op);
  void operator()(const Fractal& op) {
    if (!(op.hurst > 0)) wrong(fmt::format("H is {}, expected above 0 and at most 1", op.hurst));
    if (op.hurst > 0) within("H", op.hurst, 0, 1);
    size("rms", op.rms);
    pitch("longest", op.longest != 0 ? op.longest : recipe_.width / 4);
  }
  void operator()(const Emboss& op) {
    pitch("pitch", op.pitch);
    height("depth", op.depth);
  }
  void operator()(const Seam& op) {
    const double side = op.along_x ? recipe_.cell() * recipe_.ygrid() : recipe_.width;
    within("position", op.position, 0, side, " m, on the sheet");
    pitch("width", op.width);
    height("height", op.height);
    if (op.stitch != 0) pitch("stitch", op.stitch);
    height("pucker", op.pucker);
  }
  void operator()(const Button& op) {
    if (!length("pitch", op.pitch) || !size("radius", op.radius)) return;
    if (!(op.reach > op.radius && op.reach <= op.pitch / 2))
      wrong(fmt::format(
          "reach is {} m, expected more than the radius, {} m, and at most half the pitch, {} m",
          op.reach, op.radius, op.pitch / 2));
    height("pucker", op.pucker);
  }
  void operator()(const Crush& op) {
    pitch("size", op.size);
    height("depth", op.depth);
  }
  void operator()(const SlopeRms& op) { within("slope", op.slope, 0, 100); }

 private:
  void edges(std::string_view axis, std::string_view side_name, double from, double to,
             double side) {
    if (!size(fmt::format("{}0", axis), from) || !size(fmt::format("{}1", axis), to)) return;
    if (from > to)
      wrong(fmt::format("{0}0 is {1} m and {0}1 {2} m, expected {0}1 at least as large as {0}0",
                        axis, from, to));
    else if (to > side / 2 * (1 + 1e-12))
      wrong(
          fmt::format("{0}1 is {1} m, more than half the sheet's {2}, {3} m; no part of the sheet "
                      "would have its full height",
                      axis, to, side_name, side / 2));
  }

  const Recipe& recipe_;
  DiagnosticLog& log_;
  SourceSpan where_;
  std::string name_;
  bool good_ = true;
};

void Checker::operator()(const Crease& op) {
  within("density", op.density, 0, 1e18, " ridges per square metre");
  height("depth", op.depth);
  length("length", op.length);
  within("spread", op.spread, 0, 3);
  within("tail", op.tail, 1.01, 10);
  within("tail_share", op.tail_share, 0, 1);
  if (!good_) return;
  const double margin = 2 * crease_margin(op);
  const double area = (recipe_.width + margin) * (recipe_.cell() * recipe_.ygrid() + margin);
  if (op.density * area > kMaxRidges)
    wrong(
        fmt::format("density {} makes {:.0f} ridges, expected at most {:.0f}: a density of {:.6g} "
                    "per square metre",
                    op.density, op.density * area, kMaxRidges, kMaxRidges / area));
  const double overlap = op.density * crease_overlap(op);
  if (overlap > kMaxOverlap)
    wrong(
        fmt::format("{:.0f} ridges overlap at each point of the sheet, expected at most {:.0f}: a "
                    "density of {:.6g} per square metre",
                    overlap, kMaxOverlap, op.density * kMaxOverlap / overlap));
  pitch("length", op.length);
}

bool check_size(const Recipe& recipe, Checker& checker, const RecipePlaces& places) {
  const auto place = [&](const SourceSpan& own) {
    return own.file == kNoFile ? places.recipe : own;
  };
  checker.at(place(places.width), "");
  checker.length("width", recipe.width);
  checker.at(place(places.height), "");
  checker.length("height", recipe.height);
  checker.at(place(places.xgrid), "");
  if (recipe.xgrid < 1 || recipe.xgrid > kMaxCells)
    checker.wrong(
        fmt::format("xgrid is {}, expected 1 to {} cells across", recipe.xgrid, kMaxCells));
  if (!checker.good()) return false;
  const double up = recipe.ygrid();
  if (up < 1 || up > kMaxCells) {
    checker.at(place(places.height), "");
    checker.wrong(
        fmt::format("{} m by {} m with xgrid {} is {} cells high, expected 1 to {}: height divided "
                    "by width/xgrid",
                    recipe.width, recipe.height, recipe.xgrid, up, kMaxCells));
  } else if ((recipe.xgrid + 1) * (up + 1) > kMaxVertices) {
    checker.wrong(
        fmt::format("xgrid {} makes {:.0f} vertices, expected at most {:.0f}: an xgrid of {}",
                    recipe.xgrid, (recipe.xgrid + 1) * (up + 1), kMaxVertices,
                    std::floor(std::sqrt(kMaxVertices * recipe.width / recipe.height)) - 1));
  }
  return checker.good();
}

}  // namespace

std::string_view name_of(const Operation& operation) { return kNames[operation.index()]; }

double Recipe::ygrid() const { return std::floor(height / width * xgrid + 0.5); }

bool check(const Recipe& recipe, DiagnosticLog& log, const RecipePlaces& places) {
  Checker checker(recipe, log);
  if (!check_size(recipe, checker, places)) return false;
  bool good = true;
  if (recipe.operations.size() > kMaxOperations) {
    checker.at(places.recipe, "");
    checker.wrong(fmt::format("{} operations, expected at most {}", recipe.operations.size(),
                              kMaxOperations));
    return false;
  }
  for (std::size_t i = 0; i < recipe.operations.size(); ++i) {
    Checker one(recipe, log);
    const bool placed = i < places.operations.size() && places.operations[i].file != kNoFile;
    one.at(placed ? places.operations[i] : places.recipe,
           fmt::format("operation {}, {}", i + 1, name_of(recipe.operations[i])));
    std::visit(one, recipe.operations[i]);
    good = good && one.good();
  }
  return good;
}

}  // namespace panwright::mli
