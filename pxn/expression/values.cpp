#include "pxn/expression/values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "base/text.h"
#include "pxn/text/characters.h"
#include "pxn/text/grammar.h"

namespace panwright::pxn {

namespace {

bool is_ascii(std::string_view text) {
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

}  // namespace

void Values::set_units(const Units& units) {
  units_ = units;
  length_unit_ = find_unit(schemas::Dimension::length, units.length);
  angle_unit_ = find_unit(schemas::Dimension::angle, units.angle);
  BareUnits bare;
  if (length_unit_ != nullptr) bare.length = length_unit_;
  if (angle_unit_ != nullptr) bare.angle = angle_unit_;
  expressions_.set_units(bare);
}

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
  if (!mine(e.first_run + 1) && raw.find('&') == std::string_view::npos &&
      (doc_.encoding == Encoding::utf8 || is_ascii(raw)))
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

// Blanks separate tokens, but not inside braces.
bool Values::next_token(const Text& text, std::size_t& at, Token& token) const {
  while (at < text.text.size() && is_blank(text.text[at])) ++at;
  if (at >= text.text.size()) return false;
  const std::size_t begin = at;
  const bool braces = units_.level >= 1;
  std::size_t depth = 0;
  for (; at < text.text.size() && (depth > 0 || !is_blank(text.text[at])); ++at) {
    if (braces && text.text[at] == '{') ++depth;
    if (braces && text.text[at] == '}' && depth > 0) --depth;
  }
  token = {text.text.substr(begin, at - begin), begin};
  return true;
}

Values::Token Values::trimmed(const Text& text) {
  std::size_t begin = 0;
  std::size_t end = text.text.size();
  while (begin < end && is_blank(text.text[begin])) ++begin;
  while (end > begin && is_blank(text.text[end - 1])) --end;
  return {text.text.substr(begin, end - begin), begin};
}

SourceSpan Values::place(const Text& text, const Token& token) const {
  const std::size_t last = token.at + std::max<std::size_t>(token.text.size(), 1) - 1;
  if (text.offsets == nullptr) {
    const auto begin = text.begin + static_cast<std::uint32_t>(token.at);
    return doc_.span(begin, begin + static_cast<std::uint32_t>(token.text.size()));
  }
  return doc_.span((*text.offsets)[token.at], (*text.offsets)[last] + 1);
}

// ---- attributes

std::optional<double> Values::real(std::uint32_t element, std::size_t attribute) {
  const schemas::Attribute& known = schema(element).attributes[attribute];
  assert(known.value.kind == schemas::ValueKind::real);
  const xml::Attribute* given = find_attribute(doc_, element, known.name);
  if (given == nullptr) return std::nullopt;
  const Text text = text_of(*given);
  double out = 0;
  if (has_commas(element, text, known.value) ||
      !read_real(element, text, trimmed(text), known.value, 0, out))
    return std::nullopt;
  check_radians(element, text, known.value);
  return out;
}

bool Values::has(std::uint32_t element, std::size_t attribute) const {
  return find_attribute(doc_, element, schema(element).attributes[attribute].name) != nullptr;
}

bool Values::numbers(std::uint32_t element, std::size_t attribute, std::span<double> out) {
  const schemas::Attribute& known = schema(element).attributes[attribute];
  assert(known.value.kind == schemas::ValueKind::real && known.value.count == out.size());
  const xml::Attribute* given = find_attribute(doc_, element, known.name);
  if (given == nullptr) return false;
  const Text text = text_of(*given);
  if (read_plain(text.text, known.value, out))
    return check_radians(element, text, known.value), true;
  std::size_t count = 0;
  const bool ok = read_all(element, text, known.value, out, count);
  if (count == out.size()) return ok;
  if (count == 1 && known.value.one) {
    std::fill(out.begin() + 1, out.end(), out[0]);
    return ok;
  }
  if (ok)
    bad_count(element, known.value, fmt::format("{} of <{}>", known.name, schema(element).name),
              count);
  return false;
}

bool Values::is_word(std::uint32_t element, std::size_t attribute) {
  const schemas::Attribute& known = schema(element).attributes[attribute];
  const xml::Attribute* given = find_attribute(doc_, element, known.name);
  if (given == nullptr || known.value.words.empty()) return false;
  const Text text = text_of(*given);
  return std::ranges::find(known.value.words, trimmed(text).text) != known.value.words.end();
}

std::optional<Quantity> Values::quantity(std::uint32_t element, std::size_t attribute) {
  const schemas::Attribute& known = schema(element).attributes[attribute];
  assert(known.value.kind == schemas::ValueKind::quantity);
  const xml::Attribute* given = find_attribute(doc_, element, known.name);
  if (given == nullptr) return std::nullopt;
  const Text text = text_of(*given);
  const auto amount = read_amount(element, text, trimmed(text), known.value, 0);
  if (!amount) return std::nullopt;
  const BareUnits& bare = expressions_.units();
  Quantity out{amount->value, amount->dimension, bare.length->factor, bare.angle->factor};
  if (amount->computed) {
    const Measured& measured = amount->measured;
    out.length = measured.length;
    out.angle = measured.angle;
    out.pi = measured.pi;
    out.ratio = measured.ratio;
  } else if (amount->dimension == schemas::Dimension::length) {
    const std::string_view number = trimmed(text).text;
    out.value = read_length(number.substr(0, number_length(number)), *amount->unit, *bare.length)
                    .value_or(amount->value);
  }
  return out;
}

bool Values::quantities(std::uint32_t element, std::size_t attribute,
                        std::span<const schemas::Dimension> dimensions, std::vector<double>& out) {
  static constexpr schemas::Number kAny[] = {{"value", -1e9, 1e9, false, false}};
  const schemas::Attribute& known = schema(element).attributes[attribute];
  assert(known.value.kind == schemas::ValueKind::quantity);
  const xml::Attribute* given = find_attribute(doc_, element, known.name);
  if (given == nullptr) return false;
  schemas::Value value;
  value.kind = schemas::ValueKind::real;
  value.numbers = kAny;
  value.count = static_cast<std::uint32_t>(dimensions.size());
  const Text text = text_of(*given);
  out.clear();
  if (has_commas(element, text, value)) return false;
  std::size_t at = 0;
  Token token;
  bool ok = true;
  while (next_token(text, at, token)) {
    double number = 0;
    if (out.size() < dimensions.size()) {
      value.dimension = dimensions[out.size()];
      ok = read_real(element, text, token, value, 0, number) && ok;
    }
    out.push_back(number);
  }
  if (ok && out.size() != dimensions.size()) {
    schemas::Value counted = value;
    counted.numbers = {};
    bad_count(element, counted, fmt::format("{} of <{}>", known.name, schema(element).name),
              out.size());
  }
  return ok && out.size() == dimensions.size();
}

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
  const bool free =
      known.value.kind == schemas::ValueKind::label || known.value.kind == schemas::ValueKind::path;
  if (units_.level >= 1 && free && out.find_first_of("{}") != std::string::npos) {
    offsets_.clear();
    buffer_ = xml::decoded(doc_, given->value_begin, given->value_end, &offsets_);
    out.clear();
    if (!replace_expressions(element, {buffer_, given->value_begin, &offsets_}, out))
      return std::nullopt;
    out = to_utf8(out, Encoding::utf8);
  }
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  if (out.find_first_not_of(' ') == std::string::npos) {
    reporter_.report(Code("E1103"), doc_.value_span(*given), doc_, element, [&] {
      return Reporter::Text(
          fmt::format("the attribute '{}' of <{}> is empty", known.name, schema(element).name));
    });
    return std::nullopt;
  }
  if (known.value.kind != schemas::ValueKind::word) return out;
  if (std::find(known.value.words.begin(), known.value.words.end(), out) != known.value.words.end())
    return out;
  reporter_.report(Code("E1204"), doc_.value_span(*given), doc_, element, [&]() -> Reporter::Text {
    const auto near = nearest_name(out, known.value.words);
    return {fmt::format("{} of <{}> is {}, expected {}", known.name, schema(element).name,
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
