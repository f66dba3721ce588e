// Materials whose fits earlier runs have computed.
#pragma once

#include "base/work_cache.h"
#include "materials/material.h"

namespace panwright::materials {

// As resolved() in material.h.
//
//   cache  of fits; null: none. It changes no number. Fits are no parts of a model: WorkCounts
//          leave them out
Material resolved(const Fields& fields, SourceSpan where, DiagnosticLog& log,
                  const WorkCache* cache);

}  // namespace panwright::materials
