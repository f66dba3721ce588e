#include "pxn/expression/formula.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/text.h"
#include "pxn/expression/units.h"
#include "pxn/text/characters.h"

namespace panwright::pxn {

namespace {

constexpr std::string_view kBinaryOperators[] = {"<=", ">=", "!=", "==", "&&", "||", "<",
                                                 ">",  "+",  "-",  "*",  "/",  "^"};
// + - * / ^ may have no finite result
constexpr std::size_t kFirstArithmetic = 8;
constexpr std::string_view kOperatorChars = "+-*/^<>=!&|";

class FormulaReader {
 public:
  FormulaReader(std::string_view text, const Unit* length) : text_(text), length_(length) {
    frames_.push_back({});
  }

  Formula run() {
    if (text_.size() > kLongestExpression) {
      fail(0, 1,
           fmt::format("an expression of {1} bytes, expected at most {0}", kLongestExpression,
                       text_.size()),
           "<param> can name its parts");
      return finish();
    }
    while (!formula_.problem && skip_blanks()) {
      if (want_operand_)
        read_operand();
      else
        read_operator();
    }
    if (!formula_.problem) read_end();
    return finish();
  }

 private:
  // What is open around the place at hand.
  struct Frame {
    enum class Kind { all, parenthesis, function, condition } kind = Kind::all;
    std::size_t at = 0;  // of what opened it
    std::size_t function = 0;
    std::uint32_t values = 1;  // of the function, so far
    bool compared = false;     // a comparison stands to the left, in the same term of && and ||
  };
  using Kind = Frame::Kind;

  Formula finish() {
    if (formula_.problem) {
      Formula bad;
      bad.problem = std::move(formula_.problem);
      return bad;
    }
    return std::move(formula_);
  }

  void fail(std::size_t begin, std::size_t end, std::string message, std::string hint = {},
            Code code = Code("E1221")) {
    if (formula_.problem) return;
    formula_.problem = ExpressionProblem{code, begin, end, std::move(message), std::move(hint)};
  }

  bool skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
    return at_ < text_.size();
  }

  std::size_t character_length() const {
    std::size_t n = 1;
    while (at_ + n < text_.size() && (static_cast<unsigned char>(text_[at_ + n]) & 0xc0) == 0x80)
      ++n;
    return n;
  }

  std::string_view word_at(std::size_t at) const {
    std::size_t end = at;
    while (end < text_.size() && (is_letter(text_[end]) || is_digit(text_[end]))) ++end;
    return text_.substr(at, end - at);
  }

  void emit(std::string_view piece) {
    std::string& out = formula_.program;
    const auto is_operator = [](char c) {
      return kOperatorChars.find(c) != std::string_view::npos;
    };
    if (!out.empty() && is_operator(out.back()) && is_operator(piece[0])) out += ' ';
    out += piece;
  }

  void emit_operation(std::string_view name, std::string_view piece, std::size_t begin,
                      std::size_t end) {
    emit(piece);
    formula_.operations.push_back(
        {name, static_cast<std::uint32_t>(formula_.program.size() - piece.size()),
         static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)});
  }

  void emit_operand(Formula::Operand operand, std::size_t end) {
    emit(operand_name(formula_.operands.size()));
    operand.begin = static_cast<std::uint32_t>(at_);
    operand.end = static_cast<std::uint32_t>(end);
    formula_.operands.push_back(std::move(operand));
    at_ = end;
    want_operand_ = false;
  }

  // ---- where a value is needed

  void read_operand() {
    const char c = text_[at_];
    if (is_digit(c) || (c == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1])))
      return read_literal();
    if (is_letter(c)) return read_name();
    if (c == '(') {
      frames_.push_back({Kind::parenthesis, at_});
      emit("(");
      ++at_;
      return;
    }
    if (c == '-' || c == '+') return read_signs();
    if (c == '!' && text_.substr(at_, 2) != "!=") {
      emit("!");
      const std::size_t begin = at_++;
      if (skip_blanks() && (text_[at_] == '!' || text_[at_] == '-' || text_[at_] == '+'))
        fail(begin, at_ + 1, "a sign or another '!' after '!' needs parentheses", "write !(…)");
      return;
    }
    if (c == ')' && frames_.back().kind == Kind::function && is_open("("))
      return fail(at_, at_ + 1, "no value between these parentheses");
    missing_value();
  }

  // Whether this is what was read last.
  bool is_open(std::string_view piece) const { return formula_.program.ends_with(piece); }

  void missing_value() {
    const std::size_t length = character_length();
    const std::string_view found = text_.substr(at_, length);
    if (found == "{" || found == "}") return braces();
    const bool known = found.find_first_of("+-*/^<>=!&|?:,)") == 0;
    if (!known) return unknown_character();
    fail(at_, at_ + length, fmt::format("a value is missing before '{}'", found),
         text_.substr(at_ > 0 ? at_ - 1 : 0, 2) == "**" ? "powers are written ^" : "");
  }

  void braces() {
    fail(at_, at_ + 1, text_[at_] == '{' ? "nested braces" : "unmatched closing brace",
         text_[at_] == '{' ? "inside braces, parentheses group" : "");
  }

  void unknown_character() {
    const std::size_t length = character_length();
    const std::string_view found = text_.substr(at_, length);
    std::string hint;
    if (found == "%") hint = "the remainder is written mod(a, b)";
    if (found == "\"" || found == "'") hint = "expressions have no strings";
    if (found == "[" || found == "]") hint = "parentheses group";
    fail(at_, at_ + length,
         fmt::format("{} is not allowed in an expression",
                     in_quotes(to_utf8(found, Encoding::utf8))),
         hint);
  }

  void read_signs() {
    bool negative = false;
    while (skip_blanks() && (text_[at_] == '-' || text_[at_] == '+'))
      negative ^= text_[at_++] == '-';
    if (skip_blanks() && text_[at_] == '!')
      return fail(at_, at_ + 1, "a '!' after a sign needs parentheses", "write -(!…)");
    if (negative) emit("-");
  }

  void read_literal() {
    const std::size_t length = number_length(text_.substr(at_));
    const std::string_view number = text_.substr(at_, length);
    std::size_t end = at_ + length;
    // letters, digits, %, and the letter µ
    while (end < text_.size() && (is_letter(text_[end]) || is_digit(text_[end]) ||
                                  text_[end] == '%' || static_cast<signed char>(text_[end]) < 0))
      ++end;
    const std::string_view name = text_.substr(at_ + length, end - at_ - length);
    const Unit* unit = nullptr;
    if (!name.empty()) {
      unit = find_unit(name);
      if (unit == nullptr) return unknown_unit(name, at_ + length);
    }
    const bool is_length = unit != nullptr && unit->dimension == schemas::Dimension::length;
    const auto value = is_length && length_ != nullptr ? read_length(number, *unit, *length_)
                                                       : read_number(number, unit);
    if (!value)
      return fail(at_, end,
                  fmt::format("{} is past 1.8e308, the largest number", in_quotes(number)), {},
                  Code("E1223"));
    emit_operand({*value, unit == nullptr ? schemas::Dimension::none : unit->dimension, {}}, end);
  }

  void unknown_unit(std::string_view name, std::size_t at) {
    std::vector<std::string_view> names;
    for (const Unit& unit : all_units()) names.push_back(unit.name);
    const auto near = nearest_name(name, names);
    std::string hint;
    if (near)
      hint = fmt::format("did you mean '{}'?", *near);
    else if (is_letter(name[0]))
      hint = fmt::format("a product is written with *; units of length are {}",
                         units_of(schemas::Dimension::length));
    fail(at, at + name.size(),
         fmt::format("unknown unit {}", in_quotes(to_utf8(name, Encoding::utf8))), hint,
         Code("E1213"));
  }

  void read_name() {
    const std::string_view name = word_at(at_);
    const std::size_t begin = at_;
    at_ += name.size();
    if (!skip_blanks() || text_[at_] != '(') {
      at_ = begin;
      return emit_operand({0, schemas::Dimension::none, std::string(name)}, begin + name.size());
    }
    const auto known = std::find_if(std::begin(kFunctions), std::end(kFunctions),
                                    [&](const Function& f) { return f.name == name; });
    if (known == std::end(kFunctions)) {
      std::vector<std::string_view> names;
      for (const Function& f : kFunctions) names.push_back(f.name);
      const auto near = nearest_name(name, names);
      return fail(begin, begin + name.size(), fmt::format("unknown function {}", in_quotes(name)),
                  near ? fmt::format("did you mean '{}'?", *near) : "a product is written with *",
                  Code("E1222"));
    }
    const auto index = static_cast<std::size_t>(known - std::begin(kFunctions));
    const char piece[] = {'f', static_cast<char>('a' + index), 0};
    emit_operation(known->name, piece, begin, begin + name.size());
    emit("(");
    frames_.push_back({Kind::function, begin, index});
    ++at_;
  }

  // ---- where an operator is needed

  void read_operator() {
    for (std::size_t i = 0; i < std::size(kBinaryOperators); ++i) {
      const std::string_view op = kBinaryOperators[i];
      if (text_.substr(at_, op.size()) == op) return read_binary(i);
    }
    switch (text_[at_]) {
      case '?':
        frames_.back().compared = false;
        frames_.push_back({Kind::condition, at_});
        return step("?", true);
      case ':':
        if (frames_.back().kind != Kind::condition)
          return fail(at_, at_ + 1, "':' has no '?' before it");
        frames_.pop_back();
        frames_.back().compared = false;
        return step(":", true);
      case ',':
        return read_comma();
      case ')':
        return close();
      case '{':
      case '}':
        return braces();
      default:
        return missing_operator();
    }
  }

  void step(std::string_view piece, bool want_operand) {
    emit(piece);
    at_ += piece.size();
    want_operand_ = want_operand;
  }

  void read_binary(std::size_t i) {
    const std::string_view op = kBinaryOperators[i];
    Frame& frame = frames_.back();
    const bool compares = op != "&&" && op != "||" && i < kFirstArithmetic;
    if (compares && frame.compared)
      return fail(at_, at_ + op.size(), "comparisons do not chain", "write a < b && b < c");
    if (i < kFirstArithmetic) frame.compared = compares;
    if (i >= kFirstArithmetic)
      emit_operation(op, op, at_, at_ + op.size());
    else
      emit(op);
    at_ += op.size();
    want_operand_ = true;
  }

  void read_comma() {
    Frame& frame = frames_.back();
    if (frame.kind == Kind::condition) return no_colon();
    if (frame.kind != Kind::function)
      return fail(at_, at_ + 1, "',' outside the arguments of a function",
                  "numbers have a decimal point");
    frame.compared = false;
    if (++frame.values > kFunctions[frame.function].most) return wrong_number(frame);
    step(",", true);
  }

  void close() {
    const Frame frame = frames_.back();
    if (frame.kind == Kind::condition) return no_colon();
    if (frame.kind == Kind::all) return fail(at_, at_ + 1, "unmatched ')'");
    if (frame.kind == Kind::function && frame.values < kFunctions[frame.function].least)
      return wrong_number(frame);
    frames_.pop_back();
    step(")", false);
  }

  void wrong_number(const Frame& frame) {
    const Function& f = kFunctions[frame.function];
    fail(frame.at, frame.at + f.name.size(),
         fmt::format("{} takes {}, found {}", f.name, counted(f.most, "value"),
                     frame.values > f.most ? "more" : "1"));
  }

  void no_colon() {
    const std::size_t at = frames_.back().at;
    fail(at, at + 1, "this '?' has no ':'", "write condition ? value : other");
  }

  void missing_operator() {
    const char c = text_[at_];
    const bool value = is_digit(c) || is_letter(c) || c == '(' || c == '.';
    if (c == '=') return fail(at_, at_ + 1, "'=' is not an operator", "equality is written ==");
    if (c == '&' || c == '|')
      return fail(at_, at_ + 1, fmt::format("'{}' is not an operator", c),
                  c == '&' ? "write && (in XML, &amp;&amp;)" : "write ||");
    if (!value && c != '!') return unknown_character();
    const std::string_view word = is_letter(c) ? word_at(at_) : text_.substr(at_, 1);
    std::string hint;
    if (find_unit(word) != nullptr)
      hint = "a unit follows its number without a blank";
    else if (value)
      hint = "a product is written with *";
    fail(at_, at_ + word.size(), fmt::format("an operator is missing before {}", in_quotes(word)),
         hint);
  }

  void read_end() {
    const Frame& frame = frames_.back();
    if (formula_.program.empty() && formula_.operands.empty())
      return fail(0, text_.size(), "no expression between the braces");
    if (want_operand_)
      return fail(text_.size(), text_.size() + 1, "the expression ends where a value is needed");
    if (frame.kind == Kind::condition) return no_colon();
    if (frame.kind == Kind::parenthesis)
      return fail(frame.at, frame.at + 1, "this '(' is not closed");
    if (frame.kind == Kind::function)
      return fail(frame.at, frame.at + kFunctions[frame.function].name.size(),
                  "the parenthesis after this is not closed");
  }

  std::string_view text_;
  const Unit* length_;
  std::size_t at_ = 0;
  bool want_operand_ = true;
  std::vector<Frame> frames_;
  Formula formula_;
};

}  // namespace

std::string operand_name(std::size_t n) {
  constexpr std::string_view kDigits =
      "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
  return {'v', kDigits[n / kDigits.size()], kDigits[n % kDigits.size()]};
}

Formula read_formula(std::string_view text, const Unit* length) {
  return FormulaReader(text, length).run();
}

}  // namespace panwright::pxn
