// Names of enumerated values of a model, for people and JSON.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pan/model.h"

namespace panwright::tools {

// Return the name of a BRDF model, with hyphens.
std::string diffuse_word(std::uint32_t model);
std::string specular_word(std::uint32_t model);

// Returns the form of a sheet: "flat", "tube"…
std::string_view form_word(const pan::layout::Sheet& sheet);

// Returns the number of meshes that each term decided, in the order of the reasons.
std::vector<std::pair<pan::layout::ToleranceReason, std::size_t>> decisions_of(
    const pan::Model& model);

}  // namespace panwright::tools
