// Texts of trajectory files, from a path or from memory.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/diagnostic.h"
#include "base/result.h"
#include "base/source.h"

namespace panwright::scenario {

inline constexpr std::uint64_t kMaxTextBytes = 512ull << 20;

struct Text {
  std::string name;  // in diagnostics
  SharedText bytes;
};

// Fails: E0101, E0102, E0104 over kMaxTextBytes.
Result<Text> read_text(const std::filesystem::path& path, DiagnosticLog& log);
Text memory_text(std::string name, std::string bytes);

}  // namespace panwright::scenario
