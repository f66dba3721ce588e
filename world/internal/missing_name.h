// Messages about an unknown name. Private to world.
#pragma once

#include <fmt/core.h>

#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/text.h"

namespace panwright::world {

// Reports "WHAT 'name'" with the nearest known name, or with all names where they are few.
inline void report_missing(Code code, std::string_view file, std::string_view what,
                           std::string_view name, const std::vector<std::string_view>& names,
                           DiagnosticLog& log) {
  std::string hint;
  if (const auto near = nearest_name(name, names)) hint = fmt::format("did you mean '{}'?", *near);
  std::string message = fmt::format("{} {}", what, in_quotes(name));
  if (names.empty()) {
    message += "; there are none";
  } else if (hint.empty() && names.size() <= 10) {
    message += ", expected ";
    for (std::size_t i = 0; i < names.size(); ++i) message += (i ? ", " : "") + in_quotes(names[i]);
  }
  log.report_file(code, file, std::move(message), std::move(hint));
}

}  // namespace panwright::world
