#include "mli/fit.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "mli/sheet.h"

namespace panwright::mli {
namespace {

constexpr double kMostVertices = 1e7;
constexpr double kVertices = 2e7;  // of all sheets of a measurement, about
constexpr std::uint32_t kSheets = 64, kLeastSheets = 8;
constexpr double kClose = 0.005;          // relative
constexpr double kLeastShare = 1.0 / 16;  // of wrinkles
constexpr int kShares = 9;                // tried, from kLeastShare to its inverse, factors of two

struct Scaler {
  double scale;
  bool keep_size;
  double width;  // of the sheet as it was

  template <class... Lengths>
  void by(Lengths&... lengths) const {
    ((lengths *= scale), ...);
  }
  void operator()(Random& op) const { by(op.amplitude); }
  void operator()(Smooth&) const {}
  void operator()(Constant& op) const { by(op.height); }
  void operator()(Taper& op) const { by(op.x0, op.x1, op.y0, op.y1); }
  void operator()(Wrinkle& op) const { by(op.wavelength, op.amplitude); }
  void operator()(Crease& op) const {
    by(op.depth, op.length);
    op.density /= scale * scale;
  }
  void operator()(Fractal& op) const {
    if (op.longest == 0) op.longest = width / 4;
    by(op.rms, op.longest);
  }
  void operator()(Emboss& op) const { by(op.pitch, op.depth); }
  void operator()(Seam& op) const {
    if (!keep_size) by(op.position);
    by(op.width, op.height, op.stitch, op.pucker);
  }
  void operator()(Button& op) const { by(op.pitch, op.radius, op.reach, op.pucker); }
  void operator()(Crush& op) const { by(op.size, op.depth); }
  void operator()(SlopeRms&) const {}
};

void round(double& value) { value = parse_double(fmt::format("{:.4g}", value)).value_or(value); }

struct Rounder {
  template <class... Numbers>
  void all(Numbers&... numbers) const {
    (round(numbers), ...);
  }
  void operator()(Random& op) const { all(op.amplitude); }
  void operator()(Smooth&) const {}
  void operator()(Constant& op) const { all(op.height); }
  void operator()(Taper& op) const { all(op.x0, op.x1, op.y0, op.y1); }
  void operator()(Wrinkle& op) const {
    all(op.wavelength, op.amplitude, op.direction, op.anisotropy);
  }
  void operator()(Crease& op) const {
    all(op.density, op.depth, op.length, op.spread, op.tail, op.tail_share);
  }
  void operator()(Fractal& op) const { all(op.hurst, op.rms, op.longest); }
  void operator()(Emboss& op) const { all(op.pitch, op.depth); }
  void operator()(Seam& op) const { all(op.position, op.width, op.height, op.stitch, op.pucker); }
  void operator()(Button& op) const { all(op.pitch, op.radius, op.reach, op.pucker); }
  void operator()(Crush& op) const { all(op.size, op.depth); }
  void operator()(SlopeRms&) const {}
};

Recipe rounded(Recipe recipe) {
  round(recipe.width);
  round(recipe.height);
  for (Operation& each : recipe.operations) std::visit(Rounder{}, each);
  return recipe;
}

Recipe with_wrinkles(Recipe recipe, double factor) {
  for (Operation& each : recipe.operations)
    if (auto* wrinkle = std::get_if<Wrinkle>(&each)) wrinkle->amplitude *= factor;
  return recipe;
}

// Running sums, in the order of the seeds.
struct Sums {
  double sum = 0, squares = 0;
  void add(double value) {
    sum += value;
    squares += value * value;
  }
  Spread over(double count) const {
    const double mean = sum / count;
    const double variance = (squares / count - mean * mean) * count / std::max(count - 1, 1.0);
    return {mean, std::sqrt(std::max(variance, 0.0))};
  }
};

class Fitter {
 public:
  Fitter(Recipe start, const FitTarget& target, const FitOptions& options, DiagnosticLog& log,
         const SourceSpan& where, const Job& job)
      : start_(std::move(start)),
        target_(target),
        options_(options),
        log_(log),
        where_(where),
        job_(job) {}

  Result<Fit> found() {
    if (!asked() || !mli::check(start_, log_, places())) return failed;
    if (target_.slope_rms) {
      if (!start_.operations.empty() && std::holds_alternative<SlopeRms>(start_.operations.back()))
        start_.operations.pop_back();
      start_.operations.emplace_back(SlopeRms{*target_.slope_rms});
    }
    Fit out;
    const bool both = target_.correlation && target_.height_rms;
    if (both && !mixed(out.wrinkles)) return failed;
    auto scale = size_of(out.wrinkles);
    if (!scale) return failed;
    out.scale = *scale;
    out.recipe = rounded(scaled(with_wrinkles(start_, out.wrinkles), *scale, options_.keep_size));
    auto fitted = measured(out.recipe, start_.seed);
    if (!fitted) return failed;
    auto checked = measured(out.recipe, start_.seed + fitted->sheets);
    if (!checked) return failed;
    out.fitted = *fitted;
    out.checked = *checked;
    return out;
  }

 private:
  RecipePlaces places() const {
    RecipePlaces places;
    places.recipe = where_;
    return places;
  }

  bool refuse(const std::string& message) {
    log_.report(Code("E7001"), where_, message);
    return false;
  }

  bool asked() {
    const std::pair<const char*, std::optional<double>> all[] = {
        {"slope_rms", target_.slope_rms},
        {"correlation", target_.correlation},
        {"height_rms", target_.height_rms}};
    bool any = false;
    for (const auto& [name, value] : all) {
      if (!value) continue;
      any = true;
      if (!(*value > 0) || !(*value <= kMaxLength))
        return refuse(fmt::format("{} is {}, expected a number above 0 and at most {}", name,
                                  format_double(*value), format_double(kMaxLength)));
    }
    if (!any) return refuse("no statistic to fit, expected slope_rms, correlation or height_rms");
    const bool waves = std::ranges::any_of(start_.operations, [](const Operation& each) {
      return std::holds_alternative<Wrinkle>(each);
    });
    if (target_.correlation && target_.height_rms && start_.operations.size() > 0 && !waves)
      return refuse(
          "correlation and height_rms together are fitted by the share of `wrinkle`, which the "
          "recipe lacks; give one of them, or add a wrinkle");
    return true;
  }

  Result<FitStatistics> measured(const Recipe& recipe, std::uint32_t seed) {
    const double vertices = (recipe.xgrid + 1.0) * (recipe.ygrid() + 1.0);
    if (!(vertices <= kMostVertices)) {
      refuse(
          fmt::format("the fit needs sheets of {:.3g} vertices, expected at most {:.0g}; use a "
                      "smaller sheet or larger cells",
                      vertices, kMostVertices));
      return failed;
    }
    FitStatistics out;
    out.first_seed = seed;
    out.sheets =
        options_.sheets > 0
            ? options_.sheets
            : static_cast<std::uint32_t>(std::clamp(std::floor(kVertices / vertices),
                                                    double{kLeastSheets}, double{kSheets}));
    Sums slope, correlation, height;
    Recipe each = recipe;
    for (std::uint32_t i = 0; i < out.sheets; ++i) {
      each.seed = seed + i;
      const auto sheet = made(each, {}, log_, places(), job_);
      if (!sheet) return failed;
      const Statistics& s = sheet->statistics;
      slope.add(s.slope_rms);
      correlation.add((s.correlation_length.x + s.correlation_length.y) / 2);
      height.add(s.height_rms);
    }
    out.slope_rms = slope.over(out.sheets);
    out.correlation = correlation.over(out.sheets);
    out.height_rms = height.over(out.sheets);
    return out;
  }

  // The scale with which the correlation length, or else the height, is as asked.
  Result<double> size_of(double wrinkles) {
    if (!target_.correlation && !target_.height_rms) return 1.0;
    const double wanted = target_.correlation ? *target_.correlation : *target_.height_rms;
    const Recipe base = with_wrinkles(start_, wrinkles);
    double scale = 1, nearest = 0;
    for (int step = 0; step < 12; ++step) {
      const Recipe recipe = scaled(base, scale, options_.keep_size);
      const auto all = measured(recipe, start_.seed);
      if (!all) return failed;
      const double is = target_.correlation ? all->correlation.mean : all->height_rms.mean;
      if (std::fabs(is / wanted - 1) <= kClose) return scale;
      if (nearest == 0 || std::fabs(is - wanted) < std::fabs(nearest - wanted)) nearest = is;
      if (!(is > 0)) break;
      scale *= options_.keep_size ? std::clamp(wanted / is, 0.25, 4.0) : wanted / is;
      // what a sheet cannot show is not tried
      DiagnosticLog quiet;
      if (!mli::check(scaled(base, scale, options_.keep_size), quiet)) break;
    }
    refuse(fmt::format(
        "a sheet of this kind, {} by {} m, cannot have a {} of {} m; the nearest found is {:.4g} "
        "m{}",
        format_double(start_.width), format_double(start_.height),
        target_.correlation ? "correlation length" : "rms height", format_double(wanted), nearest,
        options_.keep_size ? "; another size of the sheet may have it" : ""));
    return failed;
  }

  // Height over correlation length, right or too large by so much.
  Result<double> excess(double wrinkles) {
    Recipe recipe = with_wrinkles(start_, wrinkles);
    if (options_.keep_size) {
      const auto scale = size_of(wrinkles);
      if (!scale) return failed;
      recipe = scaled(recipe, *scale, true);
    }
    const auto all = measured(recipe, start_.seed);
    if (!all) return failed;
    return all->height_rms.mean / all->correlation.mean /
               (*target_.height_rms / *target_.correlation) -
           1;
  }

  // The share of wrinkles with which height and correlation length go together.
  bool mixed(double& share) {
    double below = 0, above = 0;  // shares, 0: none yet
    double least = HUGE_VAL, most = -HUGE_VAL;
    double factor = kLeastShare;
    for (int i = 0; i < kShares && !(below > 0 && above > 0); ++i, factor *= 2) {
      const auto is = excess(factor);
      if (!is) return false;
      least = std::min(least, *is);
      most = std::max(most, *is);
      (*is < 0 ? below : above) = factor;
    }
    const double wanted = *target_.height_rms / *target_.correlation;
    if (!(below > 0 && above > 0))
      return refuse(
          fmt::format("height_rms is {:.4g} of the correlation length, expected {:.4g} to {:.4g} "
                      "for sheets of this kind and slope",
                      wanted, (1 + least) * wanted, (1 + most) * wanted));
    for (int i = 0; i < 20; ++i) {
      share = (below + above) / 2;
      const auto is = excess(share);
      if (!is) return false;
      if (std::fabs(*is) <= kClose / 2) return true;
      (*is < 0 ? below : above) = share;
    }
    return true;
  }

  Recipe start_;
  const FitTarget& target_;
  const FitOptions& options_;
  DiagnosticLog& log_;
  const SourceSpan& where_;
  const Job& job_;
};

}  // namespace

double Spread::error(std::uint32_t sheets) const { return deviation / std::sqrt(double(sheets)); }

Recipe scaled(const Recipe& recipe, double scale, bool keep_size) {
  Recipe out = recipe;
  if (keep_size) {
    // as many cells as are no larger than scaled ones
    const double cells = std::ceil(recipe.xgrid / scale - 1e-6);
    out.xgrid = static_cast<std::uint32_t>(std::clamp(cells, 2.0, double{kMaxCells}));
  } else {
    out.width *= scale;
    out.height *= scale;
  }
  for (Operation& each : out.operations) std::visit(Scaler{scale, keep_size, recipe.width}, each);
  return out;
}

Result<Fit> fit(const Recipe& start, const FitTarget& target, const FitOptions& options,
                DiagnosticLog& log, const SourceSpan& where, const Job& job) {
  return Fitter(start, target, options, log, where, job).found();
}

}  // namespace panwright::mli
