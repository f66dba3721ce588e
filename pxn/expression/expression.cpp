#include "pxn/expression/expression.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/math.h"
#include "base/text.h"
#include "pxn/expression/program.h"
#include "pxn/expression/units.h"

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
    std::optional<Analysis> analysis;  // for operands of these kinds
    std::vector<OperandKind> kinds;
    std::vector<Program::Scaling> scalings;  // of `program`
  };

  std::unordered_map<std::uint64_t, Entry> entries;
  Entry passing;  // of a place that is not kept
  std::vector<double> inputs;
  std::vector<double> scaled;
  std::vector<OperandKind> kinds;
  BareUnits bare;

  Entry& entry_of(std::string_view text, std::uint64_t place) {
    const auto found = entries.find(place);
    if (found != entries.end()) return found->second;
    Entry& entry = entries.size() < kFormulas ? entries[place] : passing;
    entry = {read_formula(text, bare.length), {}, {}, {}, {}};
    if (!entry.formula.problem) entry.program = Program(entry.formula);
    return entry;
  }

  bool bind(const Formula& formula, const Scope* scope, ExpressionProblem& problem) {
    inputs.clear();
    kinds.clear();
    for (const Formula::Operand& operand : formula.operands) {
      if (operand.name.empty()) {
        inputs.push_back(operand.value);
        kinds.push_back({operand.dimension});
        continue;
      }
      const Quantity* known = scope == nullptr ? nullptr : scope->find(operand.name);
      if (known == nullptr && operand.name != "pi" && operand.name != "tau") {
        unknown_name(operand, scope, problem);
        return false;
      }
      if (known != nullptr)
        bind(*known);
      else
        bind({operand.name == "pi" ? kPi : 2 * kPi, Dimension::none, 0, 0, 1});
    }
    return true;
  }

  void bind(const Quantity& known) {
    OperandKind kind{known.dimension, 0, 0, known.pi, known.ratio};
    double value = known.value;
    if (known.dimension == Dimension::length) {
      const double metres = known.length != 0 ? known.length : 1;
      if (metres != bare.length->factor)
        value = in_unit(value, *find_unit(Dimension::length, metres), *bare.length);
    } else if (known.dimension == Dimension::none) {
      if (known.length != bare.length->factor) kind.other_length = known.length;
      if (known.angle != bare.angle->factor) kind.other_angle = known.angle;
    }
    inputs.push_back(value);
    kinds.push_back(kind);
  }

  static void unknown_name(const Formula::Operand& operand, const Scope* scope,
                           ExpressionProblem& problem) {
    problem = {Code("E1222"), operand.begin, operand.end, "", ""};
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
      if (kinds[i].dimension == Dimension::length) scaled[i] *= lengths;
      if (kinds[i].dimension == Dimension::angle) scaled[i] *= angles;
    }
    return program.run(scaled);
  }

  // How a value follows the inputs of a dimension: the power, where it is one.
  std::optional<int> follows(Program& program, Dimension dimension, double value) {
    if (std::none_of(kinds.begin(), kinds.end(),
                     [&](const OperandKind& kind) { return kind.dimension == dimension; }))
      return 0;
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

  // What an entry's text tells of its value; false where kinds clash.
  bool analyse_entry(Entry& entry, std::string_view text, const std::optional<Need>& need,
                     ExpressionProblem& problem) {
    if (entry.analysis && entry.kinds == kinds) return true;
    entry.analysis = analyse(entry.formula, text, kinds, bare, need, problem);
    entry.kinds = kinds;
    if (!entry.analysis) return false;
    if (entry.scalings == entry.analysis->scalings) return true;
    entry.scalings = entry.analysis->scalings;
    entry.program = Program(entry.formula, entry.scalings, *bare.angle);
    return true;
  }

  // Notes what bare numbers stand for; false where one has stood for something else.
  bool note_uses(const Entry& entry, const Scope* scope, ExpressionProblem& problem) const {
    for (const Analysis::NameUse& each : entry.analysis->uses) {
      const Formula::Operand& operand = entry.formula.operands[each.operand];
      const Quantity* const known = scope == nullptr ? nullptr : scope->find(operand.name);
      // those of repeats are numbers in every place
      if (known == nullptr || known->length == 0 || known->pi != 0) continue;
      const std::uint8_t uses = known->uses | each.use;
      const bool lengths = (uses & Quantity::as_length) != 0 && bare.length->factor != 1;
      const bool angles = (uses & Quantity::as_angle) != 0 && bare.angle->factor != 1;
      if ((uses & (uses - 1)) != 0 && (lengths || angles)) {
        two_meanings(operand, *known, each.use, lengths, problem);
        return false;
      }
      known->uses = uses;
    }
    return true;
  }

  void two_meanings(const Formula::Operand& operand, const Quantity& known, Quantity::Use use,
                    bool lengths, ExpressionProblem& problem) const {
    const auto name = [](std::uint8_t each) {
      return name_of((each & Quantity::as_length) != 0  ? Dimension::length
                     : (each & Quantity::as_angle) != 0 ? Dimension::angle
                                                        : Dimension::none);
    };
    const std::string_view unit = lengths ? bare.length->name : bare.angle->name;
    const std::string number = format_double(known.value);
    problem = {Code("E1212"), operand.begin, operand.end,
               fmt::format("the bare number {} = {} is {} here, and {} elsewhere", operand.name,
                           number, name(use), name(known.uses)),
               fmt::format("give it a unit, value=\"{0}{1}\", and where it is a plain number write "
                           "{2}/1{1}; or keep it plain, and write {2}*1{1} where it is none",
                           number, unit, operand.name)};
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
    problem = {Code("E1223"), 0, size, "it has no finite value", ""};
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

void Expressions::set_units(const BareUnits& bare) {
  implementation_->bare = bare;
  implementation_->entries.clear();
}
const BareUnits& Expressions::units() const { return implementation_->bare; }

std::optional<Measured> Expressions::evaluate(std::string_view text, std::uint64_t place,
                                              const Scope* scope, ExpressionProblem& problem,
                                              const std::optional<Need>& need) {
  Implementation& own = *implementation_;
  Implementation::Entry& entry = own.entry_of(text, place);
  if (entry.formula.problem) {
    problem = *entry.formula.problem;
    return std::nullopt;
  }
  if (!own.bind(entry.formula, scope, problem)) return std::nullopt;
  if (!own.analyse_entry(entry, text, need, problem)) return std::nullopt;
  if (!own.note_uses(entry, scope, problem)) return std::nullopt;
  const Analysis& known = *entry.analysis;
  const auto value = entry.program.run(own.inputs);
  if (!value) {
    own.not_finite(entry, text.size(), problem);
    return std::nullopt;
  }
  const bool told = known.kind.measure != QuantityKind::Measure::unknown;
  Measured out{*value, told ? known.kind : own.measured(entry.program, *value)};
  out.length = known.other_length != 0 ? known.other_length : own.bare.length->factor;
  out.angle = known.other_angle != 0 ? known.other_angle : own.bare.angle->factor;
  out.pi = known.pi;
  out.ratio = known.ratio;
  return out;
}

}  // namespace panwright::pxn
