// Texts of settings: TOML, YAML and JSON as one tree, with the place of each value.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "base/source.h"

namespace panwright {

struct ConfigValue {
  using List = std::vector<ConfigValue>;
  using Map = std::vector<std::pair<std::string, ConfigValue>>;  // in the order of the text

  // Null; flags; numbers; text (dates of TOML too).
  std::variant<std::monostate, bool, double, std::string, List, Map> data;
  SourceSpan where;

  // Returns the member of a name; null: this is no map, or has none of it.
  const ConfigValue* find(std::string_view name) const;
};

// Returns "text", "a number", "a list", … for messages.
std::string_view type_name(const ConfigValue& value);

enum class ConfigFormat {
  toml,  // TOML 1.0
  yaml,  // YAML 1.2 and JSON; the "%YAML:1.0" and the tags of OpenCV are accepted
};

// Parses a text. Numbers are doubles; those of YAML are as base::parse_double() takes them, all
// other words text. Aliases of YAML are copied.
//
//   file  of the log's sources, for places
//   code  reported when it fails: not of the format, a name given twice, more than 64 levels or a
//         million values
// Cost: O(text).
Result<ConfigValue> parse_config(std::string_view text, ConfigFormat format, FileId file, Code code,
                                 DiagnosticLog& log);

}  // namespace panwright
