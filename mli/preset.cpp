#include "mli/preset.h"

#include <algorithm>
#include <cmath>

namespace panwright::mli {
namespace {

constexpr Preset kPresets[] = {{"crinkled", "mli_gold_kapton", 0.005},
                               {"smooth", "mli_silver", 0.01},
                               {"quilted", "mli_beta_cloth", 0.01},
                               {"embossed", "mli_black", 0.002},
                               {"taped", "mli_gold_kapton", 0.005}};

Crease creases(double density, double depth, double length) {
  Crease crease;
  crease.density = density;
  crease.depth = depth;
  crease.length = length;
  return crease;
}

// Foil that was crumpled and pulled flat: facets of some centimetres on larger folds and soft
// wrinkles. No ridge is much longer than the others: long ones look like bark.
std::vector<Operation> crinkled(double slope) {
  Crease folds = creases(950, 0.0045, 0.045), facets = creases(5400, 0.002, 0.02);
  folds.spread = facets.spread = 0.4;
  folds.tail_share = facets.tail_share = 0;
  return {folds, facets, Wrinkle{0.1, 0.0015, 0.6, 2}, SlopeRms{slope}};
}

}  // namespace

std::span<const Preset> presets() { return kPresets; }

std::optional<std::vector<Operation>> preset_operations(std::string_view name, double height) {
  if (name == "crinkled") return crinkled(0.3);
  if (name == "smooth")
    return std::vector<Operation>{creases(600, 0.001, 0.06), Wrinkle{0.2, 0.002, 0.4, 3},
                                  SlopeRms{0.05}};
  if (name == "quilted")
    return std::vector<Operation>{Emboss{Pattern::quilt, 0.08, 0.005}, creases(1000, 0.0005, 0.04)};
  if (name == "embossed")
    return std::vector<Operation>{creases(800, 0.001, 0.05), SlopeRms{0.08},
                                  Emboss{Pattern::diamond, 0.008, 0.0004}};
  if (name != "taped") return std::nullopt;
  std::vector<Operation> operations = crinkled(0.2);
  constexpr double kApart = 0.5, kWidth = 0.025;
  // as many as fit, a thousand at most: a recipe has no more operations
  const double count = std::clamp(std::floor((height - kWidth) / kApart), 0.0, 900.0);
  for (double k = 0; k <= count; ++k)
    operations.push_back(
        Seam{true, height / 2 + (k - count / 2) * kApart, kWidth, 0.0008, 0.012, 0.0004});
  return operations;
}

}  // namespace panwright::mli
