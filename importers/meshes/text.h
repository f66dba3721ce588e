// Lines and words of text files. Private to importers/meshes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace panwright::importers::meshes {

inline bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

// Takes the next word off the front of a text; empty at the end.
inline std::string_view next_word(std::string_view& rest) {
  std::size_t begin = 0;
  while (begin < rest.size() && is_blank(rest[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !is_blank(rest[end])) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

inline std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

// Lines of a text that end at LF or CRLF, or at CR where there is no LF.
class Lines {
 public:
  explicit Lines(std::string_view text)
      : rest_(text), end_(text.find('\n') == text.npos ? '\r' : '\n') {
    if (rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);
  }

  Lines(std::string_view text, char end) : rest_(text), end_(end) {}

  // Returns the unread rest.
  std::string_view rest() const { return rest_; }

  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    const std::size_t size = std::min(rest_.find(end_), rest_.size());
    line = rest_.substr(0, size);
    rest_.remove_prefix(std::min(size + 1, rest_.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    return true;
  }

  // The same, joining lines that end in a backslash to the next by a blank. A joined line lies in
  // `scratch`, without places in the file.
  bool next_joined(std::string_view& line, std::string_view& first, std::string& scratch) {
    if (!next(line)) return false;
    first = line;
    if (!line.ends_with('\\')) return true;
    scratch.clear();
    bool goes_on = true;
    while (goes_on) {
      goes_on = line.ends_with('\\');
      scratch.append(line.substr(0, line.size() - (goes_on ? 1 : 0))).append(1, ' ');
      goes_on = goes_on && next(line);
    }
    line = scratch;
    return true;
  }

 private:
  std::string_view rest_;
  char end_;
};

}  // namespace panwright::importers::meshes
