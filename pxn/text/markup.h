// The pieces of a well-formed XML text, one after the other, without a tree.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pxn/text/tokens.h"

namespace panwright::pxn::xml {

struct Piece {
  PieceKind kind = PieceKind::end;
  std::string_view bytes;  // all of it, with its marks
};

// Expects: a text in which xml::scan finds nothing wrong, behind its byte order mark.
class Markup {
 public:
  explicit Markup(std::string_view text, std::size_t at = 0) : text_(text), at_(at) {}

  Piece next();
  std::size_t at() const { return at_; }  // past the last piece

 private:
  std::string_view text_;
  std::size_t at_;
};

// The name of a tag of any kind.
std::string_view tag_name(std::string_view tag);

struct TagAttribute {
  std::string_view name;
  std::string_view value;  // as written, without its quotes
};

// Those of a start tag or empty tag, in order; replaces `out`.
void read_attributes(std::string_view tag, std::vector<TagAttribute>& out);

// Whether the attributes ask for all blanks inside the element to stay: xml:space="preserve".
bool preserves_blanks(const std::vector<TagAttribute>& attributes);

// The place of the end tag of an element, given the place past its start tag.
std::size_t end_tag_of(std::string_view text, std::size_t content);

// Line ends as XML reads them: CR and CR LF become LF.
std::string with_line_feeds(std::string_view text);

// What the language says about the values of a tag. Unknown tags have none of it.
struct TagValues {
  bool numbers = false;     // the text between the tags is numbers, or expressions in braces
  std::uint32_t tuple = 1;  // of a list of them
  std::vector<std::string_view> number_attributes;

  bool has_numbers(std::string_view attribute) const;
};

// parent: the tag around it, which decides where one tag means two elements.
const TagValues& values_of_tag(std::string_view parent, std::string_view tag);

// Empty when two texts mean the same: equal elements, attributes (in any order), comments,
// instructions and text, where a run of blanks in text is as good as another and blanks at the ends
// of text, of lists of numbers and of expressions in braces are as good as none. Else the first
// difference, in words.
//
// Expects: both as for Markup, with LF for line ends. Cost: O(bytes); memory for the longest text.
std::string difference_of(std::string_view a, std::string_view b);

}  // namespace panwright::pxn::xml
