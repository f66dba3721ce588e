#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "base/text.h"
#include "workspace/internal/json_text.h"

namespace panwright::workspace {

namespace {

using Document = nlohmann::json;

constexpr std::size_t kMostNested = 16;

// Line, column (bytes) and what stands there. byte: from 1 on.
// first_line: the number of the text's first line.
JsonProblem problem_at(std::string_view text, std::size_t byte, bool out_of_range,
                       std::size_t first_line) {
  const std::size_t at = std::min(byte > 0 ? byte - 1 : 0, text.size());
  const std::string_view before = text.substr(0, at);
  const std::size_t line_start = before.rfind('\n') == before.npos ? 0 : before.rfind('\n') + 1;
  const auto line =
      first_line + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool other = first == text.npos || (text[first] != '{' && text[first] != '[');
  std::string found;
  if (first == text.npos) {
    found = "the text is empty";
  } else if (other) {
    constexpr std::size_t kShown = 20;
    const std::string_view begin = text.substr(first, kShown);
    found = "it begins with " + in_quotes(begin.substr(0, begin.find_first_of("\r\n")));
  } else if (out_of_range)
    found = "a number that is too large";
  else if (at == text.size())
    found = "the text ends";
  else if (static_cast<unsigned char>(text[at]) >= 0x80)
    found = "unexpected or invalid UTF-8";
  else
    found = "unexpected " + in_quotes(text.substr(at, 1));
  JsonProblem problem{
      fmt::format("invalid JSON at line {}, column {}: {}", line, at - line_start + 1, found), {}};
  const std::size_t last = before.find_last_not_of(" \t\r\n");
  if (at < text.size() && (text[at] == '}' || text[at] == ']') && last != before.npos &&
      before[last] == ',')
    problem.hint = "the last item has no comma after it";
  else if (at < text.size() && text[at] == '\'')
    problem.hint = "strings have double quotes";
  else if (at < text.size() && text[at] == '/')
    problem.hint = "JSON has no comments";
  else if (at < text.size() && text[at] == '{' && last != before.npos && before[last] == '}')
    problem.hint =
        "objects of a list have commas between them and [ ] around them; views, one a line, are a "
        "file .jsonl, or go to --views -";
  problem.other_format = other;
  return problem;
}

// Builds the value, and keeps the library's own words to itself.
class Builder : public nlohmann::json_sax<Document> {
 public:
  Builder(std::string_view text, std::size_t line, JsonText& out, JsonProblem& problem)
      : text_(text), line_(line), out_(out), problem_(problem) {}

  bool null() override { return add(nullptr) != nullptr; }
  bool boolean(bool value) override { return add(value) != nullptr; }
  bool number_integer(number_integer_t value) override { return add(value) != nullptr; }
  bool number_unsigned(number_unsigned_t value) override { return add(value) != nullptr; }
  bool number_float(number_float_t value, const string_t&) override {
    return add(value) != nullptr;
  }
  bool string(string_t& value) override { return add(std::move(value)) != nullptr; }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Document::object()); }
  bool start_array(std::size_t) override { return open(Document::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    if (open_.back()->contains(name)) {
      const Document& outer = *open_.front();
      out_.repeated.push_back({outer.is_array() ? outer.size() - 1 : 0, name});
    }
    key_ = std::move(name);
    return true;
  }
  bool parse_error(std::size_t byte, const std::string&,
                   const nlohmann::detail::exception& error) override {
    constexpr int kNumberOutOfRange = 406;
    problem_ = problem_at(text_, byte, error.id == kNumberOutOfRange, line_);
    return false;
  }

 private:
  Document* add(Document&& value) {
    if (open_.empty()) {
      out_.value = std::move(value);
      return &out_.value;
    }
    Document& parent = *open_.back();
    if (parent.is_array()) {
      parent.push_back(std::move(value));
      return &parent.back();
    }
    return &(parent[key_] = std::move(value));
  }
  bool open(Document&& value) {
    if (open_.size() == kMostNested) {
      problem_.message = fmt::format("values are nested more than {} deep", kMostNested);
      return false;
    }
    open_.push_back(add(std::move(value)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  std::string_view text_;
  std::size_t line_;
  JsonText& out_;
  JsonProblem& problem_;
  std::vector<Document*> open_;
  std::string key_;
};

}  // namespace

Result<JsonText> parse_json(std::string_view text, JsonProblem& problem, std::size_t line) {
  JsonText out;
  Builder builder(text, line, out, problem);
  if (!Document::sax_parse(text, &builder)) return failed;
  return out;
}

Result<JsonText> parse_json_lines(std::string_view text, JsonProblem& problem) {
  JsonText out{Document::array(), {}};
  std::size_t number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    at = end + 1;
    ++number;
    if (line.find_first_not_of(" \t\r") == line.npos) continue;
    auto one = parse_json(line, problem, number);
    if (!one) return failed;
    for (JsonText::Repeated& each : one->repeated)
      out.repeated.push_back({out.value.size(), std::move(each.member)});
    out.value.push_back(std::move(one->value));
  }
  return out;
}

const char* json_type(const nlohmann::json& value) {
  if (value.is_array()) return value.empty() ? "an empty list" : "a list";
  if (value.is_object()) return "an object";
  if (value.is_string()) return "text";
  return value.is_null() ? "null" : value.is_boolean() ? "a truth value" : "a number";
}

}  // namespace panwright::workspace
