// Sheets of foil as they are seen on spacecraft: operations by name.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "mli/recipe.h"

namespace panwright::mli {

struct Preset {
  std::string_view name;
  std::string_view material;  // of the library of materials, which it is usual with
  double cell;                // metres, the coarsest grid that shows all of it
};

// crinkled, smooth, quilted, embossed, taped.
std::span<const Preset> presets();

// The operations of a preset; nothing: another name. Their sizes are metres, whatever the sheet's,
// but for seams, which stand half a metre apart about the middle of the height.
//
// Slopes are guesses: no measured RMS slope of flight blankets is published (docs/accuracy/mli.md).
std::optional<std::vector<Operation>> preset_operations(std::string_view name, double height);

}  // namespace panwright::mli
