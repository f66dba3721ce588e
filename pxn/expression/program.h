// Formulas made ready to be evaluated.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pxn/expression/formula.h"

namespace panwright::pxn {

// A formula as steps on a stack of numbers.
//
// All sides of operators are evaluated, && and || included; of ?: the branch that is taken.
// Elementary functions are those of base/math.h: the same bits on every machine.
class Program {
 public:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  // The first operation of a run whose result is not finite.
  struct Broken {
    std::size_t operation = kNone;  // of the formula; none where an operand is not finite
    double values[2] = {0, 0};      // what it was given: the first two
  };

  Program() = default;
  // Expects a formula without a problem. Cost: O(bytes), with no recursion.
  explicit Program(const Formula& formula);

  // Evaluates. operands: the values of the formula's, in their order. Nothing when an operation or
  // the whole has no finite result; broken() then says which. Cost: O(steps).
  std::optional<double> run(std::span<const double> operands);
  const Broken& broken() const { return broken_; }

 private:
  friend class ProgramMaker;

  struct Step {
    enum class Kind : std::uint8_t { operand, unary, binary, several, skip_if_zero, skip };
    Kind kind = Kind::operand;
    std::uint8_t function = 0;         // in the table of its kind
    std::uint16_t operation = 0xffff;  // of the formula; 0xffff: the result is always finite
    std::uint32_t number = 0;          // of the operand, of values, or of the step that comes next
  };

  std::vector<Step> steps_;
  std::vector<double> stack_;
  Broken broken_;
};

}  // namespace panwright::pxn
