// Presets of spacecraft foil: operations by name.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "mli/recipe.h"

namespace panwright::mli {

struct Preset {
  std::string_view name;
  std::string_view material;  // usual material, of the library of materials
  double cell;                // metres, the coarsest grid that resolves it
};

// Returns crinkled, smooth, quilted, embossed, taped.
std::span<const Preset> presets();

// Returns the operations of a preset; nothing: another name. Sizes are in metres, whatever the
// sheet's; seams are half a metre apart about the middle of the height.
//
// Slopes are guesses: no measured RMS slope of flight blankets is published (docs/accuracy/mli.md).
std::optional<std::vector<Operation>> preset_operations(std::string_view name, double height);

}  // namespace panwright::mli
