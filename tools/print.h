// Text on standard output and standard error, replacing the progress line. A failing stream
// (closed, full disk) does not end the work: run() checks standard output at the end.
#pragma once

#include <fmt/core.h>

#include <cstdio>
#include <string>
#include <utility>

#include "tools/progress_line.h"

namespace panwright::tools {

template <class... Arguments>
void print(std::FILE* stream, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  const std::string text = fmt::format(format, std::forward<Arguments>(arguments)...);
  wipe_progress();
  (void)std::fwrite(text.data(), 1, text.size(), stream);
}

template <class... Arguments>
void print(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  tools::print(stdout, format, std::forward<Arguments>(arguments)...);
}

}  // namespace panwright::tools
