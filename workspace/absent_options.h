// Options of other renderers that render and the views lack, with what takes their place.
#pragma once

#include <string_view>

namespace panwright::workspace {

// Returns a sentence on what takes the place of an option, named without hyphens before it; empty:
// the name is not known.
std::string_view instead_of(std::string_view name);

}  // namespace panwright::workspace
