// The two ways to an off-screen context. Private to preview.
#pragma once

#include <memory>
#include <string>

#include "preview/context.h"

namespace panwright::preview {

// A context, or why there is none.
struct ContextAttempt {
  std::unique_ptr<Context> context;  // current on this thread when not null
  std::string reason;                // one clause, when null
};

// hardware_only: passes over devices that draw in software.
ContextAttempt create_egl_context(bool hardware_only);
ContextAttempt create_osmesa_context();

}  // namespace panwright::preview
