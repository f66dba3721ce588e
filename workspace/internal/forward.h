// Diagnostics of one view, in the log of the run.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/diagnostic.h"

namespace panwright::workspace {

// Adds what stands in one log to another. label: put before the messages ("view 3 ('far')");
// empty: they stay as they are. file: the views file, which then stands for those without a file,
// and E0201 is E0203. except: left out.
void forward(const DiagnosticLog& from, const std::string& label, std::string_view file,
             DiagnosticLog& to, std::optional<Code> except = {});

// "view 3 ('far')".
std::string view_label(std::size_t index, const std::string& name);

}  // namespace panwright::workspace
