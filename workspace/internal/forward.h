// Forwarding of a view's diagnostics to the log of the run.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/diagnostic.h"

namespace panwright::workspace {

// Adds the entries of one log to another. label: prefix of the messages ("view 3 ('far')"); empty:
// none. file: the views file, for entries without a file, and E0201 becomes E0203. except: left
// out.
void forward(const DiagnosticLog& from, const std::string& label, std::string_view file,
             DiagnosticLog& to, std::optional<Code> except = {});

// Returns "view 3 ('far')".
std::string view_label(std::size_t index, const std::string& name);

}  // namespace panwright::workspace
