// Parsed and checked text of an expression.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "schemas/generated/pxn_schema.h"

namespace panwright::pxn {

struct Unit;

// Problem of an expression, with the bytes of its text.
struct ExpressionProblem {
  Code code = Code("E1221");
  std::size_t begin = 0;
  std::size_t end = 0;
  std::string message;
  std::string hint;
};

struct Function {
  std::string_view name;
  std::uint32_t least;  // values
  std::uint32_t most;
};
inline constexpr Function kFunctions[] = {
    {"sin", 1, 1},  {"cos", 1, 1},   {"tan", 1, 1},   {"asin", 1, 1},   {"acos", 1, 1},
    {"atan", 1, 1}, {"atan2", 2, 2}, {"exp", 1, 1},   {"log", 1, 1},    {"log10", 1, 1},
    {"sqrt", 1, 1}, {"abs", 1, 1},   {"floor", 1, 1}, {"ceil", 1, 1},   {"round", 1, 1},
    {"sign", 1, 1}, {"mod", 2, 2},   {"hypot", 2, 2}, {"min", 1, 1000}, {"max", 1, 1000},
};

// Returns true if a name is that of a constant or a function.
inline bool is_built_in(std::string_view name) {
  if (name == "pi" || name == "tau") return true;
  for (const Function& f : kFunctions)
    if (f.name == name) return true;
  return false;
}

inline constexpr std::size_t kLongestExpression = 4096;  // bytes

struct Formula {
  // Number or name of the text, in its order.
  struct Operand {
    double value = 0;  // of a number: a length in the reader's unit, else in SI
    schemas::Dimension dimension = schemas::Dimension::none;
    std::string name;  // empty: a number
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
  };
  // Operation that may have no finite result: + - * / ^ and functions.
  struct Operation {
    std::string_view name;
    std::uint32_t at = 0;  // of its first character in `program`
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
  };

  // Expression with operands and functions by number: "v00*fb(v01)". Expressions that differ only
  // in numbers and names have the same.
  std::string program;
  std::vector<Operand> operands;
  std::vector<Operation> operations;
  std::optional<ExpressionProblem> problem;  // nothing else is valid then
};

// Returns the name of the n-th operand in programs, n < 3844.
std::string operand_name(std::size_t n);

// Parses the text between the braces: C's operators and precedences, with ^ for powers (to the
// right, and before signs: -2^2 is -4). Comparisons do not chain.
//
// length: the unit of lengths in values; nullptr: metres.
//
// Problems: E1213, E1221, E1222 (functions), E1223 (a number past 1.8e308). Cost: O(bytes).
Formula read_formula(std::string_view text, const Unit* length = nullptr);

}  // namespace panwright::pxn
