// Reader of one table of an instrument's file: numbers within bounds, words of a list. Private to
// instruments.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "base/config_text.h"
#include "base/math.h"
#include "base/text.h"

namespace panwright::instruments {

// All bounds are those of the file, both included; a value is set where it is given and sound.
class BoundedTable : public ConfigTable {
 public:
  using ConfigTable::ConfigTable;

  // Sets a number, in units of `unit`. Returns whether it did.
  bool set(std::string_view name, double& value, double least, double most, double unit = 1) {
    const ConfigValue* member = find(name);
    const auto given = number(member, name);
    if (!given) return false;
    if (*given >= least && *given <= most) {
      value = *given * unit;
      return true;
    }
    fail(*member, fmt::format("{} is {}, expected {} to {}", name, *given, least, most));
    return false;
  }

  void set_decibels(std::string_view name, double& value, double least, double most) {
    double level = 0;
    if (set(name, level, least, most)) value = det::pow(10, level / 10);
  }

  void set_count(std::string_view name, std::uint32_t& value, std::uint32_t least,
                 std::uint32_t most) {
    const ConfigValue* member = find(name);
    const auto given = number(member, name);
    if (!given) return;
    if (*given >= least && *given <= most && *given == std::floor(*given))
      value = static_cast<std::uint32_t>(*given);
    else
      fail(*member, fmt::format("{} is {}, expected a whole number from {} to {}", name, *given,
                                least, most));
  }

  // Sets two numbers.
  void set_pair(std::string_view name, Vec2& value, double least, double most, double unit = 1) {
    const ConfigValue* member = find(name);
    const auto given = numbers(member, name, {2});
    if (!given) return;
    for (const double each : *given)
      if (!(each >= least && each <= most)) {
        fail(*member, fmt::format("{} has {}, expected {} to {}", name, each, least, most));
        return;
      }
    value = unit * Vec2((*given)[0], (*given)[1]);
  }

  void set_flag(std::string_view name, bool& value) {
    if (const auto given = flag(name)) value = *given;
  }

  // Sets the number of the chosen word; the first word is 0.
  template <class Choice>
  void choose(std::string_view name, std::span<const std::string_view> words, Choice& value) {
    const ConfigValue* member = find(name);
    const auto given = text(member, name);
    if (!given) return;
    const auto at = std::ranges::find(words, *given);
    if (at != words.end()) {
      value = static_cast<Choice>(at - words.begin());
      return;
    }
    const auto near = nearest_name(*given, words);
    fail(*member,
         fmt::format("{} is {}, expected {}", name, in_quotes(*given), fmt::join(words, ", ")),
         near ? fmt::format("did you mean '{}'?", *near) : "");
  }
};

}  // namespace panwright::instruments
