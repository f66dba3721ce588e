// Tokens of an element without children: words, and asides between them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "pxn/text/markup.h"

namespace panwright::pxn::xml {

inline constexpr std::string_view kBlanks = " \t\n";

// Iterator over the words of a text. In numbers, an expression in braces is one word, without
// blanks at its ends.
class Words {
 public:
  Words(std::string_view text, bool numbers);

  // The view is good until the next call.
  bool next(std::string_view& word);

 private:
  std::string_view tidied(std::string_view word);

  std::string_view text_;
  bool braces_;
  std::size_t at_ = 0;
  std::string tidied_;
};

// Word with all adjacent bytes, or a comment or instruction that touches no word.
struct ContentToken {
  std::string_view bytes;        // empty: at the end
  bool aside = false;            // a comment or instruction; bytes is then a part of the text
  std::size_t lines_before = 0;  // line ends since the last token, or the start tag
};

class ContentTokens {
 public:
  ContentTokens(std::string_view content, bool numbers);

  // The view is good until the next call.
  ContentToken next();

  // Line ends after the last token. Expects: next() gave it.
  std::size_t lines_behind() const { return lines_; }

 private:
  struct Item {
    PieceKind kind = PieceKind::end;  // text: a word
    std::string_view bytes;
    bool blank_before = false;
    std::size_t lines_before = 0;
    bool is_aside() const { return kind == PieceKind::comment || kind == PieceKind::instruction; }
  };
  Item next_item();
  void begin_text(std::string_view text);

  Markup markup_;
  Words words_;
  bool numbers_;
  bool in_text_ = false;
  bool first_of_text_ = false;
  // between the last item and the next one; and the same after the current text
  bool blank_ = false;
  bool blank_behind_ = false;
  std::size_t lines_ = 0;
  std::size_t lines_behind_ = 0;
  Item pending_;
  std::string pending_bytes_;
  bool has_pending_ = false;
  std::string token_;
};

}  // namespace panwright::pxn::xml
