#include "pxn/expression/dimensions.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

#include "pxn/expression/units.h"

namespace panwright::pxn {

namespace {

using schemas::Dimension;
using Measure = QuantityKind::Measure;

constexpr QuantityKind kPlain{Measure::plain, 0};
constexpr int kMostPower = 100;

// The power of metres in a product; angles, ratios and pixels have none.
int power_of(const QuantityKind& kind) {
  return kind.measure == Measure::length ? 1 : kind.measure == Measure::other ? kind.power : 0;
}

QuantityKind of_power(int power) {
  if (power == 0) return kPlain;
  if (power == 1) return {Measure::length, 0};
  if (power < -kMostPower || power > kMostPower) return {};
  return {Measure::other, power};
}

bool is_measured(const QuantityKind& kind) {
  return kind.measure != Measure::plain && kind.measure != Measure::unknown;
}

QuantityKind product(const QuantityKind& a, const QuantityKind& b) {
  if (a.measure == Measure::unknown || b.measure == Measure::unknown) return {};
  if (const int power = power_of(a) + power_of(b); power_of(a) != 0 || power_of(b) != 0)
    // an angle times a length is an arc
    return of_power(power);
  if (a.measure == Measure::plain) return b;
  if (b.measure == Measure::plain || b.measure == Measure::ratio) return a;
  if (a.measure == Measure::ratio) return b;
  return {};
}

QuantityKind quotient(const QuantityKind& a, const QuantityKind& b) {
  if (a.measure == Measure::unknown || b.measure == Measure::unknown) return {};
  if (power_of(a) != 0 || power_of(b) != 0) return of_power(power_of(a) - power_of(b));
  if (a == b) return kPlain;
  if (b.measure == Measure::plain || b.measure == Measure::ratio) return a;
  return {};
}

QuantityKind root(const QuantityKind& a) {
  if (a.measure == Measure::plain || a.measure == Measure::ratio) return kPlain;
  const int power = power_of(a);
  return power != 0 && power % 2 == 0 ? of_power(power / 2) : QuantityKind{};
}

QuantityKind to_the_power(const QuantityKind& a, std::optional<double> exponent) {
  if (a.measure == Measure::plain || a.measure == Measure::ratio) return kPlain;
  if (power_of(a) == 0 || !exponent) return {};
  const double power = power_of(a) * *exponent;
  if (power != std::floor(power) || std::fabs(power) > kMostPower) return {};
  return of_power(static_cast<int>(power));
}

// Shunting yard over the program of a formula, with kinds for values.
class KindReader {
 public:
  KindReader(const Formula& formula, std::span<const Dimension> dimensions,
             ExpressionProblem& problem)
      : formula_(formula), dimensions_(dimensions), problem_(problem) {}

  std::optional<QuantityKind> run() {
    const std::string& text = formula_.program;
    for (std::size_t at = 0; at < text.size() && !clash_;) at += step(at);
    reduce_to('(');
    if (clash_) return std::nullopt;
    assert(values_.size() == 1);
    return values_.back().kind;
  }

 private:
  struct Value {
    QuantityKind kind;
    std::size_t begin = 0;  // in the text of the expression
    std::size_t end = 0;
    std::optional<double> literal;
  };
  // An operator that waits for its right side, or what is open.
  struct Pending {
    char name;  // ( of parentheses and functions; _ a sign; l g for <= >=, = for == and !=
    int precedence;
    const Function* function = nullptr;
    std::size_t values = 0;  // that stood before the function's own
  };

  static constexpr int kChoice = 0;
  static constexpr int kSign = 7;

  static int precedence_of(char name) {
    switch (name) {
      case '|':
        return 1;
      case '&':
        return 2;
      case '=':
        return 3;
      case '<':
        return 4;
      case '+':
      case '-':
        return 5;
      case '*':
      case '/':
        return 6;
      case '^':
        return 8;
      default:
        return kChoice;
    }
  }

  // The bytes read.
  std::size_t step(std::size_t at) {
    const std::string_view rest = std::string_view(formula_.program).substr(at);
    switch (rest[0]) {
      case ' ':
        return 1;
      case 'v':
        push_operand();
        return 3;
      case 'f':
        pending_.push_back({'(', -1, &kFunctions[rest[1] - 'a'], values_.size()});
        wants_value_ = true;
        return 3;
      case '(':
        pending_.push_back({'(', -1});
        return 1;
      case ')':
        close();
        return 1;
      case ',':
        reduce_to('(');
        wants_value_ = true;
        return 1;
      case '?':
        reduce(kChoice + 1);
        pending_.push_back({'?', kChoice});
        wants_value_ = true;
        return 1;
      case ':':
        reduce_to('?');
        if (!clash_) pending_.back().name = ':';
        wants_value_ = true;
        return 1;
      default:
        return step_operator(rest);
    }
  }

  std::size_t step_operator(std::string_view rest) {
    if (wants_value_) {
      pending_.push_back({rest[0] == '!' ? '!' : '_', kSign});
      return 1;
    }
    const bool two = rest.size() > 1 && (rest[1] == '=' || rest[0] == '&' || rest[0] == '|');
    char name = rest[0];
    if (two && name == '!') name = '=';
    if (name == '>') name = '<';
    const int precedence = precedence_of(name);
    reduce(name == '^' ? precedence + 1 : precedence);
    pending_.push_back({name, precedence});
    wants_value_ = true;
    return two ? 2 : 1;
  }

  void push_operand() {
    const Formula::Operand& operand = formula_.operands[next_];
    Value value{quantity_kind_of(dimensions_[next_]), operand.begin, operand.end, {}};
    if (operand.name.empty()) value.literal = operand.value;
    values_.push_back(value);
    ++next_;
    wants_value_ = false;
  }

  void close() {
    reduce_to('(');
    if (clash_) return;
    const Pending open = pending_.back();
    pending_.pop_back();
    if (open.function != nullptr) call(*open.function, open.values);
    wants_value_ = false;
  }

  // Applies what waits and binds at least as closely.
  void reduce(int precedence) {
    while (!clash_ && !pending_.empty() && pending_.back().precedence >= precedence) apply();
  }
  // Applies what waits, up to what is open.
  void reduce_to(char open) {
    while (!clash_ && !pending_.empty() && pending_.back().name != open) apply();
  }

  Value pop() {
    const Value value = values_.back();
    values_.pop_back();
    return value;
  }

  void apply() {
    const char name = pending_.back().name;
    pending_.pop_back();
    if (name == '_' || name == '!') {
      Value& value = values_.back();
      if (name == '!') value = {kPlain, value.begin, value.end, {}};
      if (value.literal) value.literal = -*value.literal;
      return;
    }
    const Value b = pop();
    Value a = pop();
    if (name == ':') {
      const Value condition = pop();
      const bool same = !is_measured(a.kind) || !is_measured(b.kind) || a.kind == b.kind;
      const QuantityKind kind = same ? common(a.kind, b.kind) : QuantityKind{};
      values_.push_back({kind, condition.begin, b.end, {}});
      return;
    }
    values_.push_back({binary(name, a, b), a.begin, b.end, {}});
  }

  QuantityKind binary(char name, const Value& a, const Value& b) {
    switch (name) {
      case '+':
      case '-':
        return alike(a, b, name == '+' ? "added" : "subtracted");
      case '*':
        return product(a.kind, b.kind);
      case '/':
        return quotient(a.kind, b.kind);
      case '^':
        return to_the_power(a.kind, b.literal);
      case '<':
      case '=':
        alike(a, b, "compared");
        return kPlain;
      default:
        return kPlain;
    }
  }

  static QuantityKind common(const QuantityKind& a, const QuantityKind& b) {
    if (a.measure == Measure::unknown || b.measure == Measure::unknown) return {};
    return a.measure == Measure::plain ? b : a;
  }

  QuantityKind alike(const Value& a, const Value& b, std::string_view verb) {
    if (!is_measured(a.kind) || !is_measured(b.kind) || a.kind == b.kind)
      return common(a.kind, b.kind);
    fail(a.begin, b.end,
         fmt::format("{} and {} cannot be {}", name_of(a.kind), name_of(b.kind), verb));
    return {};
  }

  void call(const Function& function, std::size_t first) {
    const std::string_view name = function.name;
    const std::span<const Value> values = std::span(values_).subspan(first);
    const Value& a = values.front();
    QuantityKind kind = kPlain;
    if (function.most > 1) {
      // min, max, mod, hypot, atan2
      kind = a.kind;
      for (const Value& value : values) {
        if (is_measured(kind) && is_measured(value.kind) && kind != value.kind)
          return fail(a.begin, values.back().end,
                      fmt::format("{} expects values of one dimension, got {} and {}", name,
                                  name_of(kind), name_of(value.kind)));
        kind = common(kind, value.kind);
      }
      if (name == "atan2") kind = kPlain;
    } else if (name == "sin" || name == "cos" || name == "tan") {
      if (power_of(a.kind) != 0 || a.kind.measure == Measure::pixels)
        return fail(a.begin, a.end,
                    fmt::format("{} expects an angle, got {}", name, name_of(a.kind)));
    } else if (name == "sqrt") {
      kind = root(a.kind);
    } else if (name == "abs" || name == "floor" || name == "ceil" || name == "round") {
      kind = a.kind;
    }
    const Value result{kind, a.begin, values.back().end, {}};
    values_.resize(first);
    values_.push_back(result);
  }

  void fail(std::size_t begin, std::size_t end, std::string message) {
    clash_ = true;
    problem_ = {Code::E1212, begin, end, std::move(message),
                "inside braces bare numbers are in metres and radians"};
  }

  const Formula& formula_;
  std::span<const Dimension> dimensions_;
  ExpressionProblem& problem_;
  std::vector<Value> values_;
  std::vector<Pending> pending_;
  std::size_t next_ = 0;
  bool wants_value_ = true;
  bool clash_ = false;
};

}  // namespace

QuantityKind quantity_kind_of(Dimension dimension) {
  switch (dimension) {
    case Dimension::length:
      return {Measure::length, 0};
    case Dimension::angle:
      return {Measure::angle, 0};
    case Dimension::ratio:
      return {Measure::ratio, 0};
    case Dimension::pixels:
      return {Measure::pixels, 0};
    case Dimension::none:
      break;
  }
  return kPlain;
}

std::string name_of(const QuantityKind& kind) {
  switch (kind.measure) {
    case Measure::length:
      return std::string(name_of(Dimension::length));
    case Measure::angle:
      return std::string(name_of(Dimension::angle));
    case Measure::ratio:
      return std::string(name_of(Dimension::ratio));
    case Measure::pixels:
      return std::string(name_of(Dimension::pixels));
    case Measure::other:
      if (kind.power == 2) return "an area";
      if (kind.power == 3) return "a volume";
      return fmt::format("a length to the power {}", kind.power);
    case Measure::plain:
    case Measure::unknown:
      break;
  }
  return std::string(name_of(Dimension::none));
}

std::optional<QuantityKind> quantity_kind_of(const Formula& formula,
                                             std::span<const Dimension> dimensions,
                                             ExpressionProblem& problem) {
  return KindReader(formula, dimensions, problem).run();
}

}  // namespace panwright::pxn
