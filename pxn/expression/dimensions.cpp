#include "pxn/expression/dimensions.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "pxn/expression/program.h"
#include "pxn/expression/units.h"

namespace panwright::pxn {

namespace {

using schemas::Dimension;
using Measure = QuantityKind::Measure;

constexpr std::uint32_t kNoName = 0xffffffffu;

// A part of an expression that has been read.
struct Part {
  QuantityKind kind;
  std::size_t begin = 0;  // in the text of the expression
  std::size_t end = 0;
  std::uint32_t first = 0;  // its steps
  std::uint32_t last = 0;   // past them
  std::optional<double> literal;
  std::vector<std::uint32_t>
      terms;  // operands that are names: those of a bare sum, or the only one
  int pi = 0;
  bool ratio = false;
  bool angular = false;  // of unknown: angles are in it
  double other_length = 0;
  double other_angle = 0;
  std::uint32_t other = kNoName;  // the operand that these are of
  // Where units would be written that make it measured: behind a number, or as a factor.
  struct Place {
    std::size_t at = 0;
    bool factor = false;
  };
  std::vector<Place> places;

  bool is_plain() const { return kind.measure == Measure::plain; }
  bool is_angle() const { return kind.measure == Measure::angle; }
  bool is_zero() const { return literal == 0.0; }
};

// What a bare number made of two has of both.
void merge(const Part& a, const Part& b, Part& out) {
  out.pi = a.pi != 0 ? a.pi : b.pi;
  out.ratio = a.ratio || b.ratio;
  out.other = a.other != kNoName ? a.other : b.other;
  out.other_length = a.other_length != 0 ? a.other_length : b.other_length;
  out.other_angle = a.other_angle != 0 ? a.other_angle : b.other_angle;
}

// A part of a text with a unit where numbers want one.
std::string with_unit(std::string_view text, const Part& part, std::string_view unit) {
  if (part.places.empty())
    return fmt::format("({})*1{}", text.substr(part.begin, part.end - part.begin), unit);
  std::string out;
  std::size_t from = part.begin;
  for (const Part::Place& place : part.places) {
    out += text.substr(from, place.at - from);
    out += fmt::format("{}{}", place.factor ? "*1" : "", unit);
    from = place.at;
  }
  return out += text.substr(from, part.end - from);
}

std::vector<Part::Place> places_of_sum(const Part& a, const Part& b) {
  if (a.places.empty() || b.places.empty()) return {};
  std::vector<Part::Place> all = a.places;
  all.insert(all.end(), b.places.begin(), b.places.end());
  return all;
}

std::vector<Part::Place> places_of_product(const Part& a, const Part& b) {
  const auto by_factor = [](const Part& part) {
    return part.places.empty() || part.places.front().factor;
  };
  return !by_factor(b) && by_factor(a) ? b.places : a.places;
}

int precedence_of(char name) {
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

// Shunting yard over the program of a formula, with kinds for values.
class KindReader {
 public:
  KindReader(const Formula& formula, std::string_view text, std::span<const OperandKind> operands,
             const BareUnits& bare, ExpressionProblem& problem)
      : formula_(formula), text_(text), operands_(operands), bare_(bare), problem_(problem) {}

  std::optional<Analysis> run(const std::optional<Need>& need) {
    const std::string& text = formula_.program;
    for (std::size_t at = 0; at < text.size() && !clash_;) at += step(at);
    reduce_to('(');
    if (clash_) return std::nullopt;
    assert(values_.size() == 1);
    Part& whole = values_.back();
    if (need) finish(whole, *need);
    if (clash_) return std::nullopt;
    out_.kind = whole.kind;
    out_.pi = whole.pi;
    out_.ratio = whole.ratio;
    out_.other_length = whole.other_length;
    out_.other_angle = whole.other_angle;
    return std::move(out_);
  }

 private:
  // An operator that waits for its right side, or what is open.
  struct Pending {
    char name;  // ( of parentheses and functions; _ a sign; < and = for all comparisons
    int precedence;
    const Function* function = nullptr;
    std::size_t values = 0;  // that stood before the function's own
  };

  // ---- reading

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
        ++steps_;
        wants_value_ = true;
        return 1;
      case ':':
        reduce_to('?');
        if (!clash_) pending_.back().name = ':';
        ++steps_;
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
    const OperandKind& known = operands_[next_];
    Part part;
    part.kind = quantity_kind_of(known.dimension);
    part.begin = operand.begin;
    part.end = operand.end;
    part.first = steps_++;
    part.last = steps_;
    if (operand.name.empty())
      part.literal = operand.value;
    else
      part.terms = {next_};
    if (part.is_plain()) {
      part.pi = known.pi;
      part.ratio = known.ratio;
      part.other_length = known.other_length;
      part.other_angle = known.other_angle;
      if (known.other_length != 0 || known.other_angle != 0) part.other = next_;
      part.places.push_back({part.end, !operand.name.empty()});
    }
    values_.push_back(std::move(part));
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

  Part pop() {
    Part part = std::move(values_.back());
    values_.pop_back();
    return part;
  }

  // ---- operators

  void apply() {
    const char name = pending_.back().name;
    pending_.pop_back();
    if (name == '_' || name == '!') {
      Part& value = values_.back();
      value.last = ++steps_;
      if (name == '!') value = fresh(value, value, kPlain);
      if (value.literal) value.literal = -*value.literal;
      return;
    }
    Part b = pop();
    Part a = pop();
    if (name == ':') {
      const Part condition = pop();
      Part out = fresh(condition, b, choice(a, b));
      if (out.is_plain() || out.kind.measure == Measure::unknown) merge(a, b, out);
      out.angular = is_angular(a) || is_angular(b);
      if (out.is_plain()) out.places = places_of_sum(a, b);
      values_.push_back(std::move(out));
      return;
    }
    ++steps_;
    values_.push_back(binary(name, a, b));
  }

  // The result of what begins and ends with two parts, when its last step is the one before.
  Part fresh(const Part& a, const Part& b, const QuantityKind& kind) const {
    Part out;
    out.kind = kind;
    out.begin = a.begin;
    out.end = b.end;
    out.first = a.first;
    out.last = steps_;
    return out;
  }

  static bool is_angular(const Part& part) { return part.is_angle() || part.angular; }

  // The kind of two branches.
  QuantityKind choice(Part& a, Part& b) {
    const bool same = !is_measured(a.kind) || !is_measured(b.kind) || a.kind == b.kind;
    return same ? joined(a, b) : QuantityKind{};
  }

  Part binary(char name, Part& a, Part& b) {
    switch (name) {
      case '+':
      case '-': {
        const QuantityKind kind = alike(a, b, name == '+' ? "added" : "subtracted");
        Part out = fresh(a, b, kind);
        out.angular = is_angular(a) || is_angular(b);
        if (!is_measured(kind)) merge(a, b, out);
        if (out.is_plain()) out.places = places_of_sum(a, b);
        if (out.is_plain()) {
          out.terms = a.terms;
          out.terms.insert(out.terms.end(), b.terms.begin(), b.terms.end());
        }
        return out;
      }
      case '*':
      case '/':
        return term(a, b, name == '/');
      case '^':
        return power(a, b);
      case '<':
      case '=':
        alike(a, b, "compared");
        return fresh(a, b, kPlain);
      default:
        return fresh(a, b, kPlain);
    }
  }

  Part term(const Part& a, const Part& b, bool divides) {
    Part out = fresh(a, b, divides ? quotient(a.kind, b.kind) : product(a.kind, b.kind));
    factor(a, b);
    factor(b, a);
    out.angular = is_angular(a) || is_angular(b);
    const int pi = a.pi + (divides ? -b.pi : b.pi);
    // a factor of pi is an angle by itself
    if (a.is_angle() != b.is_angle() && (a.pi != 0 || b.pi != 0)) {
      const int power = pi + (a.is_angle() ? 1 : divides ? -1 : 1);
      out.kind = power == 0   ? kPlain
                 : power == 1 ? QuantityKind{Measure::angle, 0}
                              : QuantityKind{};
      return out;
    }
    if (!out.is_plain()) return out;
    const bool plain = a.is_plain() && b.is_plain();
    merge(a, b, out);
    out.pi = plain ? pi : 0;
    out.ratio = out.ratio || is_measured(a.kind) || is_measured(b.kind);
    if (plain && !divides) out.places = places_of_product(a, b);
    if (plain && divides) out.places = a.places;
    return out;
  }

  Part power(const Part& a, const Part& b) {
    Part out = fresh(a, b, to_the_power(a.kind, b.literal));
    factor(b, a);
    out.angular = is_angular(a);
    if (!out.is_plain()) return out;
    merge(a, a, out);
    if (out.pi != 0 && b.literal && std::fabs(*b.literal) <= kMostPower)
      out.pi = std::max(1, static_cast<int>(std::fabs(out.pi * *b.literal))) *
               (out.pi * *b.literal < 0 ? -1 : 1);
    out.places.push_back({out.end, true});
    return out;
  }

  // ---- bare numbers

  // A name as a factor of what is measured is a plain number.
  void factor(const Part& number, const Part& of) {
    if (number.is_plain() && is_measured(of.kind)) use(number, Quantity::as_plain);
  }

  void use(const Part& part, Quantity::Use as) {
    for (const std::uint32_t name : part.terms) out_.uses.push_back({name, as});
  }

  // A bare number where a length is needed, or one to a power.
  void as_length(Part& part) {
    if (part.is_zero()) return;
    if (part.other_length != 0)
      return fail_other(part, Dimension::length, part.other_length, *bare_.length);
    use(part, Quantity::as_length);
  }

  // A bare number where an angle is needed.
  void as_angle(Part& part, bool radians) {
    const bool in_radians = radians || part.pi != 0 || bare_.angle->factor == 1;
    if (part.is_plain() && !part.is_zero()) {
      if (part.pi == 0 && !radians && part.other_angle != 0)
        return fail_other(part, Dimension::angle, part.other_angle, *bare_.angle);
      if (part.ratio && !in_radians)
        return fail(part.begin, part.end,
                    "an angle is needed, and this ratio may be degrees or radians",
                    fmt::format("write ({0})*1deg, or ({0})*1rad", text_of(part)));
      if (!in_radians) out_.scalings.push_back({part.first, part.last});
      use(part, Quantity::as_angle);
    }
    part.kind = {Measure::angle, 0};
  }

  std::string text_of(const Part& part) const {
    return std::string(text_.substr(part.begin, part.end - part.begin));
  }

  // The kind of two that may go together.
  QuantityKind joined(Part& a, Part& b) {
    for (Part* const part : {&a, &b}) {
      const Part& other = part == &a ? b : a;
      if (!part->is_plain()) continue;
      if (other.is_angle()) as_angle(*part, false);
      if (power_of(other.kind) != 0) as_length(*part);
      const bool bare = !part->is_zero() && part->pi == 0 && bare_.angle->factor != 1;
      if (other.kind.measure == Measure::unknown && other.angular && bare && !clash_)
        fail(part->begin, part->end, "a bare number combined with a possible angle",
             fmt::format("give it its unit: {}, or {}", with_unit(text_, *part, "deg"),
                         with_unit(text_, *part, bare_.length->name)));
    }
    if (a.kind.measure == Measure::unknown || b.kind.measure == Measure::unknown) return {};
    return a.is_plain() ? b.kind : a.kind;
  }

  QuantityKind alike(Part& a, Part& b, std::string_view verb) {
    if (!is_measured(a.kind) || !is_measured(b.kind) || a.kind == b.kind) return joined(a, b);
    fail(a.begin, b.end,
         fmt::format("{} and {} cannot be {}", name_of(a.kind), name_of(b.kind), verb), hint());
    return {};
  }

  void finish(Part& whole, const Need& need) {
    switch (need.dimension) {
      case Dimension::length:
        if (whole.is_plain() || whole.kind.measure == Measure::unknown) as_length(whole);
        break;
      case Dimension::angle:
        if (whole.is_plain()) as_angle(whole, need.radians);
        break;
      default:
        if (whole.is_plain()) use(whole, Quantity::as_plain);
    }
  }

  // ---- functions

  void call(const Function& function, std::size_t first) {
    const std::string_view name = function.name;
    const std::span<Part> values = std::span(values_).subspan(first);
    Part& a = values.front();
    Part out = fresh(a, values.back(), kPlain);
    out.last = ++steps_;
    if (function.most > 1) {
      several(function, values, out);
    } else if (name == "sin" || name == "cos" || name == "tan") {
      trigonometry(name, a);
    } else if (name == "asin" || name == "acos" || name == "atan") {
      out.kind = {Measure::angle, 0};
    } else if (name == "sqrt") {
      out.kind = root(a.kind);
      out.angular = is_angular(a);
      if (out.is_plain()) merge(a, a, out);
    } else if (name == "abs" || name == "floor" || name == "ceil" || name == "round") {
      out.kind = a.kind;
      out.angular = is_angular(a);
      merge(a, a, out);
      if (name != "abs") out.ratio = false;  // a count
    }
    if (clash_) return;
    values_.resize(first);
    values_.push_back(std::move(out));
  }

  // min, max, mod, hypot, atan2
  void several(const Function& function, std::span<Part> values, Part& out) {
    Part* like = nullptr;  // what the bare numbers among them are like
    for (Part& value : values) {
      const bool both = like != nullptr && is_measured(like->kind) && is_measured(value.kind);
      if (both && like->kind != value.kind)
        return fail(values.front().begin, values.back().end,
                    fmt::format("{} expects values of one dimension, got {} and {}", function.name,
                                name_of(like->kind), name_of(value.kind)),
                    hint());
      if (is_measured(value.kind) || (like == nullptr && !value.is_plain())) like = &value;
    }
    out.kind = like != nullptr ? like->kind : kPlain;
    for (Part& value : values) {
      out.angular = out.angular || is_angular(value);
      if (value.kind.measure == Measure::unknown) out.kind = {};
      if (like != nullptr && value.is_plain()) joined(*like, value);
      if (like == nullptr) merge(out, value, out);
    }
    if (function.name == "atan2") out.kind = {Measure::angle, 0};
  }

  void trigonometry(std::string_view name, Part& a) {
    if (power_of(a.kind) != 0 || a.kind.measure == Measure::pixels)
      return fail(a.begin, a.end, fmt::format("{} expects an angle, got {}", name, name_of(a.kind)),
                  hint());
    const bool is_ratio = a.kind.measure == Measure::ratio;
    if (!(a.is_plain() || is_ratio) || a.is_zero() || a.pi != 0) return;
    if (bare_.angle->factor == 1) {
      if (a.is_plain()) as_angle(a, false);
      return;
    }
    fail(a.begin, a.end, fmt::format("{} of a bare number, which may be degrees or radians", name),
         fmt::format("write {0}({1}), or {0}({2}); angle=\"rad\" at the root makes bare angles "
                     "radians",
                     name, with_unit(text_, a, "deg"), with_unit(text_, a, "rad")));
  }

  // ---- problems

  std::string hint() const {
    return fmt::format("a bare number is in {} where it is a length, in {} where it is an angle",
                       bare_.length->name, bare_.angle->name);
  }

  void fail_other(const Part& part, Dimension dimension, double other, const Unit& here) {
    const Formula::Operand& operand = formula_.operands[part.other];
    const Unit* const there = find_unit(dimension, other);
    const std::string_view unit = there != nullptr ? there->name : "other units";
    fail(operand.begin, operand.end,
         fmt::format("{} is a bare number of a file in {}, and {} here, in a file in {}",
                     in_quotes(operand.name), unit, name_of(dimension), here.name),
         fmt::format("write a unit where it has its value, or here {0}*1{1}, or {0}*1{2}",
                     operand.name, unit, here.name));
  }

  void fail(std::size_t begin, std::size_t end, std::string message, std::string hint) {
    if (std::exchange(clash_, true)) return;
    problem_ = {Code("E1212"), begin, end, std::move(message), std::move(hint)};
  }

  const Formula& formula_;
  std::string_view text_;
  std::span<const OperandKind> operands_;
  const BareUnits& bare_;
  ExpressionProblem& problem_;
  Analysis out_;
  std::vector<Part> values_;
  std::vector<Pending> pending_;
  std::uint32_t next_ = 0;
  std::uint32_t steps_ = 0;
  bool wants_value_ = true;
  bool clash_ = false;
};

}  // namespace

std::optional<Analysis> analyse(const Formula& formula, std::string_view text,
                                std::span<const OperandKind> operands, const BareUnits& bare,
                                const std::optional<Need>& need, ExpressionProblem& problem) {
  return KindReader(formula, text, operands, bare, problem).run(need);
}

}  // namespace panwright::pxn
