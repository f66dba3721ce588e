// Contents of SPICE kernels, as `panwright info` shows them.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "base/diagnostic.h"

namespace panwright::tools {

// Returns whether a file begins as a kernel does.
bool is_kernel_file(const std::filesystem::path& path);

// Adds segments, spans, and variables of text kernels to `out`; prints them where `text`. False: as
// ephemeris::Kernels::load().
bool show_kernel(const std::filesystem::path& path, bool text, nlohmann::ordered_json& out,
                 DiagnosticLog& log);

}  // namespace panwright::tools
