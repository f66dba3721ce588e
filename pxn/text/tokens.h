// Tokens of XML texts: blanks, names, and the bounds of markup. Shared by the scanner (xml.h) and
// the iterator over valid texts (markup.h).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace panwright::pxn::xml {

enum class CharClass : std::uint8_t {
  blank = 1,
  name_start = 2,
  name = 4,
  stops_text = 8,    // < & ]
  stops_value = 16,  // < & and quotes
};

namespace internal {

constexpr std::array<std::uint8_t, 256> make_classes() {
  std::array<std::uint8_t, 256> classes{};
  const auto add = [&](int c, CharClass which) {
    classes[static_cast<unsigned char>(c)] |= static_cast<std::uint8_t>(which);
  };
  for (const char c : {' ', '\t', '\n', '\r'}) add(c, CharClass::blank);
  for (int c = 0; c < 256; ++c) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == ':';
    if (letter || c >= 0x80) add(c, CharClass::name_start);
    if (letter || c >= 0x80 || (c >= '0' && c <= '9') || c == '-' || c == '.')
      add(c, CharClass::name);
  }
  for (const char c : {'<', '&', ']'}) add(c, CharClass::stops_text);
  for (const char c : {'<', '&', '"', '\''}) add(c, CharClass::stops_value);
  return classes;
}
inline constexpr auto kClasses = make_classes();

}  // namespace internal

constexpr bool is(char c, CharClass which) {
  return (internal::kClasses[static_cast<unsigned char>(c)] & static_cast<std::uint8_t>(which)) !=
         0;
}

// Returns the place past the blanks.
inline std::size_t blanks_end(std::string_view text, std::size_t at) {
  while (at < text.size() && is(text[at], CharClass::blank)) ++at;
  return at;
}

// Returns the place past the name; the place itself if no name begins.
inline std::size_t name_end(std::string_view text, std::size_t at) {
  if (at >= text.size() || !is(text[at], CharClass::name_start)) return at;
  while (at < text.size() && is(text[at], CharClass::name)) ++at;
  return at;
}

enum class PieceKind : std::uint8_t {
  text,         // up to the next '<'
  start_tag,    // <a …>
  empty_tag,    // <a …/>
  end_tag,      // </a>
  comment,      // <!--…-->
  instruction,  // <?…?>, the XML declaration too
  cdata,        // <![CDATA[…]]>
  doctype,      // <!DOCTYPE…>, which pxn does not read
  broken,       // '<' without a valid successor
  end,          // of the text
};

// Returns the kind of the piece at a place. An empty tag is distinguished only at its end:
// start_tag.
inline PieceKind kind_at(std::string_view text, std::size_t at) {
  if (at >= text.size()) return PieceKind::end;
  if (text[at] != '<') return PieceKind::text;
  const std::string_view rest = text.substr(at + 1);
  if (rest.empty()) return PieceKind::broken;
  if (is(rest[0], CharClass::name_start)) return PieceKind::start_tag;
  if (rest[0] == '/') return PieceKind::end_tag;
  if (rest[0] == '?') return PieceKind::instruction;
  if (rest.starts_with("!--")) return PieceKind::comment;
  if (rest.starts_with("![CDATA[")) return PieceKind::cdata;
  if (rest.starts_with("!DOCTYPE")) return PieceKind::doctype;
  return PieceKind::broken;
}

// Opening and closing marks of a comment, CDATA section or instruction.
struct Marks {
  std::string_view open;
  std::string_view close;
};
inline Marks marks_of(PieceKind kind) {
  if (kind == PieceKind::comment) return {"<!--", "-->"};
  if (kind == PieceKind::cdata) return {"<![CDATA[", "]]>"};
  return {"<?", "?>"};
}

// Returns the place of the closing mark of a comment, CDATA section or instruction that begins at
// `at`; the size of the text if there is none.
inline std::size_t close_of(std::string_view text, std::size_t at, PieceKind kind) {
  const Marks marks = marks_of(kind);
  return std::min(text.find(marks.close, at + marks.open.size()), text.size());
}

}  // namespace panwright::pxn::xml
