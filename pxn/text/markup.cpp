#include "pxn/text/markup.h"

#include <fmt/core.h>

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "base/text.h"
#include "schemas/generated/pxn_schema.h"

namespace panwright::pxn::xml {

namespace {

bool is_markup_blank(char c) { return is(c, CharClass::blank); }

// Past the end of a tag at `at`: a '>' in a value does not end it.
std::size_t tag_end(std::string_view text, std::size_t at) {
  while (at < text.size()) {
    const char c = text[at];
    if (c == '>') return at + 1;
    if (c == '"' || c == '\'') at = std::min(text.find(c, at + 1), text.size());
    ++at;
  }
  return text.size();
}

TagValues values_of(const schemas::Element& element) {
  TagValues out;
  const auto is_number = [](schemas::ValueKind kind) {
    return kind == schemas::ValueKind::real || kind == schemas::ValueKind::integer ||
           kind == schemas::ValueKind::quantity;
  };
  out.numbers = is_number(element.text.kind);
  if (out.numbers && element.text.count == 0) out.tuple = std::max(1u, element.text.tuple);
  for (const schemas::Attribute& attribute : element.attributes)
    if (is_number(attribute.value.kind)) out.number_attributes.push_back(attribute.name);
  return out;
}

using TagKey = std::pair<std::string_view, std::string_view>;  // parent, tag

struct TagHash {
  std::size_t operator()(const TagKey& key) const {
    std::size_t hash = key.first.size();
    for (const std::string_view part : {key.first.substr(0, 4), key.second})
      for (const char c : part) hash = hash * 31 + static_cast<unsigned char>(c);
    return hash;
  }
};
using TagMap = std::unordered_map<TagKey, TagValues, TagHash>;

// By parent and tag, and by tag alone under an empty parent. Later elements, of higher levels, win.
TagMap all_values() {
  TagMap known;
  for (const schemas::Element& element : schemas::kPxn.elements) {
    known[{"", element.name}] = values_of(element);
    for (const schemas::Slot& slot : element.slots)
      for (const schemas::ElementId id : slot.elements) {
        const schemas::Element& child = schemas::kPxn.elements[static_cast<std::size_t>(id)];
        known[{element.name, child.name}] = values_of(child);
      }
  }
  return known;
}

// Appends a text with its runs of blanks made one, and those at ends left out.
class Squeezed {
 public:
  explicit Squeezed(bool braces) : braces_(braces) {}

  void add(std::string_view text) {
    for (std::size_t i = 0; i < text.size();) {
      if (is_markup_blank(text[i])) {
        blank_ = true;
        ++i;
        continue;
      }
      std::size_t end = i + 1;
      while (end < text.size() && !is_markup_blank(text[end])) ++end;
      const bool at_end = out_.empty() || (braces_ && (out_.back() == '{' || text[i] == '}'));
      if (blank_ && !at_end) out_.push_back(' ');
      blank_ = false;
      out_.append(text, i, end - i);
      i = end;
    }
  }
  const std::string& text() const { return out_; }
  void clear(bool braces) {
    out_.clear();
    blank_ = false;
    braces_ = braces;
  }

 private:
  std::string out_;
  bool braces_;
  bool blank_ = false;
};

// A comment without the indentation of its lines.
std::string unindented(std::string_view comment) {
  std::string out;
  bool line_begins = false;
  for (const char c : comment) {
    if (line_begins && (c == ' ' || c == '\t')) continue;
    line_begins = c == '\n';
    out.push_back(c);
  }
  return out;
}

// One side of a comparison: what stands between two tags, in a form in which equal means the same.
class Side {
 public:
  explicit Side(std::string_view text) : text_(text), markup_(text) {}

  // Reads up to the next tag.
  void advance() {
    const bool numbers =
        !open_.empty() &&
        values_of_tag(open_.size() > 1 ? open_[open_.size() - 2] : "", open_.back()).numbers;
    words.clear(numbers);
    others.clear();
    for (tag = markup_.next();; tag = markup_.next()) {
      if (tag.kind == PieceKind::text) {
        words.add(tag.bytes);
      } else if (tag.kind == PieceKind::cdata) {
        others += fmt::format("{}:", words.text().size());
        others += tag.bytes;
        words.add(tag.bytes.substr(9, tag.bytes.size() - 12));
      } else if (tag.kind == PieceKind::comment || tag.kind == PieceKind::instruction) {
        others += fmt::format("{}:", words.text().size());
        others += unindented(tag.bytes);
      } else {
        break;
      }
    }
    if (tag.kind == PieceKind::start_tag) open_.push_back(tag_name(tag.bytes));
    if (tag.kind == PieceKind::end_tag) open_.pop_back();
  }
  // The content of the element that was opened last, up to its end tag.
  std::string_view skip_content() {
    const std::size_t begin = markup_.at();
    const std::size_t end = end_tag_of(text_, begin);
    markup_ = Markup(text_, end);
    return text_.substr(begin, end - begin);
  }
  std::string_view parent() const {
    const std::size_t outer = tag.kind == PieceKind::start_tag ? 2 : 1;
    return open_.size() < outer ? std::string_view() : open_[open_.size() - outer];
  }

  Piece tag;
  Squeezed words{false};
  std::string others;  // comments, instructions and CDATA, each behind how much text

 private:
  std::string_view text_;
  Markup markup_;
  std::vector<std::string_view> open_;
};

// A value as XML and the language read it.
std::string meaning(std::string_view value, bool numbers) {
  if (numbers) {
    Squeezed squeezed(true);
    squeezed.add(value);
    return squeezed.text();
  }
  std::string out(value);
  for (char& c : out)
    if (is_markup_blank(c)) c = ' ';
  return out;
}

std::string attribute_difference(const Side& a, const Side& b,
                                 std::vector<TagAttribute>& attributes) {
  std::vector<TagAttribute> others;
  read_attributes(a.tag.bytes, attributes);
  if (a.tag.bytes == b.tag.bytes) return {};
  read_attributes(b.tag.bytes, others);
  const std::string_view tag = tag_name(a.tag.bytes);
  if (attributes.size() != others.size()) return fmt::format("the attributes of <{}>", tag);
  const TagValues& values = values_of_tag(a.parent(), tag);
  const auto by_name = [](const TagAttribute& x, const TagAttribute& y) { return x.name < y.name; };
  std::vector<TagAttribute> sorted = attributes;
  std::sort(sorted.begin(), sorted.end(), by_name);
  std::sort(others.begin(), others.end(), by_name);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const bool numbers = values.has_numbers(sorted[i].name);
    if (sorted[i].name != others[i].name ||
        meaning(sorted[i].value, numbers) != meaning(others[i].value, numbers))
      return fmt::format("the attribute {} of <{}>", sorted[i].name, tag);
  }
  return {};
}

}  // namespace

Piece Markup::next() {
  const std::size_t begin = at_;
  PieceKind kind = kind_at(text_, begin);
  switch (kind) {
    case PieceKind::end:
      return {};
    case PieceKind::text:
      at_ = std::min(text_.find('<', begin), text_.size());
      break;
    case PieceKind::comment:
    case PieceKind::cdata:
    case PieceKind::instruction:
      at_ = std::min(close_of(text_, begin, kind) + marks_of(kind).close.size(), text_.size());
      break;
    default:
      at_ = tag_end(text_, begin);
      if (kind == PieceKind::start_tag && text_[at_ - 2] == '/') kind = PieceKind::empty_tag;
      break;
  }
  return {kind, text_.substr(begin, at_ - begin)};
}

std::string_view tag_name(std::string_view tag) {
  const std::size_t begin = tag[1] == '/' ? 2 : 1;
  return tag.substr(begin, name_end(tag, begin) - begin);
}

void read_attributes(std::string_view tag, std::vector<TagAttribute>& out) {
  out.clear();
  std::size_t at = 1 + tag_name(tag).size();
  while (true) {
    const std::size_t name = blanks_end(tag, at);
    const std::size_t end = name_end(tag, name);
    if (end == name) return;
    const std::size_t open = tag.find_first_of("\"'", end);
    const std::size_t close = tag.find(tag[open], open + 1);
    out.push_back({tag.substr(name, end - name), tag.substr(open + 1, close - open - 1)});
    at = close + 1;
  }
}

bool preserves_blanks(const std::vector<TagAttribute>& attributes) {
  return std::any_of(attributes.begin(), attributes.end(), [](const TagAttribute& a) {
    return a.name == "xml:space" && a.value == "preserve";
  });
}

std::size_t end_tag_of(std::string_view text, std::size_t content) {
  Markup markup(text, content);
  std::size_t depth = 1;
  while (true) {
    const std::size_t begin = markup.at();
    const Piece piece = markup.next();
    if (piece.kind == PieceKind::start_tag) ++depth;
    if (piece.kind == PieceKind::end_tag && --depth == 0) return begin;
    if (piece.kind == PieceKind::end) return begin;
  }
}

std::string with_line_feeds(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\r', at), text.size());
    out += text.substr(at, end - at);
    at = end + 1;
    if (end == text.size()) break;
    out.push_back('\n');
    if (at < text.size() && text[at] == '\n') ++at;
  }
  return out;
}

bool TagValues::has_numbers(std::string_view attribute) const {
  return std::find(number_attributes.begin(), number_attributes.end(), attribute) !=
         number_attributes.end();
}

const TagValues& values_of_tag(std::string_view parent, std::string_view tag) {
  static const TagMap known = all_values();
  static const TagValues none;
  auto found = known.find({parent, tag});
  if (found == known.end()) found = known.find({"", tag});
  return found == known.end() ? none : found->second;
}

std::string difference_of(std::string_view a, std::string_view b) {
  Side left(a), right(b);
  std::vector<TagAttribute> attributes;
  while (true) {
    left.advance();
    right.advance();
    if (left.words.text() != right.words.text())
      return fmt::format("the text {}", in_quotes(left.words.text()));
    if (left.others != right.others)
      return fmt::format("a comment or instruction at {}", in_quotes(left.others));
    PieceKind kind = left.tag.kind;
    // <a></a> and <a/> are the same
    if (kind != right.tag.kind) {
      Side& open = kind == PieceKind::start_tag ? left : right;
      const Side& empty = kind == PieceKind::start_tag ? right : left;
      if (open.tag.kind != PieceKind::start_tag || empty.tag.kind != PieceKind::empty_tag ||
          tag_name(open.tag.bytes) != tag_name(empty.tag.bytes))
        return fmt::format("{} against {}", in_quotes(left.tag.bytes), in_quotes(right.tag.bytes));
      const std::string difference = attribute_difference(left, right, attributes);
      if (!difference.empty()) return difference;
      open.advance();
      if (open.tag.kind != PieceKind::end_tag || !open.words.text().empty() || !open.others.empty())
        return fmt::format("the content of <{}>", tag_name(empty.tag.bytes));
      continue;
    }
    if (kind == PieceKind::end) return {};
    if (tag_name(left.tag.bytes) != tag_name(right.tag.bytes))
      return fmt::format("{} against {}", in_quotes(left.tag.bytes), in_quotes(right.tag.bytes));
    if (kind == PieceKind::end_tag) continue;
    const std::string difference = attribute_difference(left, right, attributes);
    if (!difference.empty()) return difference;
    if (kind == PieceKind::start_tag && preserves_blanks(attributes) &&
        left.skip_content() != right.skip_content())
      return fmt::format("the content of <{}>, whose blanks stay", tag_name(left.tag.bytes));
  }
}

}  // namespace panwright::pxn::xml
