// JSON with the place of every value. Private to importers/gltf.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace panwright::importers::gltf {

struct Json {
  enum class Kind : std::uint8_t { null, boolean, number, string, array, object };

  Kind kind = Kind::null;
  bool broken = false;  // invalid by the schema
  bool integral = false;
  std::uint32_t offset = 0;  // of the value's last byte; of the first of arrays and objects
  double number = 0;         // booleans: 0 or 1
  std::string text;
  std::vector<Json> items;        // elements, or values of an object
  std::vector<std::string> keys;  // of an object: as many as items, no two the same

  bool is(Kind k) const { return kind == k; }
  const Json* find(std::string_view key) const;  // null: missing, or no object
  Json* find(std::string_view key);
  void erase(std::string_view key);
  // Returns the elements of the array of that name; none if missing.
  const std::vector<Json>& list(std::string_view key) const;
};

struct JsonProblem {
  std::uint64_t offset = 0;
  std::string message;
};

struct ParsedJson {
  Json root;
  std::vector<JsonProblem> repeated;   // keys repeated in one object; the last one counts
  std::optional<JsonProblem> problem;  // none: valid
};

// Parses JSON, at most `depth` deep and `values` long. Cost: O(bytes).
ParsedJson parsed_json(std::string_view text, std::uint32_t depth, std::uint64_t values);

// Appends a value as text, without any `extras`.
void append_json(const Json& value, std::string& text);
void append_json_string(std::string_view value, std::string& text);

}  // namespace panwright::importers::gltf
