#include "scenario/internal/json.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <tuple>

#include "base/text.h"

namespace panwright::scenario {

namespace {

constexpr std::size_t kMostJsonDepth = 16;
constexpr std::size_t kMostJsonValues = 4'000'000;

// Parser by recursive descent. It stops at the first error.
class JsonParser {
 public:
  explicit JsonParser(Input& input) : input_(input), text_(input.bytes()) {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;
  }

  std::optional<JsonValue> parse() {
    JsonValue value;
    if (!parse_value(value, 0)) return std::nullopt;
    skip_blanks();
    if (at_ < text_.size()) {
      fail("the end of the text");
      return std::nullopt;
    }
    return value;
  }

  std::optional<JsonValue> parse_lines() {
    skip_blanks();
    if (text_.substr(at_).starts_with('[')) return parse();
    JsonValue list;
    list.kind = JsonKind::list;
    list.at = text_.substr(std::min(at_, text_.size()), 1);
    for (; at_ < text_.size(); skip_blanks())
      if (!parse_value(list.items.emplace_back(), 1)) return std::nullopt;
    return list;
  }

 private:
  bool fail(std::string_view expected) {
    const std::string_view found = text_.substr(at_, 1);
    input_.error(Code("E8001"), text_.substr(std::min(at_, text_.size()), 1),
                 fmt::format("invalid JSON: expected {}, found {}", expected,
                             found.empty() ? std::string("the end") : in_quotes(found)));
    return false;
  }

  void skip_blanks() {
    while (at_ < text_.size() && (is_blank_char(text_[at_]) || text_[at_] == '\n')) ++at_;
  }

  bool mark(char c) {
    skip_blanks();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  bool parse_value(JsonValue& value, std::size_t depth) {
    skip_blanks();
    if (depth > kMostJsonDepth || ++values_ > kMostJsonValues) {
      input_.error(Code("E8001"), text_.substr(std::min(at_, text_.size()), 1),
                   depth > kMostJsonDepth ? "values are nested over 16 deep"
                                          : "the text has over 4 million values");
      return false;
    }
    if (at_ >= text_.size()) return fail("a value");
    value.at = text_.substr(at_, 1);
    const std::size_t begin = at_;
    const char c = text_[at_];
    if (c == '{') return parse_object(value, depth);
    if (c == '[') return parse_list(value, depth);
    if (c == '"') {
      value.kind = JsonKind::string;
      if (!parse_string(value.string)) return false;
    } else if (c == '-' || (c >= '0' && c <= '9')) {
      if (!parse_number(value)) return false;
    } else if (!parse_word(value)) {
      return false;
    }
    value.at = text_.substr(begin, at_ - begin);
    return true;
  }

  bool parse_word(JsonValue& value) {
    for (const auto& [word, kind, number] :
         {std::tuple{std::string_view("true"), JsonKind::boolean, 1.0},
          std::tuple{std::string_view("false"), JsonKind::boolean, 0.0},
          std::tuple{std::string_view("null"), JsonKind::null, 0.0}})
      if (text_.substr(at_).starts_with(word)) {
        value.kind = kind;
        value.number = number;
        at_ += word.size();
        return true;
      }
    return fail("a value");
  }

  bool parse_number(JsonValue& value) {
    const std::size_t begin = at_;
    while (at_ < text_.size() &&
           std::string_view("+-.eE0123456789").find(text_[at_]) != std::string_view::npos)
      ++at_;
    const auto number = parse_double(text_.substr(begin, at_ - begin));
    if (!number) {
      at_ = begin;
      return fail("a number");
    }
    value.kind = JsonKind::number;
    value.number = *number;
    return true;
  }

  bool parse_hex(std::uint32_t& code) {
    const std::string_view digits = text_.substr(std::min(at_, text_.size()), 4);
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
    if (error != std::errc() || end != digits.data() + digits.size() || digits.size() != 4)
      return fail("four hexadecimal digits");
    at_ += 4;
    return true;
  }

  static void append_utf8(std::string& out, std::uint32_t code) {
    const auto add = [&](std::uint32_t byte) { out.push_back(static_cast<char>(byte)); };
    if (code < 0x80) {
      add(code);
    } else if (code < 0x800) {
      add(0xc0 | code >> 6);
      add(0x80 | (code & 0x3f));
    } else if (code < 0x10000) {
      add(0xe0 | code >> 12);
      add(0x80 | (code >> 6 & 0x3f));
      add(0x80 | (code & 0x3f));
    } else {
      add(0xf0 | code >> 18);
      add(0x80 | (code >> 12 & 0x3f));
      add(0x80 | (code >> 6 & 0x3f));
      add(0x80 | (code & 0x3f));
    }
  }

  bool parse_escape(std::string& out) {
    const std::size_t kind =
        at_ < text_.size() ? std::string_view("\"\\/bfnrt").find(text_[at_]) : std::string::npos;
    if (kind != std::string_view::npos) {
      out.push_back("\"\\/\b\f\n\r\t"[kind]);
      ++at_;
      return true;
    }
    if (at_ >= text_.size() || text_[at_] != 'u') return fail("an escape as \\n or \\u00e9");
    ++at_;
    std::uint32_t code = 0, low = 0;
    if (!parse_hex(code)) return false;
    if (code >= 0xd800 && code < 0xdc00 && text_.substr(at_).starts_with("\\u")) {
      at_ += 2;
      if (!parse_hex(low)) return false;
      if (low < 0xdc00 || low > 0xdfff) return fail("the second half of a character");
      code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
    } else if (code >= 0xd800 && code <= 0xdfff) {
      return fail("both halves of a character");
    }
    append_utf8(out, code);
    return true;
  }

  bool parse_string(std::string& out) {
    ++at_;
    for (;;) {
      if (at_ >= text_.size() || static_cast<unsigned char>(text_[at_]) < 0x20)
        return fail("the end of a string");
      const char c = text_[at_++];
      if (c == '"') return true;
      if (c != '\\')
        out.push_back(c);
      else if (!parse_escape(out))
        return false;
    }
  }

  bool parse_list(JsonValue& value, std::size_t depth) {
    value.kind = JsonKind::list;
    ++at_;
    if (mark(']')) return true;
    do {
      if (!parse_value(value.items.emplace_back(), depth + 1)) return false;
    } while (mark(','));
    return mark(']') || fail("',' or ']'");
  }

  bool parse_object(JsonValue& value, std::size_t depth) {
    value.kind = JsonKind::object;
    ++at_;
    if (mark('}')) return true;
    do {
      skip_blanks();
      if (at_ >= text_.size() || text_[at_] != '"') return fail("a name in quotes");
      JsonValue::Member member;
      const std::size_t begin = at_;
      if (!parse_string(member.name)) return false;
      member.at = text_.substr(begin, at_ - begin);
      if (std::ranges::find(value.members, member.name, &JsonValue::Member::name) !=
          value.members.end()) {
        input_.error(Code("E8001"), member.at,
                     fmt::format("member {} stands twice", in_quotes(member.name)));
        return false;
      }
      if (!mark(':')) return fail("':'");
      if (!parse_value(member.value, depth + 1)) return false;
      value.members.push_back(std::move(member));
      if (value.members.size() > kMostMembers) return fail("an object of at most 1000 members");
    } while (mark(','));
    return mark('}') || fail("',' or '}'");
  }

  static constexpr std::size_t kMostMembers = 1000;
  Input& input_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t values_ = 0;
};

}  // namespace

std::optional<JsonValue> parse_json(Input& input) { return JsonParser(input).parse(); }
std::optional<JsonValue> parse_json_lines(Input& input) { return JsonParser(input).parse_lines(); }

}  // namespace panwright::scenario
