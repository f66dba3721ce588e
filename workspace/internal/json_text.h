// JSON of unknown origin, with places for diagnostics.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"

namespace panwright::workspace {

struct JsonText {
  nlohmann::json value;
  // Repeated members of an object: of which item of the outermost list (0 without one), and which.
  // JSON leaves their meaning undefined; here the last one counts.
  struct Repeated {
    std::size_t item = 0;
    std::string member;
  };
  std::vector<Repeated> repeated;
};

struct JsonProblem {
  std::string message;        // "invalid JSON at line 2, column 7: unexpected '}'"
  std::string hint;           // may be empty
  bool other_format = false;  // the text begins like no JSON object or list
};

// Parses a text. Values may be nested 16 deep.
//
//   line  number of its first line, for the problem
// Fails: without a report; `problem` has the reason.
Result<JsonText> parse_json(std::string_view text, JsonProblem& problem, std::size_t line = 1);

// Parses JSON Lines into a list, a value of each line that is not blank. Fails: as parse_json().
Result<JsonText> parse_json_lines(std::string_view text, JsonProblem& problem);

// Returns "a list", "text" and so on.
const char* json_type(const nlohmann::json& value);

}  // namespace panwright::workspace
