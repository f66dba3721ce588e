#include "terrain/internal/label.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <deque>

#include "base/text.h"

namespace panwright::terrain {

namespace {

constexpr std::size_t kMostDepth = 32;
constexpr std::size_t kMostItems = 100'000;

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
bool is_word(char c) {
  return !is_space(c) && c != '=' && c != '(' && c != ')' && c != '{' && c != '}' && c != ',' &&
         c != '"' && c != '\'' && c != '<' && c != '>' && c != '\0';
}

class LabelReader {
 public:
  explicit LabelReader(std::string_view text) : text_(text.substr(0, kMostLabel)) {}

  Label read() {
    Label out;
    std::vector<LabelItem*> open{&out.root};
    for (std::size_t count = 0; count < kMostItems; ++count) {
      skip();
      const std::string name = word();
      if (name.empty()) break;
      const std::string key = upper_case(name);
      if (key == "END") {
        out.ended = true;
        break;
      }
      skip();
      const bool has_value = take('=');
      if (is_end(key)) {
        if (has_value) values();
        if (open.size() > 1) open.pop_back();
        continue;
      }
      if (!has_value) break;
      LabelItem item;
      item.pointer = key[0] == '^';
      item.name = item.pointer ? key.substr(1) : key;
      item.values = values();
      item.block = is_block(key);
      if (item.block && !item.values.empty()) item.name = upper_case(item.values[0].text);
      open.back()->items.push_back(std::move(item));
      if (open.back()->items.back().block) {
        if (open.size() >= kMostDepth) break;
        open.push_back(&open.back()->items.back());
      }
    }
    // the line of END belongs to the label
    out.end = at_;
    while (out.end < text_.size() && (text_[out.end] == ' ' || text_[out.end] == '\r')) ++out.end;
    if (out.end < text_.size() && text_[out.end] == '\n') ++out.end;
    return out;
  }

 private:
  static bool is_block(const std::string& key) {
    return key == "OBJECT" || key == "GROUP" || key == "BEGIN_OBJECT" || key == "BEGIN_GROUP";
  }
  static bool is_end(const std::string& key) {
    return key == "END_OBJECT" || key == "END_GROUP" || key == "ENDOBJECT" || key == "ENDGROUP";
  }

  void skip() {
    while (at_ < text_.size()) {
      if (is_space(text_[at_])) {
        ++at_;
      } else if (text_.substr(at_, 2) == "/*") {
        at_ = std::min(text_.find("*/", at_), text_.size() - 2) + 2;
      } else if (text_[at_] == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else {
        return;
      }
    }
  }
  bool take(char c) {
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  std::string word() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && is_word(text_[at_])) ++at_;
    return std::string(text_.substr(begin, at_ - begin));
  }

  std::vector<LabelValue> values() {
    std::vector<LabelValue> out;
    skip();
    if (at_ < text_.size() && (text_[at_] == '(' || text_[at_] == '{')) {
      int depth = 0;
      while (at_ < text_.size() && out.size() < kMostItems) {
        skip();
        if (take('(') || take('{')) {
          ++depth;
        } else if (take(')') || take('}')) {
          if (--depth == 0) break;
        } else if (!take(',')) {
          const std::size_t before = at_;
          out.push_back(value());
          if (at_ == before) break;
        }
      }
      skip();
      if (at_ < text_.size() && text_[at_] == '<') {
        const std::string unit = unit_here();
        for (LabelValue& each : out)
          if (each.unit.empty()) each.unit = unit;
      }
      return out;
    }
    out.push_back(value());
    return out;
  }

  LabelValue value() {
    LabelValue out;
    if (at_ < text_.size() && (text_[at_] == '"' || text_[at_] == '\'')) {
      const char quote = text_[at_++];
      const std::size_t end = std::min(text_.find(quote, at_), text_.size());
      out.text = text_.substr(at_, end - at_);
      at_ = std::min(end + 1, text_.size());
    } else {
      out.text = word();
    }
    // a unit may stand after blanks
    std::size_t behind = at_;
    while (behind < text_.size() && is_space(text_[behind])) ++behind;
    if (behind < text_.size() && text_[behind] == '<') {
      at_ = behind;
      out.unit = unit_here();
    }
    return out;
  }
  std::string unit_here() {
    const std::size_t end = std::min(text_.find('>', at_), text_.size());
    std::string unit(text_.substr(at_ + 1, end - at_ - (end > at_ ? 1 : 0)));
    at_ = std::min(end + 1, text_.size());
    for (char& c : unit)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    std::erase_if(unit, is_space);
    return unit;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

template <class Test>
const LabelItem* first(const LabelItem& in, const Test& test) {
  std::deque<const LabelItem*> waiting{&in};
  while (!waiting.empty()) {
    const LabelItem* each = waiting.front();
    waiting.pop_front();
    for (const LabelItem& item : each->items)
      if (test(item)) return &item;
    for (const LabelItem& item : each->items)
      if (item.block) waiting.push_back(&item);
  }
  return nullptr;
}

const LabelValue* value_of(const LabelItem& in, std::string_view name) {
  const LabelItem* item = find(in, name);
  return item == nullptr || item->values.empty() ? nullptr : &item->values[0];
}

}  // namespace

Label read_label(std::string_view text) { return LabelReader(text).read(); }

const LabelItem* find(const LabelItem& in, std::string_view name) {
  return first(
      in, [&](const LabelItem& item) { return !item.block && !item.pointer && item.name == name; });
}
const LabelItem* find_pointer(const LabelItem& in, std::string_view name) {
  return first(in, [&](const LabelItem& item) { return item.pointer && item.name == name; });
}
const LabelItem* find_block(const LabelItem& in, std::string_view name) {
  return first(in, [&](const LabelItem& item) { return item.block && item.name == name; });
}

std::string text_of(const LabelItem& in, std::string_view name) {
  const LabelValue* value = value_of(in, name);
  if (value == nullptr) return {};
  const std::string upper = upper_case(value->text);
  if (upper == "N/A" || upper == "NULL" || upper == "UNK") return {};
  std::string out = value->text;
  while (!out.empty() && is_space(out.back())) out.pop_back();
  return out;
}

std::optional<double> number_of(const LabelItem& in, std::string_view name) {
  const LabelValue* value = value_of(in, name);
  if (value == nullptr) return std::nullopt;
  std::string_view text = value->text;
  if (text.starts_with('+')) text.remove_prefix(1);
  return parse_double(text);
}

std::optional<std::uint64_t> count_of(const LabelItem& in, std::string_view name) {
  const auto number = number_of(in, name);
  if (!number || *number < 0 || *number > 1e15 || *number != std::floor(*number))
    return std::nullopt;
  return static_cast<std::uint64_t>(*number);
}

std::optional<std::uint64_t> pattern_of(std::string_view text) {
  const std::size_t hash = text.find('#');
  if (hash == text.npos || !text.ends_with('#') || text.size() < hash + 3) return std::nullopt;
  int base = 0;
  const auto digits = text.substr(0, hash);
  if (std::from_chars(digits.data(), digits.data() + digits.size(), base).ec != std::errc() ||
      base < 2 || base > 16)
    return std::nullopt;
  const auto body = text.substr(hash + 1, text.size() - hash - 2);
  std::uint64_t out = 0;
  const auto [end, error] = std::from_chars(body.data(), body.data() + body.size(), out, base);
  if (error != std::errc() || end != body.data() + body.size()) return std::nullopt;
  return out;
}

std::optional<double> metres_of_unit(std::string_view unit) {
  const std::string word = upper_case(unit.substr(0, unit.find('/')));
  if (word == "KM" || word == "KILOMETER" || word == "KILOMETERS" || word == "KILOMETRE" ||
      word == "KILOMETRES")
    return 1000.0;
  if (word == "M" || word == "METER" || word == "METERS" || word == "METRE" || word == "METRES")
    return 1.0;
  return std::nullopt;
}

std::optional<double> metres_of(const LabelItem& in, std::string_view name, double bare) {
  const auto number = number_of(in, name);
  if (!number) return std::nullopt;
  const LabelValue& value = *value_of(in, name);
  if (value.unit.empty()) return *number * bare;
  const auto unit = metres_of_unit(value.unit);
  return *number * unit.value_or(bare);
}

std::string upper_case(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return out;
}

}  // namespace panwright::terrain
