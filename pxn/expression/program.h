// Compiled formulas.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pxn/expression/formula.h"

namespace panwright::pxn {

// Precedences: of a choice (?:), the lowest, and of signs.
inline constexpr int kChoice = 0;
inline constexpr int kSign = 7;

struct Unit;

// Formula as steps on a stack of numbers.
//
// All operands of operators are evaluated, && and || included; of ?: only the taken branch.
// Elementary functions are those of base/math.h: the same bits on every machine.
class Program {
 public:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  // First operation of a run without a finite result.
  struct Broken {
    std::size_t operation = kNone;  // of the formula; none if an operand is not finite
    double values[2] = {0, 0};      // its first two arguments
  };

  // Steps of a part of the formula whose value is converted from a unit to SI. Steps are counted
  // without scalings, in order of evaluation: one for each operand, sign, operator and function,
  // one for each ? and one for each :.
  struct Scaling {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
    bool operator==(const Scaling&) const = default;
  };

  Program() = default;
  // Expects a formula without a problem. Cost: O(bytes), with no recursion.
  explicit Program(const Formula& formula);
  // With some parts converted to SI. Expects no two parts with a common end.
  Program(const Formula& formula, std::span<const Scaling> scalings, const Unit& unit);

  // Evaluates. operands: the values of the formula's, in their order. Nothing when an operation or
  // the whole has no finite result; broken() then has it. Cost: O(steps).
  std::optional<double> run(std::span<const double> operands);
  const Broken& broken() const { return broken_; }

 private:
  friend class ProgramMaker;

  struct Step {
    enum class Kind : std::uint8_t { operand, unary, binary, several, scale, skip_if_zero, skip };
    Kind kind = Kind::operand;
    std::uint8_t function = 0;         // in the table of its kind
    std::uint16_t operation = 0xffff;  // of the formula; 0xffff: the result is always finite
    std::uint32_t number = 0;          // of the operand, of values, or of the next step
  };

  std::vector<Step> steps_;
  std::vector<double> stack_;
  const Unit* unit_ = nullptr;  // of scale
  Broken broken_;
};

}  // namespace panwright::pxn
