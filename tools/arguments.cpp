#include "tools/arguments.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>

#include "base/math.h"
#include "base/text.h"
#include "tools/words.h"
#include "workspace/quantities.h"

namespace panwright::tools {

namespace {

template <class Integer>
bool take_integer(const std::string& text, Integer& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size()) return true;
  // "3e8": exact in double precision
  constexpr double kExact = 9007199254740992.0;
  const auto number = parse_double(text);
  constexpr double kMost = static_cast<double>(std::numeric_limits<Integer>::max());
  if (!number || !(*number >= 0 && *number <= std::min(kExact, kMost)) ||
      *number != std::floor(*number))
    return false;
  value = static_cast<Integer>(*number);
  return true;
}

}  // namespace

Argument& Argument::type(const char* name) {
  option_.type = name;
  return *this;
}
Argument& Argument::group(const char* name) {
  option_.group = name;
  return *this;
}
Argument& Argument::required() {
  option_.required = true;
  return *this;
}
Argument& Argument::may_be_empty() {
  option_.may_be_empty = true;
  return *this;
}
Argument& Argument::bare_value(const char* value) {
  option_.bare = value;
  return *this;
}
Argument& Argument::some_of(std::initializer_list<const char*> values, Option::Check accepts) {
  option_.choices.assign(values.begin(), values.end());
  option_.checks.push_back(std::move(accepts));
  return *this;
}
Argument& Argument::one_value() {
  assert(option_.repeatable && !option_.argument);
  return *this;
}
Argument& Argument::numbers() {
  option_.numbers = true;
  return *this;
}
Argument& Argument::excludes(const Argument& other) {
  option_.excluded.push_back(&other.option_);
  return *this;
}
Argument& Argument::some_of(std::span<const std::string_view> values) {
  option_.choices.assign(values.begin(), values.end());
  return *this;
}
Argument& Argument::one_of(std::initializer_list<const char*> values) {
  option_.choices.assign(values.begin(), values.end());
  option_.checks.push_back([&choices = option_.choices](std::string& text) {
    return std::find(choices.begin(), choices.end(), text) != choices.end() ? std::string()
                                                                            : listed(choices, "or");
  });
  return *this;
}
Argument& Argument::range(double least, double most) {
  // numbers that are kept as they were typed are numbers all the same
  const std::string kind = option_.value_words == "a text" ? "a number" : option_.value_words;
  const std::string words =
      fmt::format("{} from {} to {}", kind, format_double(least), format_double(most));
  option_.checks.push_back([=](std::string& text) {
    const auto number = parse_double(text);
    return number && *number >= least && *number <= most ? std::string() : words;
  });
  return *this;
}
Argument& Argument::finite() { return *this; }
Argument& Argument::positive() {
  option_.checks.push_back([](std::string& text) {
    const auto number = parse_double(text);
    return number && *number > 0 ? std::string() : std::string("a number above 0");
  });
  return *this;
}
Argument& Argument::not_negative() {
  option_.checks.push_back([](std::string& text) {
    const auto number = parse_double(text);
    return number && *number >= 0 ? std::string() : std::string("0 or a number above it");
  });
  return *this;
}
Argument& Argument::bytes() {
  option_.checks.push_back([](std::string& text) -> std::string {
    const auto bytes = workspace::parse_bytes(text);
    if (!bytes) return "a number of bytes, as 512MB";
    text = std::to_string(*bytes);
    return {};
  });
  return *this;
}
Argument& Argument::length() {
  option_.checks.push_back([](std::string& text) -> std::string {
    if (parse_double(text)) return {};
    const auto metres = workspace::parse_length(text);
    if (!metres) return "a length, as 2mm or 0.002 (metres)";
    text = format_double(*metres);
    return {};
  });
  return *this;
}
Argument& Argument::angle() {
  option_.checks.push_back([](std::string& text) -> std::string {
    if (parse_double(text)) return {};
    const auto radians = workspace::parse_angle(text);
    if (!radians) return "an angle, as 30deg or 30 (degrees)";
    // note: 30deg is 30, to the digit
    text = text.ends_with("deg") ? text.substr(0, text.size() - 3)
                                 : format_double(*radians * (180 / kPi));
    return {};
  });
  return *this;
}
Argument& Argument::folder() {
  option_.checks.push_back([](std::string& text) {
    std::error_code ignored;
    if (std::filesystem::is_directory(text, ignored)) return std::string();
    const auto up = std::filesystem::path(text).parent_path();
    const bool room = !std::filesystem::exists(text, ignored) &&
                      (up.empty() || std::filesystem::is_directory(up, ignored));
    return std::string(room ? "" : "a folder, or a new one in an existing folder");
  });
  return *this;
}

Option& Arguments::declare(const char* names, const char* help, const char* value_words) {
  Option& option = options_.emplace_back();
  std::string_view rest(names);
  while (!rest.empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    option.names.emplace_back(rest.substr(0, comma));
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
  option.argument = names[0] != '-';
  option.help = help;
  option.value_words = value_words;
  option.type = "TEXT";
  return option;
}

Argument Arguments::add(const char* names, std::string& value, const char* help) {
  Option& option = declare(names, help, "a text");
  option.take = [&value](const std::string& text) { return value = text, true; };
  return Argument(option);
}
Argument Arguments::add(const char* names, std::optional<std::string>& value, const char* help) {
  Option& option = declare(names, help, "a text");
  option.take = [&value](const std::string& text) { return value = text, true; };
  return Argument(option);
}
Argument Arguments::add(const char* names, std::vector<std::string>& values, const char* help) {
  Option& option = declare(names, help, "a text");
  option.repeatable = true;
  option.take = [&values](const std::string& text) { return values.push_back(text), true; };
  return Argument(option);
}
Argument Arguments::add(const char* names, std::uint32_t& value, const char* help) {
  Option& option = declare(names, help, "a whole number");
  option.take = [&value](const std::string& text) { return take_integer(text, value); };
  return Argument(option);
}
Argument Arguments::add(const char* names, std::uint64_t& value, const char* help) {
  Option& option = declare(names, help, "a whole number");
  option.take = [&value](const std::string& text) { return take_integer(text, value); };
  return Argument(option);
}
Argument Arguments::add(const char* names, double& value, const char* help) {
  Option& option = declare(names, help, "a number");
  option.take = [&value](const std::string& text) {
    const auto number = parse_double(text);
    if (number) value = *number;
    return number.has_value();
  };
  return Argument(option);
}
Argument Arguments::add(const char* names, std::optional<double>& value, const char* help) {
  Option& option = declare(names, help, "a number");
  option.take = [&value](const std::string& text) {
    const auto number = parse_double(text);
    if (number) value = *number;
    return number.has_value();
  };
  return Argument(option);
}
Argument Arguments::flag(const char* names, bool& value, const char* help) {
  Option& option = declare(names, help, "");
  option.type.clear();
  option.take = [&value](const std::string&) { return value = true; };
  return Argument(option);
}

}  // namespace panwright::tools
