// Values: numbers, with their units and expressions.

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>

#include "base/text.h"
#include "pxn/expression/internal/number_rules.h"
#include "pxn/expression/values.h"
#include "pxn/text/characters.h"

namespace panwright::pxn {

namespace {

using schemas::Dimension;

bool in_range(double x, const schemas::Number& number) {
  return x >= number.min && x <= number.max && !(number.above && x == number.min) &&
         !(number.nonzero && x == 0);
}

// The limit that a computed value has left by its roundings only.
double at_limit(double x, const schemas::Number& number) {
  constexpr double kSlack = 1e-15;  // {3*30deg} is 1.4e-16 above a quarter turn
  for (const double limit : {number.min, number.max})
    if (std::fabs(x - limit) <= kSlack * std::fabs(limit) && !in_range(x, number)) return limit;
  return x;
}

// Whether a token is written as a number, though not one that a double can hold.
bool is_too_large(std::string_view token) {
  const std::size_t e = token.find_first_of("eE");
  const std::string_view mantissa = token.substr(0, std::min(e, token.size()));
  // digits alone overflow only past 300 of them
  const std::string_view start = mantissa.substr(0, 300);
  if (!parse_double(start)) return false;
  if (mantissa.find_first_not_of("0123456789.+-") != std::string_view::npos) return false;
  if (e == std::string_view::npos) return mantissa.size() > 300;
  std::string_view exponent = token.substr(e + 1);
  if (exponent.starts_with('+')) exponent.remove_prefix(1);
  return !exponent.empty() && exponent.find_first_not_of("0123456789") == std::string_view::npos;
}

// Dimension::none where a kind has none, or may be any.
Dimension dimension_of(const QuantityKind& kind) {
  for (const Dimension dimension :
       {Dimension::length, Dimension::angle, Dimension::ratio, Dimension::pixels})
    if (kind == quantity_kind_of(dimension)) return dimension;
  return Dimension::none;
}

// Whether what follows a number is meant as a unit.
bool looks_like_unit(std::string_view rest) {
  return !rest.empty() && std::all_of(rest.begin(), rest.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '%' || c == '_' ||
           static_cast<unsigned char>(c) >= 0x80;
  });
}

}  // namespace

// ---- the short way, for plain numbers that are as they should be

// With the same result as the long way, which knows what to say about others.

Values::Bare Values::bare_of(const schemas::Value& value) const {
  if (value.dimension == Dimension::length && units_.level >= 1)
    return length_unit_ != nullptr ? Bare{length_unit_, 1} : Bare{nullptr, units_.length};
  if (value.dimension == Dimension::angle && !value.bare_radians) {
    if (angle_unit_ != nullptr) return {angle_unit_, 1};
    return {nullptr, units_.angle};
  }
  return {};
}

// Past the number, or nullptr.
const char* Values::read_plain_number(const char* at, const char* end, const Bare& bare,
                                      const schemas::Number& limits, double& out) const {
  if (!is_si(bare.unit)) {
    const char* rest = at;
    while (rest < end && !is_blank(*rest)) ++rest;
    const auto number = read_number({at, static_cast<std::size_t>(rest - at)}, bare.unit);
    if (!number || !in_range(*number, limits)) return nullptr;
    out = *number;
    return rest;
  }
  const char* const first = at + (at < end && *at == '-' ? 1 : 0);
  // note: from_chars takes words as well
  if (first >= end || !((*first >= '0' && *first <= '9') || *first == '.')) return nullptr;
  const auto [rest, error] = std::from_chars(at, end, out);
  if (error != std::errc() || (rest < end && !is_blank(*rest))) return nullptr;
  out *= bare.factor;
  return in_range(out, limits) ? rest : nullptr;
}

bool Values::read_plain(std::string_view text, const schemas::Value& value,
                        std::span<double> out) const {
  const Bare bare = bare_of(value);
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t i = 0; i < out.size(); ++i) {
    while (at < end && is_blank(*at)) ++at;
    at = read_plain_number(at, end, bare, number_at(value, i), out[i]);
    if (at == nullptr) return false;
  }
  while (at < end && is_blank(*at)) ++at;
  return at == end;
}

bool Values::read_plain_list(std::string_view text, const schemas::Value& value,
                             std::vector<double>& out) const {
  const Bare bare = bare_of(value);
  const schemas::Number& limits = number_at(value, 0);
  const char* at = text.data();
  const char* const end = at + text.size();
  for (;;) {
    while (at < end && is_blank(*at)) ++at;
    if (at == end) return true;
    double number = 0;
    at = read_plain_number(at, end, bare, limits, number);
    if (at == nullptr) return false;
    out.push_back(number);
  }
}

// ---- numbers

bool Values::read_all(std::uint32_t element, const Text& text, const schemas::Value& value,
                      std::span<double> out, std::size_t& count) {
  count = 0;
  if (has_commas(element, text, value)) return false;
  std::size_t at = 0;
  Token token;
  bool ok = true;
  for (count = 0; next_token(text, at, token); ++count)
    if (count < out.size()) ok = read_real(element, text, token, value, count, out[count]) && ok;
  check_radians(element, text, value);
  return ok;
}

bool Values::numbers(std::uint32_t element, std::span<double> out) {
  const schemas::Value& value = schema(element).text;
  assert(value.kind == schemas::ValueKind::real && value.count == out.size());
  const Text text = text_of(element);
  if (read_plain(text.text, value, out)) return check_radians(element, text, value), true;
  std::size_t count = 0;
  const bool ok = read_all(element, text, value, out, count);
  if (count == out.size()) return ok;
  if (count == 1 && value.one) {
    std::fill(out.begin() + 1, out.end(), out[0]);
    return ok;
  }
  // with a word among the numbers, how many there are is not the problem
  if (ok) bad_count(element, value, fmt::format("<{}>", schema(element).name), count);
  return false;
}

bool Values::list(std::uint32_t element, std::vector<double>& out) {
  const schemas::Value& value = schema(element).text;
  assert(value.kind == schemas::ValueKind::real && value.count == 0);
  const Text text = text_of(element);
  out.clear();
  if (!read_plain_list(text.text, value, out)) {
    out.clear();
    if (has_commas(element, text, value)) return false;
    std::size_t at = 0;
    Token token;
    bool ok = true;
    while (next_token(text, at, token)) {
      double number = 0;
      ok = read_real(element, text, token, value, out.size(), number) && ok;
      out.push_back(number);
    }
    if (!ok) return false;
  }
  if (out.size() % value.tuple == 0 && out.size() / value.tuple >= value.least) return true;
  bad_tuples(element, value, out.size());
  return false;
}

bool Values::integers(std::uint32_t element, std::vector<std::uint32_t>& out) {
  const schemas::Value& value = schema(element).text;
  assert(value.kind == schemas::ValueKind::integer && value.count == 0);
  out.clear();
  const Text text = text_of(element);
  if (has_commas(element, text, value)) return false;
  std::size_t at = 0;
  Token token;
  bool ok = true;
  while (next_token(text, at, token)) {
    std::uint64_t number = 0;
    ok = read_integer(element, text, token, value, 0, number) && ok;
    out.push_back(static_cast<std::uint32_t>(number));
  }
  return ok;
}

std::optional<std::uint64_t> Values::integer(std::uint32_t element) {
  const schemas::Value& value = schema(element).text;
  assert(value.kind == schemas::ValueKind::integer && value.count == 1);
  const Text text = text_of(element);
  std::size_t at = 0, count = 0;
  std::uint64_t out = 0;
  Token token;
  bool ok = true;
  for (; next_token(text, at, token); ++count)
    if (count == 0) ok = read_integer(element, text, token, value, 0, out);
  if (ok && count == 1) return out;
  if (ok) bad_count(element, value, fmt::format("<{}>", schema(element).name), count);
  return std::nullopt;
}

SourceSpan Values::place_of(std::uint32_t element, std::size_t number) {
  const Text text = text_of(element);
  std::size_t at = 0;
  Token token;
  for (std::size_t i = 0; next_token(text, at, token); ++i)
    if (i == number) return place(text, token);
  return doc_.name_span(element);
}

// ---- one number

std::optional<Values::Amount> Values::read_amount(std::uint32_t element, const Text& text,
                                                  const Token& token, const schemas::Value& value,
                                                  std::size_t index) {
  const bool any = value.kind == schemas::ValueKind::quantity;
  if (units_.level >= 1 && is_expression(token.text))
    return read_computed(element, text, token, value);
  const std::size_t length = units_.level >= 1 ? number_length(token.text) : token.text.size();
  const std::string_view number = token.text.substr(0, length);
  const std::string_view name = token.text.substr(length);
  if (length == 0 || !(name.empty() || looks_like_unit(name))) {
    bad_number(Code("E1201"), element, text, token, value, index, {});
    return std::nullopt;
  }
  Amount amount;
  double factor = 1;
  if (name.empty()) {
    const Bare bare = any ? Bare{} : bare_of(value);
    amount.unit = bare.unit;
    amount.bare = true;
    factor = bare.factor;
  } else {
    amount.unit = find_unit(name);
    if (amount.unit == nullptr) {
      bad_unit(element, text, token, length);
      return std::nullopt;
    }
    amount.dimension = amount.unit->dimension;
    if (!any && amount.dimension != value.dimension) {
      bad_kind(element, text, token, value.dimension, name_of(amount.dimension));
      return std::nullopt;
    }
  }
  const auto converted = read_number(number, amount.unit);
  if (!converted) {
    const Code code = is_too_large(number) ? Code("E1202") : Code("E1201");
    bad_number(code, element, text, token, value, index, amount);
    return std::nullopt;
  }
  amount.value = *converted * factor;
  return amount;
}

// Whether an expression holds a name whose value could not be read.
static bool mentions_unread(std::string_view expression, const Scope& scope) {
  for (std::size_t at = 0; at < expression.size();) {
    std::size_t end = at + 1;
    while (end < expression.size() && is_name(expression.substr(at, end + 1 - at))) ++end;
    const std::string_view name = expression.substr(at, end - at);
    if (is_name(name))
      if (const Quantity* known = scope.find(name); known != nullptr && std::isnan(known->value))
        return true;
    at = end;
  }
  return false;
}

std::optional<Measured> Values::evaluate(std::uint32_t element, const Text& text,
                                         const Token& token, const std::optional<Need>& need) {
  const std::string_view inside =
      token.text.substr(1, std::max<std::size_t>(token.text.size(), 2) - 2);
  ExpressionProblem problem;
  const SourceSpan all = place(text, token);
  const auto measured = expressions_.evaluate(inside, all.begin, scope_, problem, need);
  if (measured && std::isfinite(measured->value)) return measured;
  // problems of a parameter are already reported where it stands
  if (scope_ != nullptr && mentions_unread(inside, *scope_)) return std::nullopt;
  problem.end = std::min(std::max(problem.end, problem.begin + 1), token.text.size() - 1);
  const Token part = {text.text.substr(token.at + 1 + problem.begin, problem.end - problem.begin),
                      token.at + 1 + problem.begin};
  reporter_.report(problem.code, place(text, part), doc_, element,
                   [&] { return Reporter::Text(problem.message, problem.hint); });
  return std::nullopt;
}

std::optional<Values::Amount> Values::read_computed(std::uint32_t element, const Text& text,
                                                    const Token& token,
                                                    const schemas::Value& value) {
  const std::string_view whole = token.text;
  const std::size_t end = whole.find('}');
  if (!whole.starts_with('{') || end != whole.size() - 1) {
    const std::size_t open = whole.find('{');
    const bool nested = whole.find('{', open + 1) < end;
    if (open == 0 && nested && whole.ends_with('}')) {
      evaluate(element, text, token, {});  // says where nested braces
      return std::nullopt;
    }
    const Token part = {whole.substr(open, 1), token.at + open};
    reporter_.report(Code("E1221"), place(text, part), doc_, element, [&]() -> Reporter::Text {
      if (end == std::string_view::npos) return {"this brace is not closed"};
      if (open == 0 && looks_like_unit(whole.substr(end + 1)))
        return {"a unit after an expression", "units go inside the braces: {2*5mm}"};
      return {"an expression is a number of its own", "write it all in one pair of braces"};
    });
    return std::nullopt;
  }
  std::optional<Need> need;
  const bool any = value.kind == schemas::ValueKind::quantity;
  if (!any) need = Need{value.dimension, value.bare_radians};
  const auto measured = evaluate(element, text, token, need);
  if (!measured) return std::nullopt;
  Amount amount;
  amount.value = measured->value;
  amount.computed = true;
  amount.dimension = dimension_of(measured->kind);
  if (any) {
    amount.measured = *measured;
    return amount;
  }
  const bool is_part = amount.dimension == Dimension::ratio && value.dimension == Dimension::none;
  const bool is_other = measured->kind.measure == QuantityKind::Measure::other;
  if (is_other ||
      (amount.dimension != Dimension::none && amount.dimension != value.dimension && !is_part)) {
    bad_kind(element, text, token, value.dimension, name_of(measured->kind));
    return std::nullopt;
  }
  amount.unit = find_unit(value.dimension, 1);
  if (value.dimension == Dimension::length) {
    amount.unit = expressions_.units().length;
    amount.value = to_si(amount.value, *amount.unit);
  }
  return amount;
}

bool Values::read_real(std::uint32_t element, const Text& text, const Token& token,
                       const schemas::Value& value, std::size_t index, double& out) {
  const auto amount = read_amount(element, text, token, value, index);
  if (!amount) return false;
  const schemas::Number& limits = number_at(value, index);
  const double number = amount->computed ? at_limit(amount->value, limits) : amount->value;
  if (!in_range(number, limits)) {
    const Code code = limits.nonzero && number == 0 ? Code("E1211") : Code("E1202");
    bad_number(code, element, text, token, value, index, *amount);
    return false;
  }
  out = number;
  return true;
}

bool Values::read_integer(std::uint32_t element, const Text& text, const Token& token,
                          const schemas::Value& value, std::size_t index, std::uint64_t& out) {
  if (units_.level >= 1 && is_expression(token.text))
    return read_computed_integer(element, text, token, value, index, out);
  std::string_view digits = token.text;
  const bool negative = digits.starts_with('-');
  if (negative || digits.starts_with('+')) digits.remove_prefix(1);
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (digits.empty() || end != digits.data() + digits.size()) {
    const std::size_t length = units_.level >= 1 ? number_length(token.text) : 0;
    const Unit* unit = length == 0 ? nullptr : find_unit(token.text.substr(length));
    if (unit != nullptr)
      bad_kind(element, text, token, Dimension::none, name_of(unit->dimension));
    else
      bad_number(Code("E1201"), element, text, token, value, index, {});
    return false;
  }
  const schemas::Number& limits = number_at(value, index);
  const double sized = (negative ? -1.0 : 1.0) * static_cast<double>(number);
  if (error == std::errc::result_out_of_range || !in_range(sized, limits)) {
    bad_number(Code("E1202"), element, text, token, value, index, {});
    return false;
  }
  out = number;
  return true;
}

bool Values::read_computed_integer(std::uint32_t element, const Text& text, const Token& token,
                                   const schemas::Value& value, std::size_t index,
                                   std::uint64_t& out) {
  constexpr double kMost = 9007199254740992;  // 2^53: beyond it, not every whole number is a double
  const auto amount = read_computed(element, text, token, value);
  if (!amount) return false;
  const double number = amount->value;
  if (number != std::floor(number) || std::fabs(number) > kMost) {
    reporter_.report(Code("E1224"), place(text, token), doc_, element, [&]() -> Reporter::Text {
      return {fmt::format("{} is {}, expected a whole number", subject(element, value, index),
                          format_double(number)),
              "floor, ceil and round make whole numbers"};
    });
    return false;
  }
  if (number < 0 || !in_range(number, number_at(value, index))) {
    bad_number(Code("E1202"), element, text, token, value, index, *amount);
    return false;
  }
  out = static_cast<std::uint64_t>(number);
  return true;
}

bool Values::replace_expressions(std::uint32_t element, const Text& text, std::string& out) {
  bool ok = true;
  for (std::size_t at = 0; at < text.text.size();) {
    const std::size_t open = text.text.find('{', at);
    if (const std::size_t lone = text.text.find('}', at); lone < open) {
      reporter_.report(Code("E1221"), place(text, {text.text.substr(lone, 1), lone}), doc_, element,
                       [&] { return Reporter::Text("unmatched closing brace"); });
      return false;
    }
    out += text.text.substr(at, std::min(open, text.text.size()) - at);
    if (open == std::string_view::npos) break;
    const std::size_t close = text.text.find('}', open);
    if (close == std::string_view::npos) {
      reporter_.report(Code("E1221"), place(text, {text.text.substr(open, 1), open}), doc_, element,
                       [&] { return Reporter::Text("this brace is not closed"); });
      return false;
    }
    const auto measured =
        evaluate(element, text, {text.text.substr(open, close + 1 - open), open}, {});
    if (measured) {
      const bool is_angle = measured->kind.measure == QuantityKind::Measure::angle;
      const double number =
          is_angle ? from_si(measured->value, *expressions_.units().angle) : measured->value;
      // 0 has no sign in a name
      out += format_double(number == 0 ? 0 : number);
    }
    ok = ok && measured.has_value();
    at = close + 1;
  }
  return ok;
}

}  // namespace panwright::pxn
