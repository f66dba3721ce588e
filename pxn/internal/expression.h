// Values of expressions.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "pxn/internal/formula.h"
#include "pxn/internal/scope.h"

namespace panwright::pxn {

// The value of an expression, in SI, and what it measures as far as that can be told.
struct Measured {
  enum class Measure : std::uint8_t {
    unknown,
    plain,
    length,
    angle,
    other
  } measure = Measure::unknown;
  double value = 0;
  int power = 0;  // of other: metres to this power, never 0 or 1
};

// Evaluates expressions, and keeps what it has read of them: an expression of the same place is
// read once, however often it is evaluated.
//
// Elementary functions are those of base/math.h: the same bits on every machine. Every operation
// that is evaluated must have a finite result; the branch of ?: that is not taken is not evaluated.
//
// What a value measures is found by scaling all lengths, then all angles, and looking at how the
// value follows: "width/2 + 5mm" doubles with them and is a length, "width*height" is none.
class Expressions {
 public:
  Expressions();
  ~Expressions();
  Expressions(const Expressions&) = delete;
  Expressions& operator=(const Expressions&) = delete;

  // text: between the braces. place: the same number for the same text only.
  //
  // Problems: E1213, E1221 to E1223.
  std::optional<Measured> evaluate(std::string_view text, std::uint64_t place, const Scope* scope,
                                   ExpressionProblem& problem);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace panwright::pxn
