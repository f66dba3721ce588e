// Texts of settings: TOML, YAML and JSON as one tree, with the place of each value.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "base/source.h"

namespace panwright {

struct ConfigMember;

struct ConfigValue {
  using List = std::vector<ConfigValue>;
  using Map = std::vector<ConfigMember>;  // in the order of the text

  // Null; flags; numbers; text (dates of TOML too).
  std::variant<std::monostate, bool, double, std::string, List, Map> data;
  SourceSpan where;

  // Returns the member of a name; null: this is no map, or has none of it.
  const ConfigValue* find(std::string_view name) const;
};

struct ConfigMember {
  std::string name;
  ConfigValue value;
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

// Reader of the members of a table, which reports problems at their places. Names that were not
// asked for are refused at the end.
class ConfigTable {
 public:
  // what: "a camera", for messages. code: of all problems. Expects: value outlives the reader.
  ConfigTable(const ConfigValue& value, std::string_view what, Code code, DiagnosticLog& log)
      : value_(value), what_(what), code_(code), log_(log) {}

  bool ok() const { return ok_; }
  const ConfigValue& value() const { return value_; }

  // Reports a problem; ok() is false from then on.
  void fail(const ConfigValue& at, std::string message, std::string hint = {});

  // Returns a member; null: there is none. require() reports that.
  const ConfigValue* find(std::string_view name);
  const ConfigValue* require(std::string_view name);
  // Returns the first member of one of these names, in lower case; the text's may be of any case.
  const ConfigValue* find_any(std::initializer_list<std::string_view> names);
  const ConfigValue* require_any(std::initializer_list<std::string_view> names);

  // Return the value of a member; nothing: there is none, or another type, which is reported.
  // Numbers are finite.
  std::optional<std::string> text(const ConfigValue* member, std::string_view name);
  std::optional<double> number(const ConfigValue* member, std::string_view name);
  std::optional<bool> flag(const ConfigValue* member, std::string_view name);
  // A number, or a list of numbers or of such lists, in order; one of these counts.
  std::optional<std::vector<double>> numbers(const ConfigValue* member, std::string_view name,
                                             std::initializer_list<std::size_t> counts);
  std::optional<std::string> text(std::string_view name) { return text(find(name), name); }
  std::optional<double> number(std::string_view name) { return number(find(name), name); }
  std::optional<bool> flag(std::string_view name) { return flag(find(name), name); }
  std::optional<std::vector<double>> numbers(std::string_view name,
                                             std::initializer_list<std::size_t> counts) {
    return numbers(find(name), name, counts);
  }

  // Refuses a value that is no table, and names that were not asked for.
  void finish();

 private:
  const ConfigValue& value_;
  std::string what_;
  Code code_;
  DiagnosticLog& log_;
  std::vector<std::string> asked_;
  bool ok_ = true;
};

}  // namespace panwright
