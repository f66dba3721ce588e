// Trajectory files as sources, by their name and content. Private to workspace.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/config_text.h"
#include "base/diagnostic.h"
#include "base/result.h"
#include "scenario/csv.h"
#include "scenario/sequence.h"
#include "scenario/source.h"
#include "scenario/text.h"

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

// Returns the source of a text, by the name of its file and by its content.
//
// Fails: E0202 for other files; as their readers.
Result<scenario::SourcePtr> read_source(const std::filesystem::path& path,
                                        const scenario::Text& text, const SourceOptions& options,
                                        DiagnosticLog& log);

// Returns whether each channel comes from one source. places: of the sources in the scenario.
//
// Reports: E8008.
bool given_once(const std::vector<scenario::Part>& parts, const std::vector<SourceSpan>& places,
                DiagnosticLog& log);

// Returns whether the sources cover `begin` and `end` of a scenario, where it has them.
//
// Reports: E8003; E8013 where its frames have no times.
bool is_covered(const scenario::Sequence& sequence, const ConfigValue& root, DiagnosticLog& log);

// Returns whether a text is a scenario as JSON: an object with sources.
bool is_json_scenario(std::string_view text);

// Reads a source with a `simulator`: "42" has `time`, and `position` or `rotation` or both;
// "basilisk" has `file`.
//
//   target  empty: the camera
//   folder  that files are relative to
//   files   they are added to these
// Fails: E8013; as the readers of scenario/simulators.h.
std::optional<scenario::SourcePtr> read_simulator(ConfigTable& part, const std::string& target,
                                                  const std::filesystem::path& folder,
                                                  std::vector<std::string>& files,
                                                  DiagnosticLog& log);

}  // namespace panwright::workspace
