// Pieces of a well-formed XML text, one after the other, without a tree.
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

// Iterator. Expects: a text without problems by xml::scan, after its byte order mark.
class Markup {
 public:
  explicit Markup(std::string_view text, std::size_t at = 0) : text_(text), at_(at) {}

  Piece next();
  std::size_t at() const { return at_; }  // past the last piece

 private:
  std::string_view text_;
  std::size_t at_;
};

// Returns the name of a tag of any kind.
std::string_view tag_name(std::string_view tag);

struct TagAttribute {
  std::string_view name;
  std::string_view value;  // as written, without its quotes
};

// Reads those of a start tag or empty tag, in order; replaces `out`.
void read_attributes(std::string_view tag, std::vector<TagAttribute>& out);

// Returns true if the attributes preserve all blanks inside the element: xml:space="preserve".
bool preserves_blanks(const std::vector<TagAttribute>& attributes);

// Returns the place of the end tag of an element, given the place past its start tag.
std::size_t end_tag_of(std::string_view text, std::size_t content);

// Normalises line ends as XML: CR and CR LF become LF.
std::string with_line_feeds(std::string_view text);

// Properties of a tag's values in the language. Unknown tags have none.
struct TagValues {
  bool numbers = false;     // the text between the tags is numbers, or expressions in braces
  std::uint32_t tuple = 1;  // of a list of them
  std::vector<std::string_view> number_attributes;

  bool has_numbers(std::string_view attribute) const;
};

// parent: the surrounding tag, which distinguishes two elements of one tag.
const TagValues& values_of_tag(std::string_view parent, std::string_view tag);

// Compares the meaning of two texts: elements, attributes (in any order), comments, instructions
// and text. Runs of blanks in text are equal, and blanks at the ends of text, lists of numbers and
// expressions in braces are ignored. Returns the first difference in words, or an empty string.
//
// Expects: both as for Markup, with LF for line ends. Cost: O(bytes); memory for the longest text.
std::string difference_of(std::string_view a, std::string_view b);

}  // namespace panwright::pxn::xml
