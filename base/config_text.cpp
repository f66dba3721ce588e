#include "base/config_text.h"

#include <fmt/format.h>
#include <toml++/toml.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "base/text.h"

namespace panwright {

namespace {

constexpr int kMostNested = 64;
constexpr std::size_t kMostValues = 1'000'000;

// What both formats share: limits, places, the first problem.
class ConfigReader {
 public:
  ConfigReader(std::string_view text, FileId file, Code code, DiagnosticLog& log)
      : text_(text), file_(file), code_(code), log_(log) {}

  bool fail(SourceSpan where, const std::string& message, const std::string& hint = {}) {
    if (ok_) log_.report(code_, where, message, hint);
    return ok_ = false;
  }

  // Counts a value.
  bool enter(int depth, SourceSpan where) {
    if (depth > kMostNested)
      return fail(where, fmt::format("values are nested more than {} deep", kMostNested));
    if (++values_ > kMostValues)
      return fail(where, fmt::format("more than {} values", kMostValues));
    return ok_;
  }

  SourceSpan at_offset(std::size_t offset) const {
    const std::size_t begin = std::min(offset, text_.size());
    const std::size_t end = std::min(begin + 1, text_.size());
    return {file_, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
  }

  // Of a line and column, from 1 on. Lines are asked for in ascending order, mostly.
  SourceSpan at_line(std::size_t line, std::size_t column) {
    if (line < line_) line_ = 1, line_start_ = 0;
    while (line_ < line) {
      const std::size_t next = text_.find('\n', line_start_);
      if (next == text_.npos) break;
      line_start_ = next + 1;
      ++line_;
    }
    return at_offset(line_start_ + (column > 0 ? column - 1 : 0));
  }

 private:
  std::string_view text_;
  FileId file_;
  Code code_;
  DiagnosticLog& log_;
  std::size_t values_ = 0;
  std::size_t line_ = 1, line_start_ = 0;
  bool ok_ = true;
};

// ---- TOML

class TomlConverter {
 public:
  explicit TomlConverter(ConfigReader& reader) : reader_(reader) {}

  bool convert(const toml::node& node, int depth, ConfigValue& value) {
    const toml::source_position at = node.source().begin;
    value.where = reader_.at_line(at.line, at.column);
    if (!reader_.enter(depth, value.where)) return false;
    if (const auto* table = node.as_table()) {
      // tables come by name: put them into the order of the text
      std::vector<std::pair<const toml::key*, const toml::node*>> members;
      for (const auto& [key, item] : *table) members.emplace_back(&key, &item);
      std::ranges::sort(members, [](const auto& a, const auto& b) {
        const auto x = a.first->source().begin, y = b.first->source().begin;
        return std::pair(x.line, x.column) < std::pair(y.line, y.column);
      });
      auto& map = value.data.emplace<ConfigValue::Map>();
      for (const auto& [key, item] : members) {
        map.push_back({std::string(key->str()), {}});
        if (!convert(*item, depth + 1, map.back().value)) return false;
      }
      return true;
    }
    if (const auto* list = node.as_array()) {
      auto& items = value.data.emplace<ConfigValue::List>();
      for (const toml::node& item : *list)
        if (!convert(item, depth + 1, items.emplace_back())) return false;
      return true;
    }
    if (const auto* text = node.as_string())
      value.data = text->get();
    else if (const auto* flag = node.as_boolean())
      value.data = flag->get();
    else if (const auto number = node.value<double>())
      value.data = *number;
    else
      value.data = date(node);
    return true;
  }

 private:
  static std::string date(const toml::node& node) {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    node.visit([&](const auto& item) {
      if constexpr (toml::is_date<decltype(item)> || toml::is_time<decltype(item)> ||
                    toml::is_date_time<decltype(item)>)
        out << item.get();
    });
    return out.str();
  }

  ConfigReader& reader_;
};

Result<ConfigValue> read_toml(std::string_view text, ConfigReader& reader) {
  try {
    const toml::table parsed = toml::parse(text);
    ConfigValue value;
    if (!TomlConverter(reader).convert(parsed, 0, value)) return failed;
    return value;
  } catch (const toml::parse_error& error) {
    const auto& at = error.source().begin;
    reader.fail(reader.at_line(at.line, at.column),
                fmt::format("invalid TOML: {}", error.description()));
    return failed;
  }
}

// ---- YAML

class YamlConverter {
 public:
  explicit YamlConverter(ConfigReader& reader) : reader_(reader) {}

  bool convert(const YAML::Node& node, int depth, ConfigValue& value) {
    value.where =
        reader_.at_offset(node.Mark().is_null() ? 0 : static_cast<std::size_t>(node.Mark().pos));
    if (!reader_.enter(depth, value.where)) return false;
    if (node.IsMap()) {
      auto& map = value.data.emplace<ConfigValue::Map>();
      std::set<std::string> names;
      for (const auto& member : node) {
        if (!member.first.IsScalar())
          return reader_.fail(value.where, "the name of a value is a list or a map");
        std::string name = member.first.Scalar();
        if (!names.insert(name).second) {
          ConfigValue repeated;
          repeated.where = reader_.at_offset(static_cast<std::size_t>(member.first.Mark().pos));
          return reader_.fail(repeated.where, fmt::format("{} is given twice", in_quotes(name)));
        }
        map.push_back({std::move(name), {}});
        if (!convert(member.second, depth + 1, map.back().value)) return false;
      }
      return true;
    }
    if (node.IsSequence()) {
      auto& items = value.data.emplace<ConfigValue::List>();
      for (const YAML::Node& item : node)
        if (!convert(item, depth + 1, items.emplace_back())) return false;
      return true;
    }
    if (!node.IsScalar()) return true;  // null
    const std::string& word = node.Scalar();
    const bool quoted = node.Tag() == "!";
    const auto number = quoted ? std::nullopt : parse_double(word);
    if (number)
      value.data = *number;
    else if (!quoted && (word == "true" || word == "false"))
      value.data = word == "true";
    else
      value.data = word;
    return true;
  }

 private:
  ConfigReader& reader_;
};

Result<ConfigValue> read_yaml(std::string_view text, ConfigReader& reader) {
  // of OpenCV: no directive of YAML, as that has a blank for the colon
  std::string plain(text);
  if (plain.starts_with("%YAML:")) plain[0] = '#';
  try {
    ConfigValue value;
    if (!YamlConverter(reader).convert(YAML::Load(plain), 0, value)) return failed;
    return value;
  } catch (const YAML::Exception& error) {
    const std::size_t at = error.mark.is_null() ? 0 : static_cast<std::size_t>(error.mark.pos);
    reader.fail(reader.at_offset(at), fmt::format("invalid YAML: {}", error.msg));
    return failed;
  }
}

// Numbers of nested lists, in order; false: others, or far too many.
bool add_numbers(const ConfigValue& value, std::vector<double>& out) {
  constexpr std::size_t kMost = 4096;
  if (const auto* number = std::get_if<double>(&value.data)) {
    out.push_back(*number);
    return std::isfinite(*number) && out.size() <= kMost;
  }
  const auto* list = std::get_if<ConfigValue::List>(&value.data);
  return list != nullptr && std::ranges::all_of(*list, [&](const ConfigValue& item) {
           return add_numbers(item, out);
         });
}

}  // namespace

const ConfigValue* ConfigValue::find(std::string_view name) const {
  const auto* map = std::get_if<Map>(&data);
  if (map == nullptr) return nullptr;
  const auto found = std::ranges::find(*map, name, &ConfigMember::name);
  return found == map->end() ? nullptr : &found->value;
}

std::string_view type_name(const ConfigValue& value) {
  constexpr std::string_view kNames[] = {"nothing", "true or false", "a number",
                                         "text",    "a list",        "a table"};
  return kNames[value.data.index()];
}

Result<ConfigValue> parse_config(std::string_view text, ConfigFormat format, FileId file, Code code,
                                 DiagnosticLog& log) {
  ConfigReader reader(text, file, code, log);
  return format == ConfigFormat::toml ? read_toml(text, reader) : read_yaml(text, reader);
}

void ConfigTable::fail(const ConfigValue& at, std::string message, std::string hint) {
  log_.report(code_, at.where, std::move(message), std::move(hint));
  ok_ = false;
}

const ConfigValue* ConfigTable::find(std::string_view name) {
  asked_.emplace_back(name);
  return value_.find(name);
}

const ConfigValue* ConfigTable::require(std::string_view name) {
  const ConfigValue* found = find(name);
  if (found == nullptr) fail(value_, fmt::format("{} is missing", name));
  return found;
}

const ConfigValue* ConfigTable::find_any(std::initializer_list<std::string_view> names) {
  const auto* map = std::get_if<ConfigValue::Map>(&value_.data);
  if (map == nullptr) return nullptr;
  for (const auto& [key, value] : *map) {
    std::string lower = key;
    for (char& c : lower)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (std::ranges::find(names, lower) == names.end()) continue;
    asked_.push_back(key);
    return &value;
  }
  return nullptr;
}

const ConfigValue* ConfigTable::require_any(std::initializer_list<std::string_view> names) {
  const ConfigValue* found = find_any(names);
  if (found == nullptr) fail(value_, fmt::format("{} is missing", *names.begin()));
  return found;
}

std::optional<std::string> ConfigTable::text(const ConfigValue* member, std::string_view name) {
  if (member == nullptr) return std::nullopt;
  if (const auto* word = std::get_if<std::string>(&member->data)) return *word;
  fail(*member, fmt::format("{} is {}, expected text", name, type_name(*member)));
  return std::nullopt;
}

std::optional<double> ConfigTable::number(const ConfigValue* member, std::string_view name) {
  const auto one = numbers(member, name, {1});
  if (!one) return std::nullopt;
  return one->front();
}

std::optional<bool> ConfigTable::flag(const ConfigValue* member, std::string_view name) {
  if (member == nullptr) return std::nullopt;
  if (const auto* flag = std::get_if<bool>(&member->data)) return *flag;
  fail(*member, fmt::format("{} is {}, expected true or false", name, type_name(*member)));
  return std::nullopt;
}

std::optional<std::vector<double>> ConfigTable::numbers(const ConfigValue* member,
                                                        std::string_view name,
                                                        std::initializer_list<std::size_t> counts) {
  if (member == nullptr) return std::nullopt;
  std::vector<double> out;
  if (!add_numbers(*member, out)) {
    const auto* number = std::get_if<double>(&member->data);  // not finite
    fail(*member, fmt::format("{} is {}, expected {}{}{}", name,
                              number ? fmt::format("{}", *number) : std::string(type_name(*member)),
                              std::max(counts) > 1 ? "" : "a ", number ? "finite " : "",
                              std::max(counts) == 1 ? "number" : "numbers"));
    return std::nullopt;
  }
  if (std::ranges::find(counts, out.size()) == counts.end()) {
    fail(*member, fmt::format("{} has {}, expected {}", name, counted(out.size(), "number"),
                              fmt::join(counts, " or ")));
    return std::nullopt;
  }
  return out;
}

void ConfigTable::finish() {
  const auto* map = std::get_if<ConfigValue::Map>(&value_.data);
  if (map == nullptr) return fail(value_, fmt::format("{}, expected {}", type_name(value_), what_));
  const std::vector<std::string_view> names(asked_.begin(), asked_.end());
  for (const auto& [key, value] : *map) {
    if (std::ranges::find(asked_, key) != asked_.end()) continue;
    const auto near = nearest_name(key, names);
    fail(value,
         fmt::format("{} is no member of {}, or has no effect beside the others", in_quotes(key),
                     what_),
         near ? fmt::format("did you mean '{}'?", *near) : "");
  }
}

}  // namespace panwright
