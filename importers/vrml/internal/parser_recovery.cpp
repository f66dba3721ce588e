#include <fmt/core.h>

#include <algorithm>

#include "base/text.h"
#include "importers/vrml/internal/characters.h"
#include "importers/vrml/internal/parser.h"

namespace panwright::importers::vrml {

// Skips what follows a field that is not known. Nodes are read: their names may be used later.
void Parser::skip_value() {
  skip_blanks();
  if (vrml97_ && accept_word("IS")) {
    skip_blanks();
    word();
    return;
  }
  bool there = false;
  if (*p_ == '[') {
    ++p_;
    for (;;) {
      skip_blanks();
      if (at_end() || *p_ == '}') return;
      const std::string_view text = peek_word();
      if (*p_ == ']') {
        ++p_;
        return;
      }
      if (at_word() && (text == "DEF" || text == "USE" || brace_follows()))
        node_value(&there);
      else if (*p_ == '"')
        skip_string();
      else if (*p_ == '[' || *p_ == '{')
        skip_braces();
      else
        p_ += std::max<std::size_t>(1, token_here().size());
    }
  }
  for (bool first = true;; first = false) {
    skip_blanks();
    const std::string_view text = peek_word();
    if (*p_ == '"') {
      skip_string();
    } else if (at_number() || text == "TRUE" || text == "FALSE" || text == "NULL") {
      p_ += text.size();
    } else {
      if (!first || !at_word()) return;
      const bool field = field_names_ != nullptr && spec_of(*field_names_, text) != nullptr;
      if (text == "DEF" || text == "USE" || brace_follows())
        node_value(&there);
      else if (!vrml97_ && !field)
        p_ += text.size();  // a word of an enumeration
      return;
    }
  }
}

// From "{" or "[" past what closes it; strings and comments are seen as such.
void Parser::skip_braces() {
  std::size_t open = 0;
  const char* const at = p_;
  do {
    skip_blanks();
    if (at_end()) {
      text_ends(span(at, at + 1), "part");
      return;
    }
    if (*p_ == '"') {
      skip_string();
      continue;
    }
    if (*p_ == '{' || *p_ == '[') ++open;
    if (*p_ == '}' || *p_ == ']') --open;
    p_ += std::max<std::size_t>(1, peek_word().size());
  } while (open > 0);
}

void Parser::skip_string() {
  std::string_view text;
  string(text);
}

// Skips tokens that mean nothing here, up to a word, or up to `close`, with one message.
void Parser::skip_stray(char close) {
  skip_blanks();
  if (at_end()) return;
  const std::string_view text = token_here();
  report(Code("E6103"), here(),
         *p_ == '\0' ? std::string("a NUL byte") : fmt::format("unexpected {}", in_quotes(text)));
  for (bool first = true;; first = false) {
    skip_blanks();
    if (at_end() || at_word() || (*p_ == close && close != '\0')) return;
    if (!first && (*p_ == '}' || *p_ == ']')) return;
    if (*p_ == '"')
      skip_string();
    else if (*p_ == '{' || *p_ == '[')
      skip_braces();
    else
      p_ += std::max<std::size_t>(1, token_here().size());
  }
}

}  // namespace panwright::importers::vrml
