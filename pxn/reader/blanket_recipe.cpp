#include "pxn/reader/blanket_recipe.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <variant>
#include <vector>

#include "mli/preset.h"

namespace panwright::pxn {
namespace {

constexpr double kCell = 0.005;     // metres, without a preset
constexpr double kTriangles = 1e6;  // of a blanket whose cells are not given

bool has_relief(const mli::Operation& operation) {
  return !std::holds_alternative<mli::SlopeRms>(operation) &&
         !std::holds_alternative<mli::Constant>(operation) &&
         !std::holds_alternative<mli::Taper>(operation) &&
         !std::holds_alternative<mli::Smooth>(operation);
}

mli::Recipe square_recipe(double side, double cell) {
  mli::Recipe recipe;
  recipe.width = recipe.height = side;
  recipe.xgrid = static_cast<std::uint32_t>(std::lround(side / cell));
  return recipe;
}

}  // namespace

std::vector<mli::Operation> operations_for(const Blanket& how, double height, double cell) {
  std::vector<mli::Operation> out;
  if (auto preset = mli::preset_operations(how.preset, height)) out = *std::move(preset);
  out.insert(out.end(), how.operations.begin(), how.operations.end());
  if (how.cell > 0) return out;
  const auto too_fine = [&](const mli::Operation& operation) {
    mli::Recipe alone = square_recipe(64 * cell, cell);
    alone.operations = {operation};
    DiagnosticLog ignored;
    return has_relief(operation) && !mli::check(alone, ignored);
  };
  std::vector<mli::Operation> kept;
  std::ranges::remove_copy_if(out, std::back_inserter(kept), too_fine);
  return std::ranges::any_of(kept, has_relief) ? kept : out;
}

mli::RecipeFor recipe_for(const Blanket& how, double cell, std::uint32_t seed) {
  return [&how, cell, seed](double width, double height, std::uint32_t seed_offset) {
    mli::Recipe recipe;
    recipe.width = recipe.height = cell;
    recipe.xgrid = 1;
    recipe.seed = seed;
    recipe = mli::fitted(recipe)(width, height, seed_offset);
    recipe.operations = operations_for(how, recipe.height, cell);
    return recipe;
  };
}

double cell_of(const Blanket& how, double diagonal, double area, double least, double& coarsened) {
  if (how.cell > 0) return how.cell;
  double cell = kCell;
  for (const mli::Preset& preset : mli::presets())
    if (preset.name == how.preset) cell = preset.cell;
  cell = std::min(cell, diagonal / 100);
  double largest = std::max(least, std::sqrt(kPerCell * area / kTriangles));
  if (largest <= cell) return cell;
  // as large as the operations allow
  for (; largest > cell; largest *= 0.9) {
    DiagnosticLog ignored;
    if (mli::check(recipe_for(how, largest, 0)(64 * largest, 64 * largest, 0), ignored))
      return coarsened = largest;
  }
  return cell;
}

}  // namespace panwright::pxn
