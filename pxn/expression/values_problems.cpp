// Values: reports of numbers that cannot be read or are out of range.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/angle_text.h"
#include "base/math.h"
#include "base/text.h"
#include "pxn/expression/internal/number_rules.h"
#include "pxn/expression/values.h"

namespace panwright::pxn {

namespace {

using schemas::Dimension;

// A number in a unit, with the unit where it is not SI or was written.
std::string number_in(double si, const Unit* unit, bool with_name) {
  if (is_si(unit)) return format_double(si) + std::string(with_name ? unit->name : "");
  return fmt::format("{:.12g}{}", si / unit->factor, with_name ? unit->name : "");
}

// The same of a limit. One that is no round number there loses its digits past the third, so that
// What messages name as accepted is accepted.
std::string limit_in(double si, const Unit* unit, bool with_name, bool is_lowest) {
  if (is_si(unit) || si == 0) return number_in(si, unit, with_name);
  const double in_unit = si / unit->factor;
  const auto name = with_name ? unit->name : std::string_view();
  const double round = parse_double(fmt::format("{:.6g}", in_unit)).value_or(0);
  if (std::fabs(round - in_unit) <= 1e-12 * std::fabs(in_unit))
    return fmt::format("{:.12g}{}", round, name);
  const double step = std::pow(10, std::floor(std::log10(std::fabs(in_unit))) - 2);
  const double steps = is_lowest ? std::ceil(in_unit / step) : std::floor(in_unit / step);
  return fmt::format("{:.12g}{}", steps * step, name);
}

std::string range_of(const schemas::Number& number, const Unit* unit = nullptr,
                     bool with_name = false) {
  const std::string low = limit_in(number.min, unit, with_name, true);
  const std::string high = limit_in(number.max, unit, with_name, false);
  if (number.min == number.max) return low;
  const std::string range = number.above ? fmt::format("more than {}, up to {}", low, high)
                                         : fmt::format("{} to {}", low, high);
  return range + (number.nonzero ? ", but not 0" : "");
}

std::string noun(const schemas::Value& value) {
  return value.kind == schemas::ValueKind::integer ? "whole number" : "number";
}

// " or auto"
std::string or_words(const schemas::Value& value) {
  return value.words.empty() ? "" : fmt::format(" or {}", fmt::join(value.words, " or "));
}

}  // namespace

std::string Values::subject(std::uint32_t element, const schemas::Value& value,
                            std::size_t index) const {
  const std::string_view name = number_at(value, index).name;
  if (value.count == 1 && &value == &schema(element).text)
    return fmt::format("<{}>", schema(element).name);
  const std::string_view number = name.substr(0, name.find(':'));
  // one of several numbers of an attribute
  for (const schemas::Attribute& attribute : schema(element).attributes)
    if (&attribute.value == &value && value.count > 1 && attribute.name != number)
      return fmt::format("{} of {} of <{}>", number, attribute.name, schema(element).name);
  return fmt::format("{} of <{}>", number, schema(element).name);
}

std::string Values::written(const Text& text, const Token& token) const {
  // numbers are read from raw bytes, which may be ISO-8859-1
  const Encoding encoding = text.offsets == nullptr ? doc_.encoding : Encoding::utf8;
  const std::string_view some = token.text.substr(0, 256);
  return token.text.size() > 60 ? in_quotes(to_utf8(some, encoding)) : to_utf8(some, encoding);
}

std::string Values::number_hint(const Token& token) const {
  if (parse_double(token.text)) return "it has no decimal point or exponent";
  const std::size_t length = number_length(token.text);
  const std::string_view rest = token.text.substr(length);
  if (length > 0 && find_unit(rest) != nullptr)
    return "units belong to level 1 of the language: ver=\"1\"";
  if (units_.level >= 1) {
    const std::size_t name = std::min(rest.find_first_not_of(" \t\r\n"), rest.size());
    if (find_unit(rest.substr(name)) != nullptr) return "a unit follows its number without a blank";
    if (scope_ != nullptr && scope_->find(token.text) != nullptr)
      return fmt::format("names go in braces: {{{}}}", token.text);
    if (rest.find_first_of("*/^(") != std::string_view::npos)
      return "expressions go in braces: {…}";
  }
  return {};
}

// "size of <box>", "<diffuse>"
std::string Values::subject(std::uint32_t element, const schemas::Value& value) const {
  for (const schemas::Attribute& attribute : schema(element).attributes)
    if (&attribute.value == &value)
      return fmt::format("{} of <{}>", attribute.name, schema(element).name);
  return fmt::format("<{}>", schema(element).name);
}

// Commas between numbers, or in place of their points: one problem, however many there are.
bool Values::has_commas(std::uint32_t element, const Text& text, const schemas::Value& value) {
  Token token, first;
  std::size_t tokens = 0, commas = 0, ends = 0;
  for (std::size_t at = 0; next_token(text, at, token); ++tokens) {
    const bool number = token.text.find_first_not_of("+-.,0123456789") != 0;
    if (!number || is_expression(token.text) || token.text.find('(') != std::string_view::npos)
      continue;
    const auto inside = std::ranges::count(token.text, ',');
    if (inside == 0) continue;
    commas += static_cast<std::size_t>(inside);
    if (first.text.empty()) first = token;
    ends += token.text.ends_with(',') || token.text.starts_with(',') ? 1 : 0;
  }
  if (first.text.empty()) return false;
  reporter_.report(Code("E1201"), place(text, first), doc_, element, [&]() -> Reporter::Text {
    constexpr std::size_t kShown = 60;
    // "0,5 1 2" has as many numbers as are needed
    const bool points =
        ends == 0 && (tokens == value.count || (value.one && tokens == 1 && commas == 1));
    std::string plain;  // without doubled blanks
    for (const char c : trimmed(text).text.substr(0, kShown)) {
      const char better = c != ',' ? c : points ? '.' : ' ';
      if (!(better == ' ' && plain.ends_with(' '))) plain += better;
    }
    return {fmt::format("commas in {}, expected {}", subject(element, value),
                        points ? "decimal points" : "blanks between numbers"),
            fmt::format("write {}{}", plain, trimmed(text).text.size() > kShown ? "…" : "")};
  });
  return true;
}

// Bare angles that are round as radians.
void Values::check_radians(std::uint32_t element, const Text& text, const schemas::Value& value) {
  if (value.dimension != Dimension::angle) return;
  const Bare bare = bare_of(value);
  const double factor = bare.unit != nullptr ? bare.unit->factor : bare.factor;
  if (std::fabs(factor - kDegree) > 1e-9) return;
  Token token;
  for (std::size_t at = 0; next_token(text, at, token);)
    if (const auto warning = warning_of_radians(token.text))
      reporter_.report(Code("W1214"), place(text, token), doc_, element,
                       [&] { return Reporter::Text(warning->message, warning->hint); });
}

void Values::bad_number(Code code, std::uint32_t element, const Text& text, const Token& token,
                        const schemas::Value& value, std::size_t index, const Amount& amount) {
  reporter_.report(code, place(text, token), doc_, element, [&]() -> Reporter::Text {
    const std::string what = subject(element, value, index);
    const schemas::Number& limits = number_at(value, index);
    const std::string takes =
        value.numbers.empty()
            ? "a number, with or without a unit, or an expression in braces"
            : range_of(limits, amount.unit,
                       amount.unit != nullptr && !(amount.bare && is_si(amount.unit)));
    if (code == Code("E1202"))
      return {fmt::format("{} is {}{}, expected {}", what, written(text, token),
                          amount.computed
                              ? " = " + number_in(amount.value, amount.unit, amount.unit != nullptr)
                              : "",
                          takes)};
    if (code == Code("E1211"))
      return {
          fmt::format("{} is 0, which flattens everything below; expected any other number", what)};
    const Encoding encoding = text.offsets == nullptr ? doc_.encoding : Encoding::utf8;
    return {fmt::format("{} is not a {}, expected {}{} for {}",
                        in_quotes(to_utf8(token.text.substr(0, 256), encoding)), noun(value), takes,
                        or_words(value), what),
            number_hint(token)};
  });
}

// "w is a length, d is an angle": of an expression of more than one.
std::string Values::kinds_of_operands(const Token& token) const {
  const std::string_view inside = token.text.substr(1, token.text.size() - 2);
  const Formula formula = read_formula(inside, expressions_.units().length);
  if (formula.operands.size() < 2) return {};
  std::vector<std::string> said;
  constexpr std::size_t kMost = 6;
  for (const Formula::Operand& operand : formula.operands) {
    const Quantity* const known =
        scope_ == nullptr || operand.name.empty() ? nullptr : scope_->find(operand.name);
    const Dimension dimension = known != nullptr ? known->dimension : operand.dimension;
    std::string each = fmt::format(
        "{} is {}", inside.substr(operand.begin, operand.end - operand.begin), name_of(dimension));
    if (std::find(said.begin(), said.end(), each) != said.end()) continue;
    if (said.size() == kMost) break;
    said.push_back(std::move(each));
  }
  return fmt::format("{}", fmt::join(said, ", "));
}

void Values::bad_kind(std::uint32_t element, const Text& text, const Token& token, Dimension needed,
                      std::string_view got) {
  reporter_.report(Code("E1212"), place(text, token), doc_, element, [&]() -> Reporter::Text {
    std::string hint;
    if (needed != Dimension::none) hint = fmt::format("its units: {}", units_of(needed));
    // a number of them, then
    const bool computed = is_expression(token.text);
    if (needed == Dimension::none && computed && got == name_of(Dimension::length))
      hint = fmt::format("divide it by a length: (…)/1{}", expressions_.units().length->name);
    if (needed == Dimension::none && computed && got == name_of(Dimension::angle))
      hint = fmt::format("divide it by an angle: (…)/1{}", expressions_.units().angle->name);
    if (computed)
      if (const std::string kinds = kinds_of_operands(token); !kinds.empty())
        hint += (hint.empty() ? "" : "; ") + kinds;
    return {
        fmt::format("{} is needed here, got {} ({})", name_of(needed), got, written(text, token)),
        hint};
  });
}

void Values::bad_unit(std::uint32_t element, const Text& text, const Token& token,
                      std::size_t number) {
  const Token name = {token.text.substr(number), token.at + number};
  reporter_.report(Code("E1213"), place(text, name), doc_, element, [&]() -> Reporter::Text {
    std::vector<std::string_view> names;
    for (const Unit& unit : all_units()) names.push_back(unit.name);
    const auto near = nearest_name(name.text, names);
    return {fmt::format("unknown unit {}", in_quotes(written(text, name))),
            near ? fmt::format("did you mean '{}'?", *near)
                 : fmt::format("lengths: {}; angles: {}", units_of(Dimension::length),
                               units_of(Dimension::angle))};
  });
}

void Values::bad_count(std::uint32_t element, const schemas::Value& value, std::string_view subject,
                       std::size_t count) {
  const SourceSpan where = doc_.name_span(element);
  reporter_.report(Code("E1203"), where, doc_, element, [&]() -> Reporter::Text {
    std::string names;
    if (value.count > 1)
      for (const schemas::Number& number : value.numbers)
        names += fmt::format("{}{}", names.empty() ? " (" : " ",
                             number.name.substr(0, number.name.find(':')));
    if (!names.empty()) names += ')';
    return {fmt::format("{}: expected {}{}{}{}, found {}", subject,
                        counted(value.count, noun(value)), names,
                        value.one ? " or one for all" : "", or_words(value), count)};
  });
}

void Values::bad_tuples(std::uint32_t element, const schemas::Value& value, std::size_t count) {
  reporter_.report(Code("E1203"), doc_.name_span(element), doc_, element, [&]() -> Reporter::Text {
    const std::size_t least = std::size_t{value.least} * value.tuple;
    const bool few = count < least;
    if (few)
      return {fmt::format("<{}>: expected at least {}, found {}", schema(element).name,
                          counted(least, "number"), count)};
    return {fmt::format("<{}>: expected a multiple of {} numbers, found {}", schema(element).name,
                        value.tuple, count)};
  });
}

}  // namespace panwright::pxn
