// Accuracy budgets as text of options.
#pragma once

#include <string_view>

#include "base/diagnostic.h"
#include "base/result.h"
#include "scene/scene.h"

namespace panwright::workspace {

// Parses "nearest=5km ifov=0.1mrad pixels=0.25 flux=0.1% centroid=0.01px tolerance=1mm
// approach=FRAME corridor=30deg", separated by blanks or commas, in any order, with the meanings
// and defaults of <budget>; "none": no budget. A bare number is metres or degrees.
//
// Fails: E0201 with near names, for a term twice or out of range, and for terms that lack a
// partner.
Result<scene::Budget> budget_of_text(std::string_view text, DiagnosticLog& log);

}  // namespace panwright::workspace
