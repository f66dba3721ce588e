#include "pxn/format.h"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "pxn/text/content_tokens.h"
#include "pxn/text/markup.h"
#include "pxn/text/xml.h"

namespace panwright::pxn {

namespace {

using xml::ContentToken;
using xml::kBlanks;
using xml::Markup;
using xml::Piece;
using xml::PieceKind;

constexpr std::size_t kColumns = 100;        // of a line
constexpr std::size_t kIndent = 2;           // of what is inside an element
constexpr std::size_t kAttributeIndent = 4;  // of attributes on lines of their own
constexpr std::string_view kFirstAttributes[] = {"ver", "name", "part", "file"};

std::size_t count_lines(std::string_view text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

class Formatter {
 public:
  Formatter(std::string_view text, bool wide_characters)
      : text_(text), markup_(text), wide_(wide_characters) {
    out_.reserve(text.size() + text.size() / 8);
  }

  std::string run() {
    for (Piece piece = markup_.next(); piece.kind != PieceKind::end; piece = markup_.next())
      take(piece);
    if (out_.empty() || out_.back() != '\n') out_.push_back('\n');
    return std::move(out_);
  }

 private:
  // What the last thing written was, for what comes next.
  enum class Last { nothing, start_tag, declaration, other_markup, text };

  void take(const Piece& piece) {
    switch (piece.kind) {
      case PieceKind::text:
        take_text(piece.bytes);
        break;
      case PieceKind::cdata:
        place(piece.kind);
        put(piece.bytes);
        wrote(Last::text);
        break;
      case PieceKind::comment:
        take_comment(piece.bytes);
        break;
      case PieceKind::instruction:
        place(piece.kind);
        put(piece.bytes);
        if (out_.size() == piece.bytes.size())
          wrote(Last::declaration);
        else
          wrote_aside();
        break;
      case PieceKind::start_tag:
        take_element(piece.bytes);
        break;
      case PieceKind::empty_tag:
        place(piece.kind);
        put_tag(piece.bytes, parent(), "/>");
        wrote(Last::other_markup);
        break;
      case PieceKind::end_tag:
        open_.pop_back();
        place(piece.kind);
        put_end_tag(xml::tag_name(piece.bytes));
        break;
      case PieceKind::doctype:
      case PieceKind::broken:  // not in a sound text
      case PieceKind::end:
        break;
    }
  }

  // ---- places

  std::string_view parent() const { return open_.empty() ? std::string_view() : open_.back(); }

  std::size_t width(std::string_view text) const {
    if (!wide_) return text.size();
    // bytes of UTF-8 that go on with a character
    return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
      return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
    }));
  }
  void put(std::string_view text) {
    out_ += text;
    const std::size_t line = text.rfind('\n');
    if (line == std::string_view::npos)
      column_ += width(text);
    else
      column_ = width(text.substr(line + 1));
  }
  void new_line(std::size_t indent) {
    if (!out_.empty()) out_.push_back('\n');
    out_.append(indent, ' ');
    column_ = indent;
  }
  std::size_t indent() const { return kIndent * open_.size(); }

  // Goes to where the next thing stands. kind: of it; text and what touches it stay as they are.
  void place(PieceKind kind) {
    const bool text = kind == PieceKind::text || kind == PieceKind::cdata;
    if (last_ == Last::nothing) return;
    if ((text || last_ == Last::text) && !blank_) return;
    const bool aside = kind == PieceKind::comment || kind == PieceKind::instruction;
    if (aside && last_ == Last::other_markup && !blank_ && touches_text()) return;
    const bool follows = kind == PieceKind::comment && lines_ == 0 && last_ != Last::declaration;
    if (follows) {
      put(" ");
      return;
    }
    if (lines_ > 1 && last_ != Last::start_tag && kind != PieceKind::end_tag) out_.push_back('\n');
    new_line(indent());
  }
  // Whether text follows, with no blank before it, what has been read and comments behind that.
  bool touches_text() {
    if (markup_.at() <= asides_end_) return asides_touch_text_;  // one look for a row of comments
    Markup ahead = markup_;
    while (true) {
      asides_end_ = ahead.at();
      const Piece piece = ahead.next();
      if (piece.kind == PieceKind::comment || piece.kind == PieceKind::instruction) continue;
      asides_touch_text_ =
          piece.kind == PieceKind::cdata ||
          (piece.kind == PieceKind::text && kBlanks.find(piece.bytes[0]) == kBlanks.npos);
      return asides_touch_text_;
    }
  }
  void wrote(Last last) {
    last_ = last;
    blank_ = false;
    lines_ = 0;
  }
  // A comment or an instruction: what touches text goes on with it.
  void wrote_aside() { wrote(last_ == Last::text && !blank_ ? Last::text : Last::other_markup); }

  // ---- text beside elements, comments

  void take_text(std::string_view text) {
    const std::size_t first = text.find_first_not_of(kBlanks);
    if (first == std::string_view::npos) {
      blank_ = true;
      lines_ = count_lines(text);
      return;
    }
    blank_ = first > 0;
    lines_ = count_lines(text.substr(0, first));
    place(PieceKind::text);
    xml::Words words(text, false);
    std::string_view word;
    for (bool begins = true; words.next(word); begins = false) {
      if (!begins && column_ + 1 + width(word) > kColumns)
        new_line(indent());
      else if (!begins)
        put(" ");
      put(word);
    }
    wrote(Last::text);
    const std::size_t last = text.find_last_not_of(kBlanks);
    blank_ = last + 1 < text.size();
    lines_ = count_lines(text.substr(last + 1));
  }

  void take_comment(std::string_view comment) {
    place(PieceKind::comment);
    put_comment(comment);
    wrote_aside();
  }

  // The lines of a comment move with its first one, if that was indented by blanks alone.
  void put_comment(std::string_view comment) {
    if (comment.find('\n') == std::string_view::npos) return put(comment);
    std::size_t begin = static_cast<std::size_t>(comment.data() - text_.data());
    const std::size_t at = begin;
    while (begin > 0 && text_[begin - 1] == ' ') --begin;
    if (begin > 0 && text_[begin - 1] != '\n') return put(comment);
    const std::size_t before = at - begin, now = column_;
    while (true) {
      const std::size_t end = std::min(comment.find('\n'), comment.size() - 1) + 1;
      put(comment.substr(0, end));
      comment.remove_prefix(end);
      if (comment.empty()) return;
      const std::size_t blanks = comment.find_first_not_of(' ');
      if (comment[blanks] == '\n' || comment[blanks] == '\t') continue;
      comment.remove_prefix(blanks);
      const std::size_t moved = blanks + now < before ? 0 : blanks + now - before;
      out_.append(moved, ' ');
      column_ = moved;
    }
  }

  // ---- elements

  void put_end_tag(std::string_view name) {
    put("</");
    put(name);
    put(">");
    wrote(Last::other_markup);
  }

  static std::size_t rank(std::string_view attribute) {
    return static_cast<std::size_t>(
        std::find(std::begin(kFirstAttributes), std::end(kFirstAttributes), attribute) -
        std::begin(kFirstAttributes));
  }

  // Writes a value in its quotes. Line ends and tabs in it are blanks to XML.
  void append_value(std::string_view value, bool numbers) {
    const char quote = value.find('"') == std::string_view::npos ? '"' : '\'';
    tag_.push_back(quote);
    const std::size_t begin = tag_.size();
    if (numbers) {
      xml::Words words(value, true);
      for (std::string_view word; words.next(word);) {
        if (tag_.size() > begin) tag_.push_back(' ');
        tag_ += word;
      }
    } else {
      tag_ += value;
      std::replace_if(
          tag_.begin() + static_cast<std::ptrdiff_t>(begin), tag_.end(),
          [](char c) { return c == '\n' || c == '\t'; }, ' ');
    }
    tag_.push_back(quote);
  }

  // Lays a tag out in tag_, with its end, ">" or "/>".
  void lay_out_tag(std::string_view tag, std::string_view around, std::string_view end) {
    const std::string_view name = xml::tag_name(tag);
    xml::read_attributes(tag, attributes_);
    if (attributes_.size() > 1)
      std::stable_sort(attributes_.begin(), attributes_.end(),
                       [](const auto& a, const auto& b) { return rank(a.name) < rank(b.name); });
    const xml::TagValues* values =
        attributes_.empty() ? nullptr : &xml::values_of_tag(around, name);
    for (const bool broken : {false, true}) {
      tag_.assign(1, '<');
      tag_ += name;
      for (const xml::TagAttribute& attribute : attributes_) {
        if (broken) tag_.push_back('\n');
        tag_.append(broken ? indent() + kAttributeIndent : 1, ' ');
        tag_ += attribute.name;
        tag_.push_back('=');
        append_value(attribute.value, values->has_numbers(attribute.name));
      }
      tag_ += end;
      if (attributes_.size() < 2 || column_ + width(tag_) <= kColumns) return;
    }
  }
  void put_tag(std::string_view tag, std::string_view around, std::string_view end) {
    lay_out_tag(tag, around, end);
    put(tag_);
  }

  // An element: as a whole when no other stands in it, else up to its first child.
  void take_element(std::string_view tag) {
    place(PieceKind::start_tag);
    const std::string_view name = xml::tag_name(tag);
    const std::string_view around = parent();
    const std::size_t content = markup_.at();
    xml::read_attributes(tag, attributes_);
    if (xml::preserves_blanks(attributes_)) {
      put_tag(tag, around, ">");
      const std::size_t end = xml::end_tag_of(text_, content);
      put(text_.substr(content, end - content));
      markup_ = Markup(text_, end);
      markup_.next();
      put_end_tag(name);
      return;
    }
    const Leaf leaf = leaf_at(content);
    if (!leaf.ends || (leaf.asides && !leaf.text)) {
      if (leaf.ends && leaf.lines == 0 && put_on_line(tag, around, name, leaf.content)) {
        markup_ = Markup(text_, leaf.end);
        return;
      }
      put_tag(tag, around, ">");
      open_.push_back(name);
      wrote(Last::start_tag);
      return;
    }
    markup_ = Markup(text_, leaf.end);
    if (!leaf.text) {
      put_tag(tag, around, "/>");
      wrote(Last::other_markup);
    } else if (!put_on_line(tag, around, name, leaf.content)) {
      put_leaf(tag, around, name, leaf.content);
    }
  }

  struct Leaf {
    bool ends = false;      // no other element stands inside
    bool text = false;      // it holds more than blanks, comments and instructions
    bool asides = false;    // it holds comments or instructions
    std::size_t lines = 0;  // line ends in blanks
    std::size_t end = 0;    // past the end tag
    std::string_view content;
  };

  Leaf leaf_at(std::size_t begin) const {
    Leaf leaf;
    Markup markup(text_, begin);
    while (true) {
      const std::size_t at = markup.at();
      const Piece piece = markup.next();
      switch (piece.kind) {
        case PieceKind::text:
          if (!leaf.text && piece.bytes.find_first_not_of(kBlanks) != std::string_view::npos)
            leaf.text = true;
          if (!leaf.text) leaf.lines += count_lines(piece.bytes);
          break;
        case PieceKind::cdata:
          leaf.text = true;
          break;
        case PieceKind::comment:
        case PieceKind::instruction:
          leaf.asides = true;
          break;
        case PieceKind::end_tag:
          leaf.ends = true;
          leaf.end = markup.at();
          leaf.content = text_.substr(begin, at - begin);
          return leaf;
        default:
          return leaf;
      }
    }
  }

  // Writes an element without others on one line. False, with nothing written, where it does not
  // fit or a comment stood on a line of its own or ended one.
  bool put_on_line(std::string_view tag, std::string_view around, std::string_view name,
                   std::string_view content) {
    const xml::TagValues& values = xml::values_of_tag(around, name);
    lay_out_tag(tag, around, ">");
    std::size_t columns = column_ + width(tag_) + name.size() + 3;
    if (columns + 1 > kColumns || tag_.find('\n') != std::string::npos) return false;
    xml::ContentTokens content_tokens(content, values.numbers);
    std::size_t words = 0;
    bool aside = false;
    for (ContentToken token = content_tokens.next(); !token.bytes.empty();
         token = content_tokens.next()) {
      if ((aside || token.aside) && token.lines_before > 0) return false;
      if (token.bytes.find('\n') != std::string_view::npos) return false;
      const bool begins_tuple = words > 0 && !aside && !token.aside && words % values.tuple == 0;
      tag_ += begins_tuple && values.tuple > 1 ? "  " : " ";
      tag_ += token.bytes;
      if (column_ + width(tag_) + name.size() + 4 > kColumns) return false;
      aside = token.aside;
      words += token.aside ? 0 : 1;
    }
    if (aside && content_tokens.lines_behind() > 0) return false;
    put(tag_);
    put(" ");
    put_end_tag(name);
    return true;
  }

  // ---- long texts

  // Writes an element without others on lines of its own. They end between tuples where those fit.
  void put_leaf(std::string_view tag, std::string_view around, std::string_view name,
                std::string_view content) {
    const xml::TagValues& values = xml::values_of_tag(around, name);
    put_tag(tag, around, ">");
    open_.push_back(name);
    xml::ContentTokens content_tokens(content, values.numbers);
    std::size_t words = 0;
    gap_ = Gap::line;
    bool first = true;
    for (ContentToken token = content_tokens.next(); !token.bytes.empty();
         token = content_tokens.next(), first = false) {
      if (token.aside) {
        put_group();
        if (token.lines_before > 0)
          new_line(indent());
        else
          put(" ");
        put_comment(token.bytes);
        gap_ = first ? Gap::line : Gap::blank;
        continue;
      }
      if (words % values.tuple == 0) {
        put_group();
        if (values.tuple > 1 && gap_ == Gap::none) gap_ = Gap::two_blanks;
      }
      if (group_.empty()) {
        if (gap_ == Gap::none) gap_ = Gap::blank;
        if (gap_ == Gap::blank && token.lines_before > 0) gap_ = Gap::line;
      } else {
        breaks_.push_back(group_.size());
        group_.push_back(' ');
      }
      group_ += token.bytes;
      ++words;
    }
    put_group();
    open_.pop_back();
    new_line(indent());
    put_end_tag(name);
  }

  // Writes the words of a tuple, word by word where they are longer than a line.
  void put_group() {
    if (group_.empty()) return;
    const std::size_t blanks = gap_ == Gap::two_blanks ? 2 : 1;
    if (gap_ == Gap::line || column_ + blanks + width(group_) > kColumns)
      new_line(indent());
    else
      put(blanks == 2 ? "  " : " ");
    if (column_ + width(group_) <= kColumns || breaks_.empty()) {
      put(group_);
    } else {
      std::size_t begin = 0;
      breaks_.push_back(group_.size());
      for (const std::size_t end : breaks_) {
        const std::string_view word = std::string_view(group_).substr(begin, end - begin);
        if (begin > 0 && column_ + 1 + width(word) > kColumns)
          new_line(indent());
        else if (begin > 0)
          put(" ");
        put(word);
        begin = end + 1;
      }
    }
    group_.clear();
    breaks_.clear();
    gap_ = Gap::none;
  }

  std::string_view text_;
  Markup markup_;
  bool wide_;
  std::string out_;
  std::size_t column_ = 0;
  std::vector<std::string_view> open_;  // names of elements around
  Last last_ = Last::nothing;
  bool blank_ = false;     // since the last thing
  std::size_t lines_ = 0;  // line ends since then
  std::string tag_;
  std::vector<xml::TagAttribute> attributes_;
  std::size_t asides_end_ = 0;  // of the row of comments and instructions last looked at
  bool asides_touch_text_ = false;
  // of a long text: words that are not written yet, and what stands before them
  enum class Gap { none, blank, two_blanks, line };
  Gap gap_ = Gap::none;
  std::string group_;
  std::vector<std::size_t> breaks_;  // blanks in it
};

// The mark at the beginning of UTF-8 files, if there is one.
std::string_view byte_order_mark(std::string_view bytes) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  return bytes.starts_with(kMark) ? kMark : std::string_view();
}

}  // namespace

Result<std::string> formatted(const std::string& name, std::shared_ptr<const std::string> bytes,
                              const Limits& limits, DiagnosticLog& log) {
  if (bytes->size() >= 0xffffffffu) {
    log.report_file(Code("E0104"), name, "the file has 4 GiB or more");
    return failed;
  }
  const std::size_t errors = log.errors();
  const FileId file = log.sources().add({name, bytes, Encoding::utf8, {}});
  const Encoding encoding = xml::scan(file, {limits.elements, limits.depth}, log).encoding;
  if (log.errors() > errors) return failed;
  const std::string_view mark = byte_order_mark(*bytes);
  std::string_view text = std::string_view(*bytes).substr(mark.size());
  std::string with_line_feeds;
  if (text.find('\r') != std::string_view::npos) {
    with_line_feeds = xml::with_line_feeds(text);
    text = with_line_feeds;
  }
  const bool wide = encoding == Encoding::utf8 &&
                    std::any_of(text.begin(), text.end(), [](char c) { return (c & 0x80) != 0; });
  std::string out = Formatter(text, wide).run();
  out.insert(0, mark);
  const std::string difference =
      xml::difference_of(text, std::string_view(out).substr(mark.size()));
  if (!difference.empty())
    throw std::logic_error(
        fmt::format("{}: the formatted text would not mean the same: {}", name, difference));
  return out;
}

}  // namespace panwright::pxn
