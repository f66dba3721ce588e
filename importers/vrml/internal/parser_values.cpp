#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "importers/vrml/internal/characters.h"
#include "importers/vrml/internal/numbers.h"
#include "importers/vrml/internal/parser.h"

namespace panwright::importers::vrml {

namespace {

bool ends_number(char c) { return is_blank(c) || c == ']' || c == '}' || c == '['; }

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c; }

// "nan", "-inf", "Infinity"…, as C libraries print them.
bool is_nonfinite_word(std::string_view word) {
  if (!word.empty() && (word.front() == '-' || word.front() == '+')) word.remove_prefix(1);
  std::string text(word.substr(0, 9));
  std::transform(text.begin(), text.end(), text.begin(), lower);
  return text == "nan" || text == "inf" || text == "infinity" || text.starts_with("nan(") ||
         text == "1.#ind";
}

}  // namespace

// Reads the value of a field. False when there is none, which has been reported.
bool Parser::value(FieldType type, Field& field) {
  skip_blanks();
  const char* const at = p_;
  field.value.type = type;
  bool good = false;
  switch (type) {
    case FieldType::none:
      break;
    case FieldType::sf_bool:
    case FieldType::mf_bool:
      good = booleans(type, field.value);
      break;
    case FieldType::sf_int32:
    case FieldType::mf_int32:
      good = integers(type, field.value);
      break;
    case FieldType::sf_image:
      good = image(field.value);
      break;
    case FieldType::sf_string:
    case FieldType::mf_string:
      good = strings(type, field.value);
      break;
    case FieldType::sf_enum:
    case FieldType::sf_bitmask:
      good = words10(type, field.value);
      break;
    case FieldType::sf_node:
    case FieldType::mf_node:
      good = nodes(type, field.value);
      break;
    default:
      good = numbers(type, field.value);
  }
  const char* end = p_;
  while (end > at && is_blank(end[-1])) --end;
  field.where = span(at, end);
  return good;
}

// ---- lists of numbers

// What stands in a list where a number was expected: false ends the list. *zero: it was meant as a
// number that cannot be.
bool Parser::in_list(const char* open, bool* zero) {
  *zero = false;
  skip_blanks();
  const char c = *p_;
  if (at_end()) {
    text_ends(span(open, open + 1), "list");
    return false;
  }
  if (c == '}') {
    report(Code("E6103"), here(), "']' is missing before this", "the list began earlier");
    return false;
  }
  if (c == ']' || may_begin_number(c)) return true;
  const std::string_view text = token_here();
  if (is_nonfinite_word(text)) {
    not_finite();
    *zero = true;
    return true;
  }
  if (is_word(c)) {
    const bool keyword = text == "DEF" || text == "USE" || text == "ROUTE" || text == "PROTO";
    const bool field = field_names_ != nullptr && spec_of(*field_names_, text) != nullptr;
    if (keyword || field || brace_follows()) {
      report(Code("E6103"), here(), fmt::format("']' is missing before {}", in_quotes(text)));
      return false;
    }
  }
  report(Code("E6103"), here(), fmt::format("unexpected {} in a list of numbers", in_quotes(text)));
  if (c == '"')
    skip_string();
  else if (c == '{')
    skip_braces();
  else
    p_ += text.size();
  return true;
}

// "nan" and the like are counted, and reported once for a value.
void Parser::not_finite() {
  if (nonfinite_++ == 0) nonfinite_at_ = here();
  p_ += token_here().size();
}

void Parser::report_not_finite() {
  const std::size_t count = std::exchange(nonfinite_, 0);
  if (count == 0) return;
  const std::string_view text(begin_ + nonfinite_at_.begin,
                              nonfinite_at_.end - nonfinite_at_.begin);
  report(Code("E6107"), nonfinite_at_,
         count == 1 ? fmt::format("{} is not a finite number; 0 is used instead", in_quotes(text))
                    : fmt::format("{} is not a finite number; 0 is used instead, and for {} more",
                                  in_quotes(text), count - 1));
}

// Reads what begins like a number and is not a plain one. The value to go on with.
double Parser::odd_number(bool whole) {
  const char* const at = p_;
  double out = 0;
  const NumberKind kind = read_number(p_, out);
  if (kind == NumberKind::good && !(whole && out != std::floor(out))) {
    const bool apart = ends_number(*p_) || *p_ == '#' || at_end();
    const bool touches = (*p_ == '-' || *p_ == '+') && at_number();
    const std::string_view rest(p_, static_cast<std::size_t>(end_ - p_));
    const bool microsoft = rest.starts_with("#I") || rest.starts_with("#Q") ||
                           rest.starts_with("#S");  // 1.#IND, 1.#QNAN…
    if (!microsoft && (apart || touches || *p_ == '"')) {
      if (whole && std::fabs(out) > 4294967295.0) {
        report(Code("E6107"), span(at, p_), "the number is too large for 32 bits");
        return 0;
      }
      if (whole && !terse() && !whole_reported_) {
        report(Code("W6118"), span(at, p_),
               fmt::format("{} is read as a whole number",
                           in_quotes({at, static_cast<std::size_t>(p_ - at)})));
        whole_reported_ = true;
      }
      return out;
    }
    if (microsoft) ++p_;
  }
  while (is_word(*p_)) ++p_;
  if (p_ == at) ++p_;
  const std::string_view text(at, static_cast<std::size_t>(p_ - at));
  report(Code("E6107"), span(at, p_),
         kind == NumberKind::too_large
             ? fmt::format("{} is too large for a number", in_quotes(text))
             : fmt::format("{} is not a {}number", in_quotes(text), whole ? "whole " : ""));
  return 0;
}

bool Parser::one_number(double& out) {
  const char* const at = p_;
  if (read_number(p_, out) == NumberKind::good && ends_number(*p_)) return true;
  p_ = at;
  if (is_nonfinite_word(token_here())) {
    not_finite();
    out = 0;
    return true;
  }
  if (!at_number()) return false;
  out = odd_number(false);
  return true;
}

bool Parser::one_number(std::int32_t& out) {
  const char* const at = p_;
  if (read_integer(p_, out) == NumberKind::good && ends_number(*p_)) return true;
  p_ = at;
  if (is_nonfinite_word(token_here())) {
    not_finite();
    out = 0;
    return true;
  }
  if (!at_number()) return false;
  if (*p_ == '0' && (p_[1] | 0x20) == 'x' && read_integer(p_, out) == NumberKind::good &&
      !is_word(*p_))
    return true;
  p_ = at;
  const double value = odd_number(true);
  out = static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::int64_t>(value)));
  return true;
}

template <class T>
void Parser::read_list(Growing<T>& out, const char* open) {
  for (;;) {
    while (is_blank(*p_)) ++p_;
    if (p_ >= forget_at_) forget();
    const char c = *p_;
    if (may_begin_number(c)) {
      T number{};
      if (one_number(number)) {
        out.push(number);
        continue;
      }
      const std::string_view text = token_here();
      report(Code("E6103"), here(),
             fmt::format("unexpected {} in a list of numbers", in_quotes(text)));
      p_ += text.size();
      continue;
    }
    if (c == ']') {
      ++p_;
      return;
    }
    bool zero = false;
    if (!in_list(open, &zero)) return;
    if (zero) out.push(T{});
  }
}

// Numbers that stand one after the other, without brackets.
template <class T>
void Parser::read_some(Growing<T>& out, std::size_t most) {
  while (out.size() < most) {
    skip_blanks();
    T number{};
    if (at_end() || !is_word(*p_) || !one_number(number)) return;
    out.push(number);
  }
}

template <class T>
bool Parser::read_numbers(FieldType type, Growing<T>& out) {
  const std::size_t width = width_of(type);
  const char* const at = p_;
  out.resize_down(0);
  const bool list = is_list(type);
  if (*p_ == '[') {
    ++p_;
    read_list(out, at);
    if (!list && out.size() == width) {
      report(Code("W6118"), span(at, at + 1), fmt::format("{} without brackets", type_name(type)));
      report_not_finite();
      return true;
    }
  } else {
    read_some(out, width);
    const std::size_t first = out.size();
    if (first == width) read_some(out, ~std::size_t{0});
    if (list && out.size() > width)
      report(Code("W6118"), span(at, at + 1), "a list of more than one item requires brackets");
  }
  report_not_finite();
  const char* end = p_;
  while (end > at && is_blank(end[-1])) --end;
  const std::size_t count = out.size();
  if (list ? count % width == 0 && (count > 0 || *at == '[') : count == width) return true;
  if (count == 0) {
    const std::string_view text = token_here();
    report(Code("E6103"), here(),
           fmt::format(
               "a {} is expected{}", type_name(type),
               at_end() ? std::string(" where the text ends") : ", and not " + in_quotes(text)));
    return false;
  }
  if (list) {
    report(Code("E6106"), span(std::max(at, end - 1), end),
           fmt::format("the list has {}, which is not a multiple of {}", counted(count, "number"),
                       width));
    out.resize_down(count - count % width);
    return true;
  }
  report(Code("E6106"), span(at, end),
         fmt::format("{} needs {}, got {}", type_name(type), counted(width, "number"), count));
  if (count < width) return false;
  out.resize_down(width);
  return true;
}

bool Parser::numbers(FieldType type, Value& value) {
  if (!read_numbers(type, doubles_)) return false;
  const auto kept = doubles_.given_to(arena_);
  value.data = kept.data();
  value.size = kept.size();
  return true;
}

bool Parser::integers(FieldType type, Value& value) {
  if (!read_numbers(type, integers_)) return false;
  const auto kept = integers_.given_to(arena_);
  value.data = kept.data();
  value.size = kept.size();
  return true;
}

// width height components, and as many pixels.
bool Parser::image(Value& value) {
  const char* const at = p_;
  integers_.resize_down(0);
  read_some(integers_, ~std::size_t{0});
  report_not_finite();
  if (integers_.size() < 3) {
    report(Code("E6106"), span(at, std::max(p_, at + 1)),
           fmt::format("SFImage needs width, height and components, got {}",
                       counted(integers_.size(), "number")));
    return false;
  }
  const std::int64_t width = integers_[0];
  const std::int64_t height = integers_[1];
  const std::int64_t components = integers_[2];
  const auto pixels = static_cast<std::int64_t>(integers_.size()) - 3;
  if (width < 0 || height < 0 || components < 0 || components > 4) {
    report(Code("E6107"), span(at, at + 1),
           fmt::format("an image of {}x{} pixels with {} components cannot be", width, height,
                       components));
    return false;
  }
  if (width * height != pixels) {
    report(Code("E6106"), span(at, at + 1),
           fmt::format("an image of {}x{} has {}", width, height, counted(pixels, "pixel")));
    if (width * height > pixels) return false;
    integers_.resize_down(static_cast<std::size_t>(3 + width * height));
  }
  const auto kept = integers_.given_to(arena_);
  value.data = kept.data();
  value.size = kept.size();
  return true;
}

bool Parser::booleans(FieldType type, Value& value) {
  const char* const open = p_;
  const bool bracket = *p_ == '[';
  if (bracket) ++p_;
  integers_.resize_down(0);
  for (;;) {
    skip_blanks();
    if (bracket && *p_ == ']') {
      ++p_;
      break;
    }
    const std::string_view text = peek_word();
    const bool yes = text == "TRUE" || text == "true" || text == "True" || text == "1";
    const bool no = text == "FALSE" || text == "false" || text == "False" || text == "0";
    if (!yes && !no) {
      bool zero = false;
      if (bracket && in_list(open, &zero) && !zero) {
        if (may_begin_number(*p_)) p_ += token_here().size();
        continue;
      }
      break;
    }
    if (text != "TRUE" && text != "FALSE" && vrml97_)
      report(Code("W6118"), here(),
             fmt::format("{} is read as {}", in_quotes(text), yes ? "TRUE" : "FALSE"));
    p_ += text.size();
    integers_.push(yes ? 1 : 0);
    if (!bracket) break;
  }
  if (integers_.size() == 0 && !(bracket && is_list(type))) {
    report(Code("E6107"), here(),
           fmt::format("expected TRUE or FALSE, found {}", in_quotes(token_here())));
    const bool skipped =
        at_word() && !brace_follows() &&
        (field_names_ == nullptr || spec_of(*field_names_, peek_word()) == nullptr);
    if (skipped || at_number()) p_ += token_here().size();
    return false;
  }
  const auto kept = integers_.given_to(arena_);
  value.data = kept.data();
  value.size = kept.size();
  return true;
}

// ---- strings and words

// Reads a string from its opening quote on.
bool Parser::string(std::string_view& out) {
  const char* const open = p_;
  bool escaped = false;
  const char* at = p_ + 1;
  while (at < end_ && *at != '"') {
    if (*at == '\\') {
      escaped = true;
      ++at;
    }
    ++at;
  }
  if (at >= end_) {
    report(Code("E6112"), span(open, open + 1), "the text ends inside this string");
    // the rest of the line is taken for the string, so that what follows is not lost
    at = open + 1;
    while (at < end_ && *at != '\n' && *at != '\r') ++at;
    p_ = at;
    out = {};
    return false;
  }
  p_ = at + 1;
  out = {open + 1, static_cast<std::size_t>(at - open - 1)};
  const bool foreign = latin1_ && first_not_utf8(out) != out.npos;
  if (!escaped && !foreign) return true;
  std::string text;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (out[i] == '\\' && i + 1 < out.size() && (out[i + 1] == '"' || out[i + 1] == '\\')) ++i;
    text += out[i];
  }
  if (foreign) text = to_utf8(text, Encoding::latin1);
  out = arena_.copied(std::string_view(text));
  return true;
}

bool Parser::strings(FieldType type, Value& value) {
  strings_.clear();
  const char* const open = p_;
  const bool bracket = *p_ == '[';
  if (bracket) ++p_;
  for (;;) {
    skip_blanks();
    if (*p_ == '"') {
      std::string_view text;
      if (string(text)) strings_.push_back(text);
      if (!bracket) break;
      continue;
    }
    if (bracket && *p_ == ']') {
      ++p_;
      break;
    }
    const bool field =
        at_word() && field_names_ != nullptr && spec_of(*field_names_, peek_word()) != nullptr;
    if (is_word(*p_) && !field && !brace_follows()) {
      if (vrml97_)
        report(Code("W6118"), here(),
               fmt::format("{} is read as a string: quotes are missing", in_quotes(peek_word())));
      strings_.push_back(name());
      if (!bracket) break;
      continue;
    }
    if (!bracket) break;
    if (at_end()) {
      text_ends(span(open, open + 1), "list");
    } else {
      report(Code("E6103"), here(),
             fmt::format("']' is missing before {}", in_quotes(token_here())));
    }
    break;
  }
  if (strings_.empty() && !(bracket && is_list(type))) {
    if (*p_ != '\n' && *p_ != '\r')
      report(Code("E6103"), here(),
             fmt::format("expected a string, found {}", in_quotes(token_here())));
    return false;
  }
  if (!is_list(type)) strings_.resize(1);
  const auto kept = arena_.copied(std::span<const std::string_view>(strings_));
  value.data = kept.data();
  value.size = kept.size();
  return true;
}

// VRML 1.0: WORD, or ( WORD | WORD ) of a bit mask.
bool Parser::words10(FieldType type, Value& value) {
  strings_.clear();
  const auto part = [&] {
    const char* p = p_;
    while (is_word(*p) && *p != '(' && *p != ')' && *p != '|') ++p;
    const std::string_view out(p_, static_cast<std::size_t>(p - p_));
    p_ = p;
    return out;
  };
  const bool bracket = *p_ == '(' || *p_ == '[';
  if (bracket) ++p_;
  for (;;) {
    skip_blanks();
    const std::string_view text = part();
    if (!text.empty()) strings_.push_back(text);
    skip_blanks();
    if (!bracket) break;
    if (*p_ == ')' || *p_ == ']') {
      ++p_;
      break;
    }
    if (*p_ == '|') {
      ++p_;
    } else if (text.empty()) {
      report(Code("E6103"), here(), "')' is missing before this");
      break;
    }
  }
  if (strings_.empty()) {
    report(Code("E6103"), here(),
           fmt::format("expected a word, found {}", in_quotes(token_here())));
    return false;
  }
  if (type == FieldType::sf_enum) strings_.resize(1);
  const auto kept = arena_.copied(std::span<const std::string_view>(strings_));
  value.data = kept.data();
  value.size = kept.size();
  return true;
}

// ---- nodes

bool Parser::nodes(FieldType type, Value& value) {
  const std::size_t first = node_stack_.size();
  const char* const open = p_;
  const bool bracket = *p_ == '[';
  bool there = false;
  if (bracket) {
    ++p_;
    for (;;) {
      skip_blanks();
      if (at_end()) {
        text_ends(span(open, open + 1), "list");
        break;
      }
      if (*p_ == ']') {
        ++p_;
        break;
      }
      if (*p_ == '}') {
        report(Code("E6103"), here(), "']' is missing before this");
        break;
      }
      if (at_word() && vrml97_ && declaration()) continue;
      if (Node* node = node_value(&there)) node_stack_.push_back(node);
      if (!there) skip_stray(']');
    }
  } else {
    const std::string_view text = peek_word();
    const bool field =
        text != "USE" && text != "DEF" && text != "NULL" && !text.empty() && !brace_follows();
    if (field || !at_word()) {
      report(Code("E6103"), here(),
             at_end() ? "expected a node, found the end of the text"
                      : fmt::format("expected a node, found {}", in_quotes(token_here())));
      return false;
    }
    if (Node* node = node_value(&there)) node_stack_.push_back(node);
  }
  std::span<Node* const> list = std::span<Node* const>(node_stack_).subspan(first);
  if (type == FieldType::sf_node && list.size() > 1) {
    report(Code("E6106"), span(open, open + 1),
           fmt::format("SFNode holds one node, found {}", list.size()));
    list = list.first(1);
  }
  const auto kept = arena_.copied(list);
  value.data = kept.data();
  value.size = kept.size();
  node_stack_.resize(first);
  return true;
}

}  // namespace panwright::importers::vrml
