// JSON with the places of its values. Private to scenario.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenario/internal/input.h"

namespace panwright::scenario {

enum class JsonKind : std::uint8_t { null, boolean, number, string, list, object };

struct JsonValue {
  JsonKind kind = JsonKind::null;
  std::string_view at;  // its text; of lists and objects the first character
  double number = 0;
  std::string string;
  std::vector<JsonValue> items;
  struct Member;
  std::vector<Member> members;
};

struct JsonValue::Member {
  std::string name;
  std::string_view at;
  JsonValue value;
};

// Parses the whole text of an input: at most 16 values deep, and 4 million values. Reports E8001,
// also for a member that stands twice.
std::optional<JsonValue> parse_json(Input& input);

// Parses a text of one list, or of values one after another (JSON Lines), as a list.
std::optional<JsonValue> parse_json_lines(Input& input);

}  // namespace panwright::scenario
