#include "pxn/expression/program.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/math.h"
#include "pxn/expression/units.h"

namespace panwright::pxn {

namespace {

using Unary = double (*)(double);
using Binary = double (*)(double, double);
using Several = double (*)(std::span<const double>);

double modulo(double a, double b) {
  const double rest = std::fmod(a, b);
  return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}

struct NamedUnary {
  std::string_view name;
  Unary call;
};
struct NamedBinary {
  std::string_view name;
  Binary call;
  int precedence = 0;  // of operators; functions have none
};
struct NamedSeveral {
  std::string_view name;
  Several call;
};

constexpr NamedUnary kUnary[] = {
    {"-", [](double a) { return -a; }},
    {"!", [](double a) { return double(a == 0); }},
    {"sin", det::sin},
    {"cos", det::cos},
    {"tan", det::tan},
    {"asin", det::asin},
    {"acos", det::acos},
    {"atan", det::atan},
    {"exp", det::exp},
    {"log", det::log},
    {"log10", det::log10},
    {"sqrt", [](double a) { return std::sqrt(a); }},
    {"abs", [](double a) { return std::fabs(a); }},
    {"floor", [](double a) { return std::floor(a); }},
    {"ceil", [](double a) { return std::ceil(a); }},
    {"round", [](double a) { return std::round(a); }},
    {"sign", [](double a) { return double(a > 0) - double(a < 0); }},
};
constexpr NamedBinary kBinary[] = {
    // operators of two characters first: one of one is the beginning of some
    {"||", [](double a, double b) { return double(a != 0 || b != 0); }, 1},
    {"&&", [](double a, double b) { return double(a != 0 && b != 0); }, 2},
    {"==", [](double a, double b) { return double(a == b); }, 3},
    {"!=", [](double a, double b) { return double(a != b); }, 3},
    {"<=", [](double a, double b) { return double(a <= b); }, 4},
    {">=", [](double a, double b) { return double(a >= b); }, 4},
    {"<", [](double a, double b) { return double(a < b); }, 4},
    {">", [](double a, double b) { return double(a > b); }, 4},
    {"+", [](double a, double b) { return a + b; }, 5},
    {"-", [](double a, double b) { return a - b; }, 5},
    {"*", [](double a, double b) { return a * b; }, 6},
    {"/", [](double a, double b) { return a / b; }, 6},
    {"^", det::pow, 8},
    {"atan2", det::atan2},
    {"mod", modulo},
    {"hypot", det::hypot},
};
constexpr NamedSeveral kSeveral[] = {
    {"min", [](std::span<const double> v) { return *std::min_element(v.begin(), v.end()); }},
    {"max", [](std::span<const double> v) { return *std::max_element(v.begin(), v.end()); }},
};

constexpr int kPower = 8;  // to the right, and before signs
constexpr int kOpen = -1;

template <typename Table>
std::optional<std::uint8_t> find(const Table& table, std::string_view name) {
  for (std::size_t i = 0; i < std::size(table); ++i)
    if (table[i].name == name) return static_cast<std::uint8_t>(i);
  return std::nullopt;
}

}  // namespace

// Shunting yard over the text of a formula's program.
class ProgramMaker {
 public:
  ProgramMaker(const Formula& formula, Program& out)
      : formula_(formula), text_(formula.program), out_(out) {}

  void run() {
    out_.steps_.reserve(2 * formula_.operands.size() + 4);
    waiting_.reserve(16);
    while (at_ < text_.size()) {
      if (wants_value_)
        value();
      else
        operation();
    }
    reduce(kOpen);
    assert(waiting_.empty() && depth_ == 1);
    out_.stack_.resize(deepest_);
  }

 private:
  using Step = Program::Step;
  struct Waiting {
    int precedence = kOpen;
    Step step;                   // what to do when its right side is there
    std::uint32_t to_patch = 0;  // of ?: the skip whose end is not known yet
    bool is_function = false;
    std::size_t depth = 0;  // before a function's values
  };

  // The number of the operation that stands at the place at hand.
  std::uint16_t operation_here() {
    if (next_ >= formula_.operations.size() || formula_.operations[next_].at != at_) return 0xffff;
    return static_cast<std::uint16_t>(next_++);
  }

  void add(const Step& step) {
    switch (step.kind) {
      case Step::Kind::operand:
        ++depth_;
        break;
      case Step::Kind::binary:
      case Step::Kind::skip_if_zero:
      case Step::Kind::skip:  // the other branch makes the value anew
        --depth_;
        break;
      case Step::Kind::several:
        depth_ -= step.number - 1;
        break;
      case Step::Kind::unary:
      case Step::Kind::scale:
        break;
    }
    deepest_ = std::max(deepest_, depth_);
    out_.steps_.push_back(step);
  }
  std::uint32_t here() const { return static_cast<std::uint32_t>(out_.steps_.size()); }

  // Does what waits and binds more tightly than `precedence`, up to what is open.
  void reduce(int precedence) {
    while (!waiting_.empty() && waiting_.back().precedence > precedence) {
      const Waiting& last = waiting_.back();
      if (last.precedence == kChoice)
        out_.steps_[last.to_patch].number = here();
      else
        add(last.step);
      waiting_.pop_back();
    }
  }

  void value() {
    const char c = text_[at_];
    if (c == ' ') {
      ++at_;
    } else if (c == 'v') {
      add({Step::Kind::operand, 0, 0xffff, operands_++});
      at_ += 3;
      wants_value_ = false;
    } else if (c == 'f') {
      open_function();
    } else if (c == '(') {
      waiting_.push_back({});
      ++at_;
    } else {
      const Step sign{Step::Kind::unary, *find(kUnary, text_.substr(at_, 1)), 0xffff, 0};
      waiting_.push_back({kSign, sign});
      ++at_;
    }
  }

  void open_function() {
    const Function& function = kFunctions[static_cast<std::size_t>(text_[at_ + 1] - 'a')];
    Waiting open;
    open.is_function = true;
    open.depth = depth_;
    open.step.operation = operation_here();
    if (const auto one = find(kUnary, function.name)) {
      open.step.kind = Step::Kind::unary;
      open.step.function = *one;
    } else if (const auto two = find(kBinary, function.name)) {
      open.step.kind = Step::Kind::binary;
      open.step.function = *two;
    } else {
      open.step.kind = Step::Kind::several;
      open.step.operation = 0xffff;  // one of its values
      open.step.function = *find(kSeveral, function.name);
    }
    waiting_.push_back(open);
    at_ += 3;
  }

  void operation() {
    switch (text_[at_]) {
      case ' ':
        ++at_;
        return;
      case '?':
        return question();
      case ':':
        return colon();
      case ',':
        reduce(kOpen);
        ++at_;
        wants_value_ = true;
        return;
      case ')':
        return close();
      default:
        return binary();
    }
  }

  void question() {
    reduce(kChoice);
    Waiting choice;
    choice.to_patch = here();
    add({Step::Kind::skip_if_zero, 0, 0xffff, 0});
    waiting_.push_back(choice);  // as what is open: only its ':' ends it
    ++at_;
    wants_value_ = true;
  }

  void colon() {
    reduce(kOpen);
    Waiting choice = waiting_.back();
    waiting_.pop_back();
    const std::uint32_t skip = here();
    add({Step::Kind::skip, 0, 0xffff, 0});
    out_.steps_[choice.to_patch].number = here();
    choice.to_patch = skip;
    choice.precedence = kChoice;
    waiting_.push_back(choice);
    ++at_;
    wants_value_ = true;
  }

  void close() {
    reduce(kOpen);
    Waiting open = waiting_.back();
    waiting_.pop_back();
    if (open.is_function) {
      open.step.number = static_cast<std::uint32_t>(depth_ - open.depth);
      add(open.step);
    }
    ++at_;
  }

  void binary() {
    for (std::size_t i = 0; i < std::size(kBinary); ++i) {
      const NamedBinary& known = kBinary[i];
      if (known.precedence == 0 || !text_.substr(at_).starts_with(known.name)) continue;
      reduce(known.precedence == kPower ? kPower : known.precedence - 1);
      const Step step{Step::Kind::binary, static_cast<std::uint8_t>(i), operation_here(), 0};
      waiting_.push_back({known.precedence, step});
      at_ += known.name.size();
      wants_value_ = true;
      return;
    }
    assert(false && "a formula without a problem");
  }

  const Formula& formula_;
  std::string_view text_;
  Program& out_;
  std::size_t at_ = 0;
  bool wants_value_ = true;
  std::uint32_t operands_ = 0;
  std::size_t next_ = 0;  // of the operations
  std::size_t depth_ = 0;
  std::size_t deepest_ = 0;
  std::vector<Waiting> waiting_;
};

Program::Program(const Formula& formula) { ProgramMaker(formula, *this).run(); }

Program::Program(const Formula& formula, std::span<const Scaling> scalings, const Unit& unit)
    : Program(formula) {
  if (scalings.empty()) return;
  unit_ = &unit;
  // those that stand before each step
  std::vector<std::uint32_t> before(steps_.size() + 1, 0);
  for (const Scaling& scaling : scalings) ++before[scaling.end];
  std::vector<bool> here(steps_.size() + 1, false);
  for (std::size_t i = 0; i < before.size(); ++i) {
    here[i] = before[i] != 0;
    if (i > 0) before[i] += before[i - 1];
  }
  std::vector<Step> steps;
  steps.reserve(steps_.size() + scalings.size());
  for (std::uint32_t i = 0; i <= steps_.size(); ++i) {
    if (here[i]) steps.push_back({Step::Kind::scale, 0, 0xffff, 0});
    if (i == steps_.size()) break;
    Step step = steps_[i];
    if (step.kind == Step::Kind::skip || step.kind == Step::Kind::skip_if_zero) {
      const std::uint32_t target = step.number;
      // a choice that is scaled as a whole ends with it, a branch that is not scaled goes past it
      const bool inside = std::any_of(
          scalings.begin(), scalings.end(),
          [&](const Scaling& scaling) { return scaling.end == target && scaling.begin <= i; });
      step.number += before[target] - (inside ? 1 : 0);
    }
    steps.push_back(step);
  }
  steps_ = std::move(steps);
}

std::optional<double> Program::run(std::span<const double> operands) {
  double* top = stack_.data();  // past the last value
  for (std::size_t at = 0; at < steps_.size(); ++at) {
    const Step& step = steps_[at];
    double a = 0, b = 0;
    switch (step.kind) {
      case Step::Kind::operand:
        *top++ = operands[step.number];
        continue;
      case Step::Kind::skip_if_zero:
        if (*--top == 0) at = step.number - 1;
        continue;
      case Step::Kind::skip:
        at = step.number - 1;
        continue;
      case Step::Kind::scale:
        top[-1] = to_si(top[-1], *unit_);
        continue;
      case Step::Kind::unary:
        a = top[-1];
        top[-1] = kUnary[step.function].call(a);
        break;
      case Step::Kind::binary:
        b = *--top;
        a = top[-1];
        top[-1] = kBinary[step.function].call(a, b);
        break;
      case Step::Kind::several:
        top -= step.number - 1;
        a = top[-1];
        top[-1] = kSeveral[step.function].call({top - 1, step.number});
        break;
    }
    if (step.operation != 0xffff && !std::isfinite(top[-1])) {
      broken_ = {step.operation, {a, b}};
      return std::nullopt;
    }
  }
  broken_ = {};
  return std::isfinite(top[-1]) ? std::optional(top[-1]) : std::nullopt;
}

}  // namespace panwright::pxn
