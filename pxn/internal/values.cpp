#include "pxn/internal/values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>

#include "base/text.h"
#include "pxn/internal/grammar.h"

namespace panwright::pxn {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

const schemas::Number& number_at(const schemas::Value& value, std::size_t index) {
  return value.numbers[std::min(index, value.numbers.size() - 1)];
}

bool in_range(double x, const schemas::Number& number) {
  return x >= number.min && x <= number.max && !(number.above && x == number.min) &&
         !(number.nonzero && x == 0);
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

std::string range_of(const schemas::Number& number) {
  const std::string low = format_double(number.min);
  const std::string high = format_double(number.max);
  if (number.min == number.max) return low;
  const std::string range = number.above ? fmt::format("more than {}, up to {}", low, high)
                                         : fmt::format("{} to {}", low, high);
  return range + (number.nonzero ? ", but not 0" : "");
}

// The short way for numbers that are as they should be, with the same result. False: take the long
// way, which knows what to say.
bool read_plain(std::string_view text, const schemas::Value& value, std::span<double> out) {
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t i = 0; i < out.size(); ++i) {
    while (at < end && is_blank(*at)) ++at;
    const char* const first = at + (at < end && *at == '-' ? 1 : 0);
    // note: from_chars takes words as well
    if (first >= end || !((*first >= '0' && *first <= '9') || *first == '.')) return false;
    const auto [rest, error] = std::from_chars(at, end, out[i]);
    if (error != std::errc() || (rest < end && !is_blank(*rest))) return false;
    if (!in_range(out[i], number_at(value, i))) return false;
    at = rest;
  }
  while (at < end && is_blank(*at)) ++at;
  return at == end;
}

std::string noun(const schemas::Value& value) {
  return value.kind == schemas::ValueKind::integer ? "whole number" : "number";
}

}  // namespace

// ---- text

Values::Text Values::text_of(std::uint32_t element) {
  const xml::Element& e = doc_.elements[element];
  const std::uint32_t end = doc_.elements[e.next].first_run;
  const auto mine = [&](std::uint32_t run) {
    return run < end && (doc_.runs[run].owner & ~xml::kCdata) == element;
  };
  if (!mine(e.first_run)) return {{}, e.start_tag_end, nullptr};
  const xml::Run& first = doc_.runs[e.first_run];
  const std::string_view raw = doc_.bytes.substr(first.begin, first.end - first.begin);
  if (!mine(e.first_run + 1) && raw.find('&') == std::string_view::npos)
    return {raw, first.begin, nullptr};

  buffer_.clear();
  offsets_.clear();
  for (std::uint32_t i = e.first_run; i < end; ++i) {
    if (!mine(i)) continue;
    const xml::Run& run = doc_.runs[i];
    if ((run.owner & xml::kCdata) != 0) {
      buffer_ += doc_.bytes.substr(run.begin, run.end - run.begin);
      for (std::uint32_t k = run.begin; k < run.end; ++k) offsets_.push_back(k);
    } else {
      std::vector<std::uint32_t> piece;
      buffer_ += xml::decoded(doc_, run.begin, run.end, &piece);
      offsets_.insert(offsets_.end(), piece.begin(), piece.end() - 1);
    }
  }
  return {buffer_, first.begin, &offsets_};
}

Values::Text Values::text_of(const xml::Attribute& attribute) {
  const std::string_view raw =
      doc_.bytes.substr(attribute.value_begin, attribute.value_end - attribute.value_begin);
  if (raw.find('&') == std::string_view::npos && doc_.encoding == Encoding::utf8)
    return {raw, attribute.value_begin, nullptr};
  offsets_.clear();
  buffer_ = xml::decoded(doc_, attribute.value_begin, attribute.value_end, &offsets_);
  return {buffer_, attribute.value_begin, &offsets_};
}

bool Values::next_token(const Text& text, std::size_t& at, Token& token) {
  while (at < text.text.size() && is_blank(text.text[at])) ++at;
  if (at >= text.text.size()) return false;
  const std::size_t begin = at;
  while (at < text.text.size() && !is_blank(text.text[at])) ++at;
  token = {text.text.substr(begin, at - begin), begin};
  return true;
}

SourceSpan Values::place(const Text& text, const Token& token) const {
  const std::size_t last = token.at + std::max<std::size_t>(token.text.size(), 1) - 1;
  if (text.offsets == nullptr) {
    const auto begin = text.begin + static_cast<std::uint32_t>(token.at);
    return doc_.span(begin, begin + static_cast<std::uint32_t>(token.text.size()));
  }
  return doc_.span((*text.offsets)[token.at], (*text.offsets)[last] + 1);
}

// ---- numbers

bool Values::numbers(std::uint32_t element, std::span<double> out) {
  const schemas::Value& value = schema(element).text;
  assert(value.kind == schemas::ValueKind::real && value.count == out.size());
  const Text text = text_of(element);
  if (read_plain(text.text, value, out)) return true;
  std::size_t at = 0;
  std::size_t count = 0;
  Token token;
  bool ok = true;
  while (next_token(text, at, token)) {
    if (count < out.size()) ok = read_real(element, text, token, value, count, out[count]) && ok;
    ++count;
  }
  if (count == out.size()) return ok;
  // with a word among the numbers, how many there are is not the problem
  if (ok) bad_count(element, value, count);
  return false;
}

bool Values::integers(std::uint32_t element, std::vector<std::uint32_t>& out) {
  const schemas::Value& value = schema(element).text;
  assert(value.kind == schemas::ValueKind::integer && value.count == 0);
  out.clear();
  const Text text = text_of(element);
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

SourceSpan Values::place_of(std::uint32_t element, std::size_t number) {
  const Text text = text_of(element);
  std::size_t at = 0;
  Token token;
  for (std::size_t i = 0; next_token(text, at, token); ++i)
    if (i == number) return place(text, token);
  return doc_.name_span(element);
}

bool Values::read_real(std::uint32_t element, const Text& text, const Token& token,
                       const schemas::Value& value, std::size_t index, double& out) {
  const std::optional<double> number = parse_double(token.text);
  if (!number) {
    const Code code = is_too_large(token.text) ? Code::E1202 : Code::E1201;
    bad_number(code, element, text, token, value, index);
    return false;
  }
  const schemas::Number& limits = number_at(value, index);
  if (!in_range(*number, limits)) {
    const Code code = limits.nonzero && *number == 0 ? Code::E1211 : Code::E1202;
    bad_number(code, element, text, token, value, index);
    return false;
  }
  out = *number;
  return true;
}

bool Values::read_integer(std::uint32_t element, const Text& text, const Token& token,
                          const schemas::Value& value, std::size_t index, std::uint64_t& out) {
  std::string_view digits = token.text;
  const bool negative = digits.starts_with('-');
  if (negative || digits.starts_with('+')) digits.remove_prefix(1);
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (digits.empty() || end != digits.data() + digits.size()) {
    bad_number(Code::E1201, element, text, token, value, index);
    return false;
  }
  const schemas::Number& limits = number_at(value, index);
  const double sized = (negative ? -1.0 : 1.0) * static_cast<double>(number);
  if (error == std::errc::result_out_of_range || !in_range(sized, limits)) {
    bad_number(Code::E1202, element, text, token, value, index);
    return false;
  }
  out = number;
  return true;
}

std::string Values::subject(std::uint32_t element, const schemas::Value& value,
                            std::size_t index) const {
  const std::string_view name = number_at(value, index).name;
  if (value.count == 1 && &value == &schema(element).text)
    return fmt::format("<{}>", schema(element).name);
  return fmt::format("{} of <{}>", name.substr(0, name.find(':')), schema(element).name);
}

void Values::bad_number(Code code, std::uint32_t element, const Text& text, const Token& token,
                        const schemas::Value& value, std::size_t index) {
  reporter_.report(code, place(text, token), doc_, element, [&]() -> Reporter::Text {
    // numbers are read from raw bytes, which may be ISO-8859-1
    const Encoding encoding = text.offsets == nullptr ? doc_.encoding : Encoding::utf8;
    const std::string written = in_quotes(to_utf8(token.text.substr(0, 256), encoding));
    const std::string what = subject(element, value, index);
    const schemas::Number& limits = number_at(value, index);
    if (code == Code::E1202)
      return {fmt::format("{} is {}; it takes {}", what,
                          token.text.size() > 60 ? written : std::string(token.text),
                          range_of(limits))};
    if (code == Code::E1211)
      return {fmt::format(
          "{} is 0, which leaves nothing of what is below; it takes any other number", what)};
    std::string hint;
    if (token.text.find(',') != std::string_view::npos)
      hint = "numbers have a decimal point and are separated by blanks";
    else if (parse_double(token.text))
      hint = "it has no decimal point or exponent";
    return {
        fmt::format("{} is not a {}; {} takes {}", written, noun(value), what, range_of(limits)),
        hint};
  });
}

void Values::bad_count(std::uint32_t element, const schemas::Value& value, std::size_t count) {
  reporter_.report(Code::E1203, doc_.name_span(element), doc_, element, [&]() -> Reporter::Text {
    std::string names;
    if (value.count > 1)
      for (const schemas::Number& number : value.numbers)
        names += fmt::format("{}{}", names.empty() ? " (" : " ",
                             number.name.substr(0, number.name.find(':')));
    if (!names.empty()) names += ')';
    const std::string there = count == 0   ? "there is none"
                              : count == 1 ? "there is 1"
                                           : fmt::format("there are {}", count);
    return {fmt::format("<{}> takes {}{}, and {}", schema(element).name,
                        counted(value.count, noun(value)), names, there)};
  });
}

// ---- attributes

Values::Token Values::trimmed(const Text& text) {
  std::size_t begin = 0;
  std::size_t end = text.text.size();
  while (begin < end && is_blank(text.text[begin])) ++begin;
  while (end > begin && is_blank(text.text[end - 1])) --end;
  return {text.text.substr(begin, end - begin), begin};
}

std::optional<double> Values::real(std::uint32_t element, std::size_t attribute) {
  const schemas::Attribute& known = schema(element).attributes[attribute];
  assert(known.value.kind == schemas::ValueKind::real);
  const xml::Attribute* given = find_attribute(doc_, element, known.name);
  if (given == nullptr) return std::nullopt;
  const Text text = text_of(*given);
  double out = 0;
  if (!read_real(element, text, trimmed(text), known.value, 0, out)) return std::nullopt;
  return out;
}

bool Values::has(std::uint32_t element, std::size_t attribute) const {
  return find_attribute(doc_, element, schema(element).attributes[attribute].name) != nullptr;
}

bool Values::numbers(std::uint32_t, std::size_t, std::span<double>) { return false; }
bool Values::list(std::uint32_t, std::vector<double>&) { return false; }
std::optional<Quantity> Values::quantity(std::uint32_t, std::size_t) { return std::nullopt; }

std::optional<std::uint64_t> Values::integer(std::uint32_t element, std::size_t attribute) {
  const schemas::Attribute& known = schema(element).attributes[attribute];
  assert(known.value.kind == schemas::ValueKind::integer);
  const xml::Attribute* given = find_attribute(doc_, element, known.name);
  if (given == nullptr) return std::nullopt;
  const Text text = text_of(*given);
  std::uint64_t out = 0;
  if (!read_integer(element, text, trimmed(text), known.value, 0, out)) return std::nullopt;
  return out;
}

std::optional<std::string> Values::text(std::uint32_t element, std::size_t attribute) {
  const schemas::Attribute& known = schema(element).attributes[attribute];
  const xml::Attribute* given = find_attribute(doc_, element, known.name);
  if (given == nullptr) return std::nullopt;
  std::string out =
      to_utf8(xml::decoded(doc_, given->value_begin, given->value_end), Encoding::utf8);
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  if (out.find_first_not_of(' ') == std::string::npos) {
    reporter_.report(Code::E1103, doc_.value_span(*given), doc_, element, [&] {
      return Reporter::Text(
          fmt::format("the attribute '{}' of <{}> is empty", known.name, schema(element).name));
    });
    return std::nullopt;
  }
  if (known.value.kind != schemas::ValueKind::word) return out;
  if (std::find(known.value.words.begin(), known.value.words.end(), out) != known.value.words.end())
    return out;
  reporter_.report(Code::E1204, doc_.value_span(*given), doc_, element, [&]() -> Reporter::Text {
    const auto near = nearest_name(out, known.value.words);
    return {fmt::format("{} of <{}> is {}; it takes {}", known.name, schema(element).name,
                        in_quotes(out), fmt::join(known.value.words, " or ")),
            near ? fmt::format("did you mean '{}'?", *near) : ""};
  });
  return std::nullopt;
}

SourceSpan Values::value_place(std::uint32_t element, std::size_t attribute) const {
  const xml::Attribute* given =
      find_attribute(doc_, element, schema(element).attributes[attribute].name);
  return given == nullptr ? doc_.name_span(element) : doc_.value_span(*given);
}

}  // namespace panwright::pxn
