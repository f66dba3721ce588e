#include "pxn/text/xml.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>

#include "base/text.h"
#include "pxn/text/encoding.h"
#include "pxn/text/reference.h"
#include "pxn/text/tokens.h"

namespace panwright::pxn::xml {

namespace {

// what comes after so many broken places is rarely XML at all
constexpr std::size_t kMostSyntaxErrors = 1000;
constexpr std::size_t kLongestName = 0xffff;
constexpr std::uint32_t kNobody = 0xffffffffu;

class Scanner {
 public:
  Scanner(Document& document, std::uint32_t begin, const Limits& limits, DiagnosticLog& log)
      : doc_(document),
        text_(document.bytes),
        size_(static_cast<std::uint32_t>(document.bytes.size())),
        at_(begin),
        limits_(limits),
        log_(log) {}

  void run() {
    reserve();
    while (at_ < size_ && !stopped_) {
      if (text_[at_] == '<')
        markup();
      else
        text();
    }
    finish();
  }

 private:
  // ---- helpers

  void report(Code code, std::uint32_t begin, std::uint32_t end, std::string message,
              std::string hint = {}) {
    log_.report(code, doc_.span(begin, std::min(end, size_)), std::move(message), std::move(hint));
    if (++errors_ < kMostSyntaxErrors || stopped_) return;
    stopped_ = true;
    log_.report(Code("E1001"), doc_.span(at_, at_),
                fmt::format("{} problems with the XML; the rest of the file is not read",
                            kMostSyntaxErrors));
  }
  std::string quoted(std::uint32_t begin, std::uint32_t end) const {
    // what is cut off would not be shown
    end = std::min(end, begin + 256);
    return in_quotes(to_utf8(text_.substr(begin, end - begin), doc_.encoding));
  }
  // note: SourceMap::position would count columns as well, which is slow on lines of megabytes
  std::uint32_t line_of(std::uint32_t offset) const {
    const std::string_view before = text_.substr(0, offset);
    const auto lines = std::count(before.begin(), before.end(), '\n');
    return 1 + static_cast<std::uint32_t>(
                   lines > 0 ? lines : std::count(before.begin(), before.end(), '\r'));
  }
  bool follows(std::string_view what) const { return text_.substr(at_).starts_with(what); }
  bool follows_end_of(std::string_view name) const {
    const std::string_view rest = text_.substr(at_ + 2);
    return rest.starts_with(name) &&
           (rest.size() == name.size() || !is(rest[name.size()], CharClass::name));
  }
  void skip_blanks() { at_ = static_cast<std::uint32_t>(blanks_end(text_, at_)); }
  // The place of a text from `from` on, or the end.
  std::uint32_t find(std::string_view what, std::uint32_t from) const {
    return static_cast<std::uint32_t>(std::min<std::size_t>(text_.find(what, from), size_));
  }
  std::uint32_t name_end(std::uint32_t i) const {
    return static_cast<std::uint32_t>(xml::name_end(text_, i));
  }
  // The place of the closing mark of what begins at the place at hand, or the end.
  std::uint32_t close_of(PieceKind kind) const {
    return static_cast<std::uint32_t>(xml::close_of(text_, at_, kind));
  }
  bool inside() const { return current_ != kNobody; }
  bool recording() const { return skipped_ == 0; }

  // Room for all elements at once: growing would hold them twice.
  void reserve() {
    std::uint64_t tags = 0;
    for (std::size_t i = text_.find('<'); i != std::string_view::npos; i = text_.find('<', i + 1))
      tags += i + 1 < text_.size() && text_[i + 1] != '/' ? 1 : 0;
    doc_.elements.reserve(std::min(tags, limits_.elements) + 1);
  }

  // ---- text

  void text() {
    const std::uint32_t begin = at_;
    skip_blanks();
    const bool blank = at_ >= size_ || text_[at_] == '<';
    if (!inside()) {
      if (blank) return;
      if (skipped_ > 0) {
        at_ = find("<", at_);
        return;
      }
      report(Code("E1001"), at_, at_ + 1,
             root_seen_ ? "text after the root element" : "text before the root element");
      at_ = find("<", at_);
      return;
    }
    while (at_ < size_) {
      const char c = text_[at_];
      if (!is(c, CharClass::stops_text)) {
        ++at_;
      } else if (c == '<') {
        break;
      } else if (c == '&') {
        reference();
      } else {
        if (follows("]]>")) report(Code("E1001"), at_, at_ + 3, "']]>' in text; write ']]&gt;'");
        ++at_;
      }
    }
    // blanks count only where they separate other text of the element
    if (!recording() || (blank && !(last_owner() == current_))) return;
    doc_.runs.push_back({begin, at_, current_});
  }

  std::uint32_t last_owner() const {
    return doc_.runs.empty() ? kNobody : doc_.runs.back().owner & ~kCdata;
  }

  void reference() {
    const Reference known = reference_at(text_.substr(at_));
    if (known.length != 0) {
      at_ += known.length;
      return;
    }
    const std::uint32_t begin = at_++;
    std::uint32_t end = at_ < size_ && text_[at_] == '#' ? at_ + 1 : at_;
    while (end < size_ && is(text_[end], CharClass::name)) ++end;
    if (end == at_ || end >= size_ || text_[end] != ';') {
      report(Code("E1001"), begin, begin + 1, "'&' without a reference; write '&amp;'");
      return;
    }
    const bool number = text_[at_] == '#';
    at_ = end + 1;
    if (number)
      report(Code("E1001"), begin, at_,
             fmt::format("{} is not a character of XML", quoted(begin, at_)));
    else
      report(Code("E1005"), begin, at_,
             fmt::format("the entity {} is not read; only &lt; &gt; &amp; &quot; &apos; and "
                         "character references are",
                         quoted(begin, at_)));
  }

  // ---- markup

  void markup() {
    switch (kind_at(text_, at_)) {
      case PieceKind::start_tag:
        return start_tag();
      case PieceKind::end_tag:
        return end_tag();
      case PieceKind::comment:
        return comment();
      case PieceKind::cdata:
        return cdata();
      case PieceKind::doctype:
        return doctype();
      case PieceKind::instruction:
        return instruction();
      default:
        return broken();
    }
  }

  void broken() {
    const std::uint32_t begin = at_;
    if (follows("<!")) {
      report(Code("E1001"), begin, begin + 2, "'<!' begins neither a comment nor CDATA");
      at_ = std::max(begin + 2, find(">", begin));
    } else {
      report(Code("E1001"), at_, at_ + 1,
             "'<' is followed by no name; in text it is written '&lt;'");
      ++at_;
    }
  }

  void comment() {
    const std::uint32_t begin = at_;
    const std::uint32_t dashes = find("--", begin + 4);
    at_ = close_of(PieceKind::comment);
    if (at_ == size_) {
      report(Code("E1001"), begin, begin + 4, "the comment is not closed by '-->'");
    } else {
      if (dashes < at_) report(Code("E1001"), dashes, dashes + 2, "'--' inside a comment");
      at_ += 3;
    }
  }

  void cdata() {
    const std::uint32_t begin = at_;
    const std::uint32_t end = close_of(PieceKind::cdata);
    at_ = end;
    if (end == size_)
      report(Code("E1001"), begin, begin + 9, "the CDATA section is not closed by ']]>'");
    else
      at_ += 3;
    if (!inside() && recording())
      report(Code("E1001"), begin, begin + 9, "CDATA outside the root element");
    else if (recording())
      doc_.runs.push_back({begin + 9, end, current_ | kCdata});
  }

  void instruction() {
    const std::uint32_t begin = at_;
    const std::uint32_t end = name_end(begin + 2);
    const std::string_view target = text_.substr(begin + 2, end - begin - 2);
    if (target.empty())
      report(Code("E1001"), begin, begin + 2, "'<?' is followed by no name");
    else if (target == "xml")
      report(Code("E1001"), begin, end, "the XML declaration must be at the beginning of the file");
    at_ = close_of(PieceKind::instruction);
    if (at_ == size_)
      report(Code("E1001"), begin, begin + 2, "the processing instruction is not closed by '?>'");
    else
      at_ += 2;
  }

  // Skips <!DOCTYPE … [ … ] >, quoted texts and comments inside included.
  void doctype() {
    const std::uint32_t begin = at_;
    report(Code("E1005"), begin, begin + 9, "document types are not read; leave '<!DOCTYPE' out");
    std::uint32_t brackets = 0;
    for (at_ += 9; at_ < size_; ++at_) {
      const char c = text_[at_];
      if (c == '"' || c == '\'') {
        at_ = find(std::string_view(&c, 1), at_ + 1);
      } else if (c == '<' && follows("<!--")) {
        at_ = std::min(size_, find("-->", at_ + 4) + 2);
      } else if (c == '[') {
        ++brackets;
      } else if (c == ']' && brackets > 0) {
        --brackets;
      } else if (c == '>' && brackets == 0) {
        ++at_;
        return;
      }
    }
    at_ = size_;
    report(Code("E1001"), begin, begin + 9, "the document type is not closed");
  }

  // ---- tags

  void start_tag() {
    const std::uint32_t begin = at_;
    const std::uint32_t end = name_end(begin + 1);
    at_ = end;
    if (skipped_ > 0) {
      ++skipped_;
    } else if (!inside() && root_seen_) {
      report(Code("E1001"), begin + 1, end,
             fmt::format("{} after the root element; a file has one", quoted(begin + 1, end)));
      ++skipped_;
    } else if (open_.size() >= limits_.depth) {
      if (!too_deep_)
        report(Code("E1006"), begin + 1, end,
               fmt::format("{} is nested deeper than {} elements", quoted(begin + 1, end),
                           limits_.depth));
      too_deep_ = true;
      ++skipped_;
    } else if (end - begin - 1 > kLongestName) {
      report(Code("E1001"), begin + 1, end, "a name of more than 65535 bytes");
      ++skipped_;
    } else if (doc_.elements.size() >= limits_.elements) {
      report(Code("E1008"), begin + 1, end, fmt::format("more than {} elements", limits_.elements));
      stopped_ = true;
      doc_.complete = false;
      return;
    }
    if (recording()) open_element(begin, end);
    const bool closed = attributes();
    if (recording()) doc_.elements[open_.back()].start_tag_end = at_;
    if (!closed) return;
    if (recording())
      close_element(at_);
    else
      --skipped_;
  }

  void open_element(std::uint32_t begin, std::uint32_t name_end) {
    const auto index = static_cast<std::uint32_t>(doc_.elements.size());
    Element e{};
    e.begin = begin;
    e.parent = inside() ? current_ : index;
    e.first_attribute = static_cast<std::uint32_t>(doc_.attributes.size());
    e.first_run = static_cast<std::uint32_t>(doc_.runs.size());
    e.name_length =
        static_cast<std::uint16_t>(std::min<std::size_t>(name_end - begin - 1, kLongestName));
    doc_.elements.push_back(e);
    open_.push_back(index);
    current_ = index;
    root_seen_ = true;
    doc_.height = std::max(doc_.height, static_cast<std::uint32_t>(open_.size()));
  }

  void close_element(std::uint32_t end) {
    Element& e = doc_.elements[current_];
    e.end = end;
    e.next = static_cast<std::uint32_t>(doc_.elements.size());
    open_.pop_back();
    current_ = open_.empty() ? kNobody : open_.back();
  }

  // Reads up to the end of a start tag. Returns whether the element ends there too.
  bool attributes() {
    const std::size_t first = doc_.attributes.size();
    while (true) {
      const std::uint32_t before = at_;
      skip_blanks();
      if (at_ >= size_ || text_[at_] == '<') {
        report(Code("E1001"), before, before + 1, "the tag is not closed by '>'");
        // before an end tag of another name it can hold nothing
        return recording() && follows("</") && !follows_end_of(doc_.name(current_));
      }
      if (text_[at_] == '>') {
        ++at_;
        return false;
      }
      if (follows("/>")) {
        at_ += 2;
        return true;
      }
      const std::uint32_t end = name_end(at_);
      if (end == at_) {
        report(Code("E1001"), at_, at_ + 1,
               fmt::format("{} where a tag takes an attribute or its end", quoted(at_, at_ + 1)));
        ++at_;
        continue;
      }
      if (before == at_)
        report(Code("E1001"), at_, end,
               fmt::format("a blank before {} is missing", quoted(at_, end)));
      attribute(end, first);
    }
  }

  void attribute(std::uint32_t end, std::size_t first) {
    const std::uint32_t begin = at_;
    at_ = end;
    skip_blanks();
    if (at_ >= size_ || text_[at_] != '=') {
      report(Code("E1001"), begin, end, fmt::format("{} has no value", quoted(begin, end)));
      return;
    }
    ++at_;
    skip_blanks();
    std::uint32_t value = at_;
    if (at_ < size_ && (text_[at_] == '"' || text_[at_] == '\'')) {
      ++value;
      if (!attribute_value(begin, end)) return;
    } else {
      while (at_ < size_ && !is(text_[at_], CharClass::blank) && text_[at_] != '>' &&
             text_[at_] != '<' && !follows("/>"))
        ++at_;
      report(Code("E1001"), value, std::max(at_, value + 1),
             fmt::format("the value of {} needs quotes", quoted(begin, end)));
      add_attribute(begin, end, value, at_, first);
      return;
    }
    add_attribute(begin, end, value, at_ - 1, first);
  }

  // Whether a quote follows before anything that looks like the end of a tag or line.
  bool closes_soon(char quote) const {
    for (std::uint32_t i = at_ + 1; i < size_; ++i) {
      const char c = text_[i];
      if (c == quote) return true;
      if (c == '<' || c == '>' || c == '\n') break;
    }
    return false;
  }

  // Reads past the closing quote.
  bool attribute_value(std::uint32_t name_begin, std::uint32_t name_end) {
    const std::uint32_t open = at_;
    const char quote = text_[at_++];
    while (at_ < size_) {
      const char c = text_[at_];
      if (!is(c, CharClass::stops_value) || ((c == '"' || c == '\'') && c != quote)) {
        ++at_;
      } else if (c == '&') {
        reference();
      } else if (c == quote) {
        ++at_;
        return true;
      } else if (closes_soon(quote)) {
        report(Code("E1001"), at_, at_ + 1,
               fmt::format("'<' in the value of {}; write '&lt;'", quoted(name_begin, name_end)));
        ++at_;
      } else {
        break;
      }
    }
    report(Code("E1001"), open, open + 1,
           fmt::format("the value of {} has no closing quote", quoted(name_begin, name_end)));
    // the tag most likely ends where it seems to
    const std::size_t close = text_.substr(open, at_ - open).find('>');
    if (close != std::string_view::npos) at_ = open + static_cast<std::uint32_t>(close);
    if (at_ > open && at_ < size_ && text_[at_ - 1] == '/') --at_;
    return false;
  }

  void add_attribute(std::uint32_t begin, std::uint32_t end, std::uint32_t value,
                     std::uint32_t value_end, std::size_t first) {
    if (!recording()) return;
    const std::string_view name = text_.substr(begin, end - begin);
    for (std::size_t i = first; i < doc_.attributes.size(); ++i) {
      if (doc_.name(doc_.attributes[i]) != name) continue;
      report(Code("E1007"), begin, end,
             fmt::format("{} is given twice; the first one is used", quoted(begin, end)));
      return;
    }
    if (end - begin > kLongestName) {
      report(Code("E1001"), begin, end, "a name of more than 65535 bytes");
      return;
    }
    // note: bounds the search for duplicates, which is quadratic
    if (doc_.attributes.size() - first >= 256) {
      report(Code("E1001"), begin, end, "more than 256 attributes");
      return;
    }
    doc_.attributes.push_back({begin, value, value_end, static_cast<std::uint16_t>(end - begin)});
  }

  void end_tag() {
    const std::uint32_t begin = at_;
    const std::uint32_t end = name_end(begin + 2);
    at_ = end;
    skip_blanks();
    if (end == begin + 2) {
      report(Code("E1001"), begin, begin + 2, "'</' is followed by no name");
      while (at_ < size_ && text_[at_] != '>' && text_[at_] != '<') ++at_;
      if (at_ < size_ && text_[at_] == '>') ++at_;
      return;
    }
    if (at_ < size_ && text_[at_] == '>')
      ++at_;
    else
      report(Code("E1001"), begin + 2, end,
             fmt::format("the end tag {} is not closed by '>'", quoted(begin + 2, end)));
    if (skipped_ > 0) {
      --skipped_;
      return;
    }
    match(begin, end);
  }

  void match(std::uint32_t begin, std::uint32_t end) {
    const std::string_view name = text_.substr(begin + 2, end - begin - 2);
    if (inside() && doc_.name(current_) == name) {
      close_element(at_);
      return;
    }
    const auto same = [&](std::uint32_t e) { return doc_.name(e) == name; };
    if (std::none_of(open_.begin(), open_.end(), same)) {
      const std::string open = inside() ? to_utf8(doc_.name(current_), doc_.encoding) : "";
      report(Code("E1002"), begin + 2, end,
             fmt::format("no element {} is open here", quoted(begin + 2, end)),
             inside()
                 ? fmt::format("<{}> of line {} is", open, line_of(doc_.elements[current_].begin))
                 : "");
      // a misspelt end tag ends what it means to end
      const std::string_view candidates[] = {open};
      const bool meant = open.size() >= 3 && nearest_name(name.substr(0, 256), candidates);
      if (inside() && meant) close_element(at_);
      return;
    }
    report(Code("E1002"), begin + 2, end,
           fmt::format("{} is closed while <{}> of line {} is open", quoted(begin + 2, end),
                       to_utf8(doc_.name(current_), doc_.encoding),
                       line_of(doc_.elements[current_].begin)));
    while (!same(current_)) close_element(begin);
    close_element(at_);
  }

  void finish() {
    if (!stopped_ && inside()) {
      const Element& e = doc_.elements[current_];
      const std::size_t around = open_.size() - 1;
      report(Code("E1001"), e.begin + 1, e.begin + 1 + e.name_length,
             fmt::format(
                 "<{}> is not closed at the end of the file{}",
                 to_utf8(doc_.name(current_), doc_.encoding),
                 around > 0 ? fmt::format(", nor {} around it", counted(around, "element")) : ""));
    }
    if (!stopped_ && !root_seen_) report(Code("E1001"), size_, size_, "the file holds no element");
    while (inside()) {
      Element& e = doc_.elements[current_];
      if (e.start_tag_end == 0) e.start_tag_end = size_;
      close_element(size_);
    }
    Element sentinel{};
    sentinel.begin = sentinel.end = sentinel.start_tag_end = size_;
    sentinel.next = static_cast<std::uint32_t>(doc_.elements.size());
    sentinel.first_attribute = static_cast<std::uint32_t>(doc_.attributes.size());
    sentinel.first_run = static_cast<std::uint32_t>(doc_.runs.size());
    doc_.elements.push_back(sentinel);
  }

  Document& doc_;
  std::string_view text_;
  std::uint32_t size_;
  std::uint32_t at_;
  Limits limits_;
  DiagnosticLog& log_;
  std::vector<std::uint32_t> open_;
  std::uint32_t current_ = kNobody;
  std::uint64_t skipped_ = 0;  // open elements that are not recorded
  std::size_t errors_ = 0;
  bool root_seen_ = false;
  bool too_deep_ = false;
  bool stopped_ = false;
};

}  // namespace

Document scan(FileId file, const Limits& limits, DiagnosticLog& log) {
  Document document;
  document.file = file;
  assert(log.sources().file(file).bytes);
  document.bytes = *log.sources().file(file).bytes;
  assert(document.bytes.size() < 0xffffffffu);
  const Prolog prolog = read_prolog(document.bytes, file, log);
  document.encoding = prolog.encoding;
  if (!prolog.readable) {
    document.elements.push_back(Element{});
    return document;
  }
  Scanner(document, prolog.body, limits, log).run();
  return document;
}

}  // namespace panwright::pxn::xml
