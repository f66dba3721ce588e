// Text and report of `panwright mli --fit`: the target, and the recipe as pxn text.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "mli/fit.h"

namespace panwright::tools {

// Parses "slope_rms=0.15 correlation=2cm height_rms=1mm", separated by blanks or commas. Reports
// E0201.
std::optional<mli::FitTarget> fit_target(std::string_view text, DiagnosticLog& log);

// Returns an <mli> element, after its material if that is of the library. Numbers read back as the
// same.
std::string recipe_text(const mli::Recipe& recipe, std::string_view material, bool from_library);

// Returns the fit: targets, statistics of fitted and of other seeds, the text.
nlohmann::ordered_json fit_json(const mli::Fit& fit, const mli::FitTarget& target,
                                const std::string& text);
void print_fit(const mli::Fit& fit, const mli::FitTarget& target, const std::string& text);

}  // namespace panwright::tools
