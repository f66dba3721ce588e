// Two kinds of off-screen contexts. Private to preview.
#pragma once

#include <memory>
#include <string>

#include "preview/context.h"

namespace panwright::preview {

// A context, or the reason for its absence.
struct ContextAttempt {
  std::unique_ptr<Context> context;  // current on this thread when not null
  std::string reason;                // one clause, when null
};

// hardware_only: skips software devices.
ContextAttempt create_egl_context(bool hardware_only);
ContextAttempt create_osmesa_context();

}  // namespace panwright::preview
