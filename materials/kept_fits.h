// Cache of fits of materials between runs.
#pragma once

#include "base/work_cache.h"
#include "materials/material.h"

namespace panwright::materials {

// Resolves as resolved() in material.h.
//
//   cache  of fits; null: none. It changes no number. WorkCounts exclude fits, as they are no part
//          of a model
Material resolved(const Fields& fields, SourceSpan where, DiagnosticLog& log,
                  const WorkCache* cache);

}  // namespace panwright::materials
