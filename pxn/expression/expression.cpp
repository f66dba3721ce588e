#include "pxn/expression/expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/math.h"
#include "base/text.h"
#include "pxn/expression/program.h"

namespace panwright::pxn {

namespace {

using schemas::Dimension;

constexpr std::size_t kFormulas = 1 << 14;  // beyond these, what is read is not kept

// ---- what a value measures

// The k of scaled = value·2^k, where there is one.
std::optional<int> power_of(double value, double scaled) {
  constexpr int kMost = 6;
  constexpr double kSlack = 1e-12;  // powers and roots are rounded
  const double ratio = scaled / value;
  for (int k = -kMost; k <= kMost; ++k)
    if (std::fabs(std::ldexp(ratio, -k) - 1) <= kSlack) return k;
  return std::nullopt;
}

}  // namespace

struct Expressions::Implementation {
  struct Entry {
    Formula formula;
    Program program;
    std::optional<QuantityKind> kind;  // for operands of these dimensions
    std::vector<Dimension> quantity_kind_of;
  };

  std::unordered_map<std::uint64_t, Entry> entries;
  Entry passing;  // of a place that is not kept
  std::vector<double> inputs;
  std::vector<double> scaled;
  std::vector<Dimension> dimensions;

  Entry& entry_of(std::string_view text, std::uint64_t place) {
    const auto found = entries.find(place);
    if (found != entries.end()) return found->second;
    Entry& entry = entries.size() < kFormulas ? entries[place] : passing;
    entry = {read_formula(text), {}, {}, {}};
    if (!entry.formula.problem) entry.program = Program(entry.formula);
    return entry;
  }

  bool bind(const Formula& formula, const Scope* scope, ExpressionProblem& problem) {
    inputs.clear();
    dimensions.clear();
    for (const Formula::Operand& operand : formula.operands) {
      if (operand.name.empty()) {
        inputs.push_back(operand.value);
        dimensions.push_back(operand.dimension);
        continue;
      }
      const Quantity* known = scope == nullptr ? nullptr : scope->find(operand.name);
      if (known == nullptr && operand.name != "pi" && operand.name != "tau") {
        unknown_name(operand, scope, problem);
        return false;
      }
      inputs.push_back(known != nullptr ? known->value : operand.name == "pi" ? kPi : 2 * kPi);
      dimensions.push_back(known != nullptr ? known->dimension : Dimension::none);
    }
    return true;
  }

  static void unknown_name(const Formula::Operand& operand, const Scope* scope,
                           ExpressionProblem& problem) {
    problem = {Code::E1222, operand.begin, operand.end, "", ""};
    std::vector<std::string_view> names;
    if (scope != nullptr) names = scope->names();
    const bool none = names.empty();
    names.push_back("pi");
    names.push_back("tau");
    const bool is_function = std::any_of(std::begin(kFunctions), std::end(kFunctions),
                                         [&](const Function& f) { return f.name == operand.name; });
    problem.message = fmt::format("{} is not a parameter or variable{}", in_quotes(operand.name),
                                  none ? "; there are none here" : " that is known here");
    if (is_function)
      problem.hint = fmt::format("functions take their values in parentheses: {}(…)", operand.name);
    else if (const auto near = nearest_name(operand.name, names); near && operand.name.size() > 1)
      problem.hint = fmt::format("did you mean '{}'?", *near);
  }

  std::optional<double> run_scaled(Program& program, double lengths, double angles) {
    scaled = inputs;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      if (dimensions[i] == Dimension::length) scaled[i] *= lengths;
      if (dimensions[i] == Dimension::angle) scaled[i] *= angles;
    }
    return program.run(scaled);
  }

  // How a value follows the inputs of a dimension: the power, where it is one.
  std::optional<int> follows(Program& program, Dimension dimension, double value) {
    if (std::find(dimensions.begin(), dimensions.end(), dimension) == dimensions.end()) return 0;
    if (value == 0) return std::nullopt;
    const auto power_at = [&](double factor) -> std::optional<int> {
      const bool lengths = dimension == Dimension::length;
      const auto there = run_scaled(program, lengths ? factor : 1, lengths ? 1 : factor);
      return there ? power_of(value, *there) : std::nullopt;
    };
    const auto up = power_at(2);
    if (!up) return std::nullopt;
    // a comparison that turns over looks like a power in one direction only
    const auto down = power_at(0.5);
    return down && *down == -*up ? up : std::nullopt;
  }

  // The kind of an entry's value, as far as its text tells; nothing where kinds clash.
  bool find_kind(Entry& entry, ExpressionProblem& problem) const {
    if (entry.kind && entry.quantity_kind_of == dimensions) return true;
    entry.kind = quantity_kind_of(entry.formula, dimensions, problem);
    entry.quantity_kind_of = dimensions;
    return entry.kind.has_value();
  }

  // The kind of a value from how it follows its operands.
  QuantityKind measured(Program& program, double value) {
    using Measure = QuantityKind::Measure;
    const auto length = follows(program, Dimension::length, value);
    const auto angle = follows(program, Dimension::angle, value);
    if (!length || (*length == 0 && !angle)) return {};
    if (*length == 1) return {Measure::length, 0};
    if (*length != 0) return {Measure::other, *length};
    if (*angle == 0) return {Measure::plain, 0};
    return {*angle == 1 ? Measure::angle : Measure::unknown, 0};
  }

  static void not_finite(const Entry& entry, std::size_t size, ExpressionProblem& problem) {
    problem = {Code::E1223, 0, size, "it has no finite value", ""};
    const Program::Broken& seen = entry.program.broken();
    if (seen.operation == Program::kNone) return;
    const Formula::Operation& operation = entry.formula.operations[seen.operation];
    problem.begin = operation.begin;
    problem.end = operation.end;
    const std::string a = format_double(seen.values[0]);
    const std::string b = format_double(seen.values[1]);
    const auto known = std::find_if(std::begin(kFunctions), std::end(kFunctions),
                                    [&](const Function& f) { return f.name == operation.name; });
    if (known == std::end(kFunctions))
      problem.message = fmt::format("{} {} {} has no finite value",
                                    seen.values[0] < 0 ? "(" + a + ")" : a, operation.name, b);
    else
      problem.message = fmt::format("{}({}{}) has no finite value", operation.name, a,
                                    known->most > 1 ? ", " + b : "");
    const bool divides = operation.name == "/" || operation.name == "mod";
    if (divides && seen.values[1] == 0) problem.hint = "condition ? value : other can leave it out";
  }
};

Expressions::Expressions() : implementation_(std::make_unique<Implementation>()) {}
Expressions::~Expressions() = default;

std::optional<Measured> Expressions::evaluate(std::string_view text, std::uint64_t place,
                                              const Scope* scope, ExpressionProblem& problem) {
  Implementation& own = *implementation_;
  Implementation::Entry& entry = own.entry_of(text, place);
  if (entry.formula.problem) {
    problem = *entry.formula.problem;
    return std::nullopt;
  }
  if (!own.bind(entry.formula, scope, problem)) return std::nullopt;
  if (!own.find_kind(entry, problem)) return std::nullopt;
  const auto value = entry.program.run(own.inputs);
  if (value)
    return Measured{*value, entry.kind->measure != QuantityKind::Measure::unknown
                                ? *entry.kind
                                : own.measured(entry.program, *value)};
  own.not_finite(entry, text.size(), problem);
  return std::nullopt;
}

}  // namespace panwright::pxn
