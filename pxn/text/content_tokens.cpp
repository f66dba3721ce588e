#include "pxn/text/content_tokens.h"

#include <algorithm>

namespace panwright::pxn::xml {

namespace {

std::size_t count_lines(std::string_view text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

// Whether every brace has its partner and none stands inside another.
bool has_sound_braces(std::string_view text) {
  bool inside = false;
  for (std::size_t at = text.find_first_of("{}"); at != std::string_view::npos;
       at = text.find_first_of("{}", at + 1)) {
    if ((text[at] == '{') == inside) return false;
    inside = !inside;
  }
  return !inside;
}

bool is_content_blank(char c) { return c == ' ' || c == '\t' || c == '\n'; }

}  // namespace

Words::Words(std::string_view text, bool numbers)
    : text_(text),
      braces_(numbers && text.find('{') != std::string_view::npos && has_sound_braces(text)) {}

bool Words::next(std::string_view& word) {
  while (at_ < text_.size() && is_content_blank(text_[at_])) ++at_;
  if (at_ == text_.size()) return false;
  const std::size_t begin = at_;
  bool inside = false;
  bool tidy = true;
  for (; at_ < text_.size(); ++at_) {
    const char c = text_[at_];
    if (is_content_blank(c)) {
      if (!inside) break;
      tidy = false;
    } else if (braces_ && (c == '{' || c == '}')) {
      inside = c == '{';
    }
  }
  word = text_.substr(begin, at_ - begin);
  if (!tidy) word = tidied(word);
  return true;
}

// Without blanks at the ends of braces; line ends and tabs inside become blanks.
std::string_view Words::tidied(std::string_view word) {
  tidied_.clear();
  for (std::size_t i = 0; i < word.size();) {
    const std::size_t end = std::min(word.find_first_not_of(kBlanks, i), word.size());
    if (end == i) {
      tidied_.push_back(word[i++]);
      continue;
    }
    const std::string_view blanks = word.substr(i, end - i);
    const bool at_end = tidied_.back() == '{' || word[end] == '}';
    if (!at_end) tidied_ += blanks.find_first_of("\t\n") == std::string_view::npos ? blanks : " ";
    i = end;
  }
  return tidied_;
}

ContentTokens::ContentTokens(std::string_view content, bool numbers)
    : markup_(content), words_({}, false), numbers_(numbers) {}

void ContentTokens::begin_text(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) {
    blank_ = true;
    lines_ = count_lines(text);
    return;
  }
  const std::size_t last = text.find_last_not_of(kBlanks);
  blank_ = first > 0;
  lines_ = count_lines(text.substr(0, first));
  blank_behind_ = last + 1 < text.size();
  lines_behind_ = count_lines(text.substr(last + 1));
  words_ = Words(text, numbers_);
  in_text_ = true;
  first_of_text_ = true;
}

ContentTokens::Item ContentTokens::next_item() {
  while (true) {
    Item item;
    if (in_text_) {
      if (words_.next(item.bytes)) {
        item.kind = PieceKind::text;
        item.blank_before = !first_of_text_ || blank_;
        item.lines_before = first_of_text_ ? lines_ : 0;
        first_of_text_ = false;
        return item;
      }
      in_text_ = false;
      blank_ = blank_behind_;
      lines_ = lines_behind_;
    }
    const Piece piece = markup_.next();
    if (piece.kind == PieceKind::text) {
      begin_text(piece.bytes);
      continue;
    }
    item.kind = piece.kind;
    item.bytes = piece.bytes;
    item.blank_before = blank_;
    item.lines_before = lines_;
    if (piece.kind == PieceKind::end) return item;
    blank_ = false;
    lines_ = 0;
    return item;
  }
}

ContentToken ContentTokens::next() {
  Item item = has_pending_ ? pending_ : next_item();
  has_pending_ = false;
  if (item.kind == PieceKind::end) return {};
  ContentToken token{item.bytes, item.is_aside(), item.lines_before};
  // a word is good until the next one is asked for
  bool copied = !token.aside;
  if (copied) token_ = item.bytes;
  while (true) {
    pending_ = next_item();
    has_pending_ = true;
    if (pending_.kind == PieceKind::end || pending_.blank_before) break;
    if (token.aside && pending_.is_aside()) break;
    if (!copied) token_ = item.bytes;
    copied = true;
    token.aside = false;
    token_ += pending_.bytes;
  }
  if (copied) token.bytes = token_;
  if (pending_.kind == PieceKind::text) {
    pending_bytes_ = pending_.bytes;
    pending_.bytes = pending_bytes_;
  }
  return token;
}

}  // namespace panwright::pxn::xml
