#include "pxn/internal/expression.h"

#include <fmt/format.h>
#include <muParserBase.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/math.h"
#include "base/text.h"

namespace panwright::pxn {

namespace {

using schemas::Dimension;

// beyond these, what is read and compiled is not kept
constexpr std::size_t kFormulas = 1 << 14;
constexpr std::size_t kPrograms = 256;

// ---- operations

// The first operation of a run whose result is not finite.
struct Watch {
  bool broken = false;
  int group = 0;
  double values[2] = {0, 0};
};
thread_local Watch watch;

void look_at(double result, int group, double a, double b = 0) {
  if (std::isfinite(result) || watch.broken) return;
  watch = {true, group, {a, b}};
}

// Operations come in two groups, so that the one that broke a run can be searched for by halves.
template <double (*F)(double), int Group>
double watched(double a) {
  const double result = F(a);
  look_at(result, Group, a);
  return result;
}
template <double (*F)(double, double), int Group>
double watched(double a, double b) {
  const double result = F(a, b);
  look_at(result, Group, a, b);
  return result;
}

double add(double a, double b) { return a + b; }
double subtract(double a, double b) { return a - b; }
double multiply(double a, double b) { return a * b; }
double divide(double a, double b) { return a / b; }
double less_equal(double a, double b) { return a <= b; }
double greater_equal(double a, double b) { return a >= b; }
double not_equal(double a, double b) { return a != b; }
double equal(double a, double b) { return a == b; }
double less(double a, double b) { return a < b; }
double greater(double a, double b) { return a > b; }
double both(double a, double b) { return a != 0 && b != 0; }
double either(double a, double b) { return a != 0 || b != 0; }
double negative(double a) { return -a; }
double opposite(double a) { return a == 0; }
double square_root(double a) { return std::sqrt(a); }
double absolute(double a) { return std::fabs(a); }
double floor_of(double a) { return std::floor(a); }
double ceil_of(double a) { return std::ceil(a); }
double round_of(double a) { return std::round(a); }
double sign_of(double a) { return a > 0 ? 1 : a < 0 ? -1 : 0; }
double modulo(double a, double b) {
  const double rest = std::fmod(a, b);
  return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}
double least(const double* values, int n) { return *std::min_element(values, values + n); }
double largest(const double* values, int n) { return *std::max_element(values, values + n); }

// ---- programs

// note: muParser's own numbers, names, functions and operators are not used: they depend on the
// locale and on libm
class Parser : public mu::ParserBase {
 public:
  Parser() {
    DefineNameChars("0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ");
    DefineOprtChars("+-*/^<>=!&|#$~%@");
    DefineInfixOprtChars("-!");
    EnableBuiltInOprt(false);
    define_operators();
    define_functions();
  }

  // The same operation of the other group; both are one character.
  static char other(char operation) {
    constexpr std::string_view kFirst = "+-*/^f";
    constexpr std::string_view kSecond = "#$~%@g";
    return kSecond[kFirst.find(operation)];
  }

 private:
  void InitCharSets() override {}
  void InitFun() override {}
  void InitConst() override {}
  void InitOprt() override {}

  template <double (*F)(double, double)>
  void arithmetic(char name, unsigned precedence, mu::EOprtAssociativity side = mu::oaLEFT) {
    DefineOprt(std::string(1, name), watched<F, 0>, precedence, side);
    DefineOprt(std::string(1, other(name)), watched<F, 1>, precedence, side);
  }

  void define_operators() {
    DefineOprt("||", either, 1);
    DefineOprt("&&", both, 2);
    DefineOprt("==", equal, 3);
    DefineOprt("!=", not_equal, 3);
    DefineOprt("<", less, 4);
    DefineOprt(">", greater, 4);
    DefineOprt("<=", less_equal, 4);
    DefineOprt(">=", greater_equal, 4);
    arithmetic<add>('+', 5);
    arithmetic<subtract>('-', 5);
    arithmetic<multiply>('*', 6);
    arithmetic<divide>('/', 6);
    DefineInfixOprt("-", negative, 7);
    DefineInfixOprt("!", opposite, 7);
    arithmetic<det::pow>('^', 8, mu::oaRIGHT);
  }

  template <double (*F)(double)>
  void function(std::string_view name) {
    const std::string own = program_name(name);
    DefineFun("f" + own, watched<F, 0>);
    DefineFun("g" + own, watched<F, 1>);
  }
  template <double (*F)(double, double)>
  void function(std::string_view name) {
    const std::string own = program_name(name);
    DefineFun("f" + own, static_cast<mu::fun_type2>(watched<F, 0>));
    DefineFun("g" + own, static_cast<mu::fun_type2>(watched<F, 1>));
  }
  static std::string program_name(std::string_view name) {
    const auto known = std::find_if(std::begin(kFunctions), std::end(kFunctions),
                                    [&](const Function& f) { return f.name == name; });
    return std::string(1, static_cast<char>('a' + (known - std::begin(kFunctions))));
  }

  void define_functions() {
    function<det::sin>("sin");
    function<det::cos>("cos");
    function<det::tan>("tan");
    function<det::asin>("asin");
    function<det::acos>("acos");
    function<det::atan>("atan");
    function<det::atan2>("atan2");
    function<det::exp>("exp");
    function<det::log>("log");
    function<det::log10>("log10");
    function<square_root>("sqrt");
    function<absolute>("abs");
    function<floor_of>("floor");
    function<ceil_of>("ceil");
    function<round_of>("round");
    function<sign_of>("sign");
    function<modulo>("mod");
    function<det::hypot>("hypot");
    for (const char group : {'f', 'g'}) {
      DefineFun(group + program_name("min"), least);
      DefineFun(group + program_name("max"), largest);
    }
  }
};

// A compiled expression, with a place for each of its operands.
class Program {
 public:
  explicit Program(std::size_t places) : values_(places) {}

  std::span<double> values() { return values_; }

  void compile(const std::string& text, std::size_t operands) {
    if (text == text_) return;
    for (; defined_ < operands; ++defined_)
      parser_.DefineVar(operand_name(defined_), &values_[defined_]);
    parser_.SetExpr(text);
    text_ = text;
  }

  // Nothing when an operation has no finite result; `watch` holds which.
  std::optional<double> run() {
    watch.broken = false;
    const double value = parser_.Eval();
    if (watch.broken || !std::isfinite(value)) return std::nullopt;
    return value;
  }

 private:
  Parser parser_;
  std::vector<double> values_;
  std::size_t defined_ = 0;
  std::string text_;
};

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
    Program* program = nullptr;
    std::optional<std::size_t> culprit;  // the operation that broke it the last time
    std::optional<Kind> kind;            // for operands of these dimensions
    std::vector<Dimension> kind_of;
  };

  std::unordered_map<std::uint64_t, Entry> entries;
  std::unordered_map<std::string, std::unique_ptr<Program>> programs;
  std::unique_ptr<Program> scratch;
  Entry passing;  // of a place that is not kept
  std::vector<double> inputs;
  std::vector<Dimension> dimensions;

  Entry& entry_of(std::string_view text, std::uint64_t place) {
    const auto found = entries.find(place);
    if (found != entries.end()) return found->second;
    Entry& entry = entries.size() < kFormulas ? entries[place] : passing;
    entry = {read_formula(text), nullptr, {}, {}, {}};
    return entry;
  }

  Program& scratch_program() {
    if (!scratch) scratch = std::make_unique<Program>(kLongestExpression / 2 + 1);
    return *scratch;
  }

  Program& program_of(Entry& entry) {
    const Formula& formula = entry.formula;
    if (entry.program != nullptr && entry.program != scratch.get()) return *entry.program;
    const auto found = programs.find(formula.program);
    if (found != programs.end()) {
      entry.program = found->second.get();
    } else if (programs.size() < kPrograms) {
      auto& own = programs[formula.program];
      own = std::make_unique<Program>(formula.operands.size());
      entry.program = own.get();
    } else {
      entry.program = &scratch_program();
    }
    entry.program->compile(formula.program, formula.operands.size());
    return *entry.program;
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
    problem.message = fmt::format("{} is no parameter and no variable{}", in_quotes(operand.name),
                                  none ? "; there are none here" : " that is known here");
    if (is_function)
      problem.hint = fmt::format("functions take their values in parentheses: {}(…)", operand.name);
    else if (const auto near = nearest_name(operand.name, names); near && operand.name.size() > 1)
      problem.hint = fmt::format("did you mean '{}'?", *near);
  }

  void fill(Program& program, double lengths, double angles) const {
    const std::span<double> values = program.values();
    for (std::size_t i = 0; i < inputs.size(); ++i)
      values[i] = inputs[i] * (dimensions[i] == Dimension::length  ? lengths
                               : dimensions[i] == Dimension::angle ? angles
                                                                   : 1);
  }

  // How a value follows the inputs of a dimension: the power, where it is one.
  std::optional<int> follows(Program& program, Dimension dimension, double value) const {
    if (std::find(dimensions.begin(), dimensions.end(), dimension) == dimensions.end()) return 0;
    if (value == 0) return std::nullopt;
    const auto scaled = [&](double factor) -> std::optional<int> {
      const bool lengths = dimension == Dimension::length;
      fill(program, lengths ? factor : 1, lengths ? 1 : factor);
      const auto there = program.run();
      return there ? power_of(value, *there) : std::nullopt;
    };
    const auto up = scaled(2);
    if (!up) return std::nullopt;
    // a comparison that turns over looks like a power in one direction only
    const auto down = scaled(0.5);
    return down && *down == -*up ? up : std::nullopt;
  }

  // The kind of an entry's value, as far as its text tells; nothing where kinds clash.
  bool find_kind(Entry& entry, ExpressionProblem& problem) const {
    if (entry.kind && entry.kind_of == dimensions) return true;
    entry.kind = kind_of(entry.formula, dimensions, problem);
    entry.kind_of = dimensions;
    return entry.kind.has_value();
  }

  // The kind of a value from how it follows its operands.
  Kind measured(Program& program, double value) const {
    using Measure = Kind::Measure;
    const auto length = follows(program, Dimension::length, value);
    const auto angle = follows(program, Dimension::angle, value);
    if (!length || (*length == 0 && !angle)) return {};
    if (*length == 1) return {Measure::length, 0};
    if (*length != 0) return {Measure::other, *length};
    if (*angle == 0) return {Measure::plain, 0};
    return {*angle == 1 ? Measure::angle : Measure::unknown, 0};
  }

  // The operation that broke the run, by halves: its group tells in which half it is.
  std::size_t culprit_of(const Formula& formula) {
    Program& program = scratch_program();
    std::size_t first = 0;
    std::size_t count = formula.operations.size();
    while (count > 1) {
      std::string text = formula.program;
      const std::size_t half = count / 2;
      for (std::size_t i = first; i < first + half; ++i) {
        char& c = text[formula.operations[i].at];
        c = Parser::other(c);
      }
      program.compile(text, formula.operands.size());
      fill(program, 1, 1);
      program.run();
      if (watch.group == 0) first += half;
      count = watch.group == 1 ? half : count - half;
    }
    return first;
  }

  void not_finite(Entry& entry, std::size_t size, ExpressionProblem& problem) {
    problem = {Code::E1223, 0, size, "it has no finite value", ""};
    const Watch seen = watch;
    if (!seen.broken || entry.formula.operations.empty()) return;
    if (!entry.culprit) entry.culprit = culprit_of(entry.formula);
    const Formula::Operation& operation = entry.formula.operations[*entry.culprit];
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
  try {
    Program& program = own.program_of(entry);
    own.fill(program, 1, 1);
    const auto value = program.run();
    if (value)
      return Measured{*value, entry.kind->measure != Kind::Measure::unknown
                                  ? *entry.kind
                                  : own.measured(program, *value)};
    own.not_finite(entry, text.size(), problem);
  } catch (const mu::ParserError& error) {
    problem = {Code::E1221, 0, text.size(), "it cannot be read: " + error.GetMsg(), ""};
  }
  return std::nullopt;
}

}  // namespace panwright::pxn
