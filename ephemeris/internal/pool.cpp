#include "ephemeris/internal/pool.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

#include "base/text.h"

namespace panwright::ephemeris {

namespace {

bool is_separator(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ','; }

std::string_view bare_line(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  if (first == line.npos) return {};
  return line.substr(first, line.find_last_not_of(" \t\r") - first + 1);
}

bool is_mark(std::string_view line, std::string_view mark) {
  line = bare_line(line);
  return line.size() == mark.size() && std::ranges::equal(line, mark, {}, [](char c) {
           return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
         });
}

// Number whose exponent is E or D.
std::optional<double> kernel_number(std::string_view word) {
  std::string text(word);
  for (char& c : text)
    if (c == 'd' || c == 'D') c = 'e';
  if (text.starts_with('+')) text.erase(0, 1);
  return parse_double(text);
}

// Days after 2000-01-01 of a date of the Gregorian calendar (Hinnant's algorithm).
std::int64_t days_of(std::int64_t year, std::int64_t month, std::int64_t day) {
  year -= month <= 2 ? 1 : 0;
  const std::int64_t era = (year >= 0 ? year : year - 399) / 400;
  const std::int64_t of_era = year - era * 400;
  const std::int64_t of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  return era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 730425;
}

// Number of a month: digits, or the first three letters of its name. 0: none.
int month_of(std::string_view word) {
  constexpr std::string_view kMonths = "JANFEBMARAPRMAYJUNJULAUGSEPOCTNOVDEC";
  if (word.size() >= 3 && std::isalpha(static_cast<unsigned char>(word[0]))) {
    std::string name(word.substr(0, 3));
    for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    const std::size_t at = kMonths.find(name);
    return at == kMonths.npos || at % 3 != 0 ? 0 : static_cast<int>(at / 3) + 1;
  }
  const auto number = parse_double(word);
  return number && *number >= 1 && *number <= 12 && *number == std::floor(*number)
             ? static_cast<int>(*number)
             : 0;
}

// Reader of the data of one kernel.
class PoolReader {
 public:
  PoolReader(std::string_view text, std::map<std::string, Values, std::less<>>& values)
      : text_(text), values_(values) {}

  bool read(std::string& problem) {
    bool data = false;
    while (at_ < text_.size()) {
      const std::size_t end = std::min(text_.find('\n', at_), text_.size());
      const std::string_view line = text_.substr(at_, end - at_);
      if (is_mark(line, "\\begindata")) {
        data = true;
      } else if (is_mark(line, "\\begintext")) {
        data = false;
      } else if (data && !bare_line(line).empty()) {
        if (!read_assignment(problem)) return false;
        continue;
      }
      at_ = std::min(end + 1, text_.size());
      ++line_;
    }
    return true;
  }

 private:
  bool fail(std::string& problem, std::size_t line, std::string what) {
    problem = fmt::format("line {}: {}", line, what);
    return false;
  }

  void skip_blanks() {
    for (; at_ < text_.size() && is_separator(text_[at_]); ++at_)
      if (text_[at_] == '\n') ++line_;
  }
  // A plain word, up to a blank, comma or one of =(){}'.
  std::string_view word() {
    skip_blanks();
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_separator(text_[at_]) && text_[at_] != '=' &&
           text_[at_] != '(' && text_[at_] != ')' && text_[at_] != '\'')
      ++at_;
    return text_.substr(begin, at_ - begin);
  }
  bool mark(std::string_view text) {
    skip_blanks();
    if (!text_.substr(at_).starts_with(text)) return false;
    at_ += text.size();
    return true;
  }

  // NAME = value, NAME = ( value … ), NAME += ….
  bool read_assignment(std::string& problem) {
    std::string_view name = word();
    const std::size_t line = line_;
    bool adds = false;
    if (name.ends_with('+')) {
      adds = true;
      name.remove_suffix(1);
    }
    if (name.empty()) return fail(problem, line, "expected the name of a variable");
    adds = adds || mark("+");
    if (!mark("="))
      return fail(problem, line, fmt::format("expected = behind {}", in_quotes(name)));
    Values read;
    if (mark("(")) {
      while (!mark(")"))
        if (!read_value(name, read, problem)) return false;
    } else if (!read_value(name, read, problem)) {
      return false;
    }
    if (!read.numbers.empty() && !read.texts.empty())
      return fail(problem, line, fmt::format("{} has numbers and texts", in_quotes(name)));
    const auto found = values_.find(name);
    if (found == values_.end()) {
      values_.emplace(std::string(name), std::move(read));
      return true;
    }
    if (!adds) {
      found->second = std::move(read);
      return true;
    }
    Values& before = found->second;
    if ((!before.numbers.empty() && !read.texts.empty()) ||
        (!before.texts.empty() && !read.numbers.empty()))
      return fail(problem, line, fmt::format("{} has numbers and texts", in_quotes(name)));
    before.numbers.insert(before.numbers.end(), read.numbers.begin(), read.numbers.end());
    before.texts.insert(before.texts.end(), read.texts.begin(), read.texts.end());
    return true;
  }

  bool read_value(std::string_view name, Values& out, std::string& problem) {
    skip_blanks();
    const std::size_t line = line_;
    if (mark("'")) {
      std::string text;
      for (;; ++at_) {
        if (at_ >= text_.size() || text_[at_] == '\n')
          return fail(problem, line, fmt::format("a text of {} has no end", in_quotes(name)));
        if (text_[at_] == '\'') {
          if (!text_.substr(at_ + 1).starts_with('\'')) break;
          ++at_;
        }
        text.push_back(text_[at_]);
      }
      ++at_;
      out.texts.push_back(std::move(text));
      return true;
    }
    const std::string_view token = word();
    const auto number =
        token.starts_with('@') ? calendar_seconds(token.substr(1)) : kernel_number(token);
    if (!number)
      return fail(problem, line,
                  fmt::format("{} of {} is no number, date or quoted text",
                              token.empty() ? "the end" : in_quotes(token), in_quotes(name)));
    out.numbers.push_back(*number);
    return true;
  }

  std::string_view text_;
  std::map<std::string, Values, std::less<>>& values_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

}  // namespace

std::optional<double> calendar_seconds(std::string_view text) {
  // fields between - : T / and blanks
  std::array<std::string_view, 6> field{};
  std::size_t count = 0;
  for (std::size_t at = 0; at < text.size();) {
    const bool after_digit = at > 0 && std::isdigit(static_cast<unsigned char>(text[at - 1]));
    const char c = text[at];
    if (c == '-' || c == ':' || c == '/' || c == ' ' || (c == 'T' && after_digit)) {
      ++at;
      continue;
    }
    if (count == field.size()) return std::nullopt;
    std::size_t end = at;
    while (
        end < text.size() && text[end] != '-' && text[end] != ':' && text[end] != '/' &&
        text[end] != ' ' &&
        !(text[end] == 'T' && end > at && std::isdigit(static_cast<unsigned char>(text[end - 1]))))
      ++end;
    field[count++] = text.substr(at, end - at);
    at = end;
  }
  if (count > 0 && field[count - 1].ends_with('Z')) field[count - 1].remove_suffix(1);
  if (count < 2) return std::nullopt;
  // 03-AUG-2004: the day first
  const bool day_first = count > 2 && field[0].size() <= 2 && field[2].size() == 4;
  if (day_first) std::swap(field[0], field[2]);
  const auto year = parse_double(field[0]);
  if (!year || !(*year >= -9999 && *year <= 9999) || *year != std::floor(*year))
    return std::nullopt;
  const auto y = static_cast<std::int64_t>(*year);
  std::int64_t days = 0;
  std::size_t next = 3;
  const bool of_year =
      field[1].size() == 3 && std::isdigit(static_cast<unsigned char>(field[1][0]));
  if (of_year) {
    const auto day = parse_double(field[1]);
    if (!day || !(*day >= 1 && *day <= 366) || *day != std::floor(*day)) return std::nullopt;
    days = days_of(y, 1, 1) + static_cast<std::int64_t>(*day) - 1;
    next = 2;
  } else {
    const int month = month_of(field[1]);
    const auto day = count > 2 ? parse_double(field[2]) : std::optional<double>();
    if (month == 0 || !day || !(*day >= 1 && *day <= 31) || *day != std::floor(*day))
      return std::nullopt;
    days = days_of(y, month, static_cast<std::int64_t>(*day));
  }
  constexpr std::array<double, 3> kSeconds = {3600, 60, 1};
  constexpr std::array<double, 3> kMost = {23, 59, 61};
  double seconds = 0;
  for (std::size_t i = 0; next + i < count; ++i) {
    if (i == kSeconds.size()) return std::nullopt;
    const auto value = parse_double(field[next + i]);
    if (!value || !(*value >= 0 && *value <= kMost[i])) return std::nullopt;
    seconds += *value * kSeconds[i];
  }
  constexpr double kDay = 86400;
  return (static_cast<double>(days) - 0.5) * kDay + seconds;
}

bool is_text_kernel(std::string_view text) {
  return text.starts_with("KPL/") || text.find("\\begindata") != text.npos;
}

bool Pool::read(std::string_view text, std::string& problem) {
  return PoolReader(text, values_).read(problem);
}

const std::vector<double>* Pool::numbers(const std::string& name) const {
  const auto found = values_.find(name);
  return found == values_.end() || found->second.numbers.empty() ? nullptr : &found->second.numbers;
}

const std::vector<std::string>* Pool::texts(const std::string& name) const {
  const auto found = values_.find(name);
  return found == values_.end() || found->second.texts.empty() ? nullptr : &found->second.texts;
}

std::optional<double> Pool::number(const std::string& name) const {
  const auto* all = numbers(name);
  return all == nullptr ? std::optional<double>() : all->front();
}

std::optional<std::string> Pool::text(const std::string& name) const {
  const auto* all = texts(name);
  return all == nullptr ? std::optional<std::string>() : all->front();
}

}  // namespace panwright::ephemeris
