// Trajectory files as sources, by their name and content. Private to workspace.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "base/diagnostic.h"
#include "base/result.h"
#include "scenario/csv.h"
#include "scenario/source.h"

namespace panwright::workspace {

// Extension of a file name in lower case.
std::string lower_extension(const std::filesystem::path& path);

// Returns whether the first word of a text begins with a keyword.
bool begins_with_keyword(std::string_view text, std::string_view keyword);

struct SourceOptions {
  std::string target;                          // empty: the camera
  std::map<std::string, std::string> objects;  // of a flight file
  std::optional<double> frame_rate;
  scenario::CsvOptions csv;
  bool strict = false;
};

// Fails: E0202 for other files; as their readers.
Result<scenario::SourcePtr> read_source(const std::filesystem::path& path,
                                        const SourceOptions& options, DiagnosticLog& log);

}  // namespace panwright::workspace
