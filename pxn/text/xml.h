// XML scanner that keeps the places of all pieces in the file's own bytes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "schemas/generated/pxn_schema.h"

namespace panwright::pxn::xml {

// Element, in document order: its first child, if any, is the next element.
struct Element {
  std::uint32_t begin;            // of the start tag, at '<'; the name follows
  std::uint32_t start_tag_end;    // past the start tag's '>'
  std::uint32_t end;              // past the end tag's '>', or past "/>"
  std::uint32_t parent;           // element index; the root is its own parent
  std::uint32_t next;             // past the last element inside this one
  std::uint32_t first_attribute;  // index; those up to the next element's are this one's
  std::uint32_t first_run;        // index of the first text run after the start tag
  std::uint16_t name_length;      // bytes
  schemas::ElementId id = schemas::kNoElement;  // filled in by the grammar check
};
static_assert(sizeof(Element) == 32);

struct Attribute {
  std::uint32_t name_begin;
  std::uint32_t value_begin;  // inside the quotes
  std::uint32_t value_end;
  std::uint16_t name_length;  // bytes
};

// Text between tags that is not all blank, or a CDATA section.
struct Run {
  std::uint32_t begin;
  std::uint32_t end;
  std::uint32_t
      owner;  // element index; the highest bit marks CDATA, whose marks begin and end exclude
};
inline constexpr std::uint32_t kCdata = 0x80000000u;

struct Limits {
  std::uint64_t elements = 20'000'000;
  std::uint32_t depth = 256;
};

// Elements of one file. The text stays in the source map.
struct Document {
  FileId file = kNoFile;
  Encoding encoding = Encoding::utf8;
  std::string_view bytes;
  std::vector<Element> elements;      // E + 1; the last one is a sentinel
  std::vector<Attribute> attributes;  // A
  std::vector<Run> runs;              // R
  bool complete = true;               // false: a limit was reached
  std::uint32_t height = 0;           // elements on the longest path from the root

  bool empty() const { return elements.size() <= 1; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(elements.size()) - 1; }
  std::string_view name(std::uint32_t element) const {
    const Element& e = elements[element];
    return bytes.substr(e.begin + 1, e.name_length);
  }
  std::string_view name(const Attribute& a) const {
    return bytes.substr(a.name_begin, a.name_length);
  }
  SourceSpan span(std::uint32_t begin, std::uint32_t end) const { return {file, begin, end}; }
  SourceSpan name_span(std::uint32_t element) const {
    const Element& e = elements[element];
    return {file, e.begin + 1, e.begin + 1 + e.name_length};
  }
  SourceSpan tag_span(std::uint32_t element) const {
    return {file, elements[element].begin, elements[element].start_tag_end};
  }
  SourceSpan name_span(const Attribute& a) const {
    return {file, a.name_begin, a.name_begin + a.name_length};
  }
  SourceSpan value_span(const Attribute& a) const { return {file, a.value_begin, a.value_end}; }
};

// Scans a file of the log's source map, and sets its encoding there.
//
// Every problem is reported, and scanning continues after it if possible. Elements past a limit are
// left out. Entities are never expanded; document types are skipped.
//
//   returns  the readable elements; none for an unsupported encoding
//
// Reports: E1001 to E1008. Cost: O(bytes), no recursion; 32 bytes an element, 16 an attribute, 12 a
// run of text. Expects: the file's bytes are present and fewer than 2^32.
Document scan(FileId file, const Limits& limits, DiagnosticLog& log);

// Decodes a raw value to UTF-8, references replaced, line ends and (in attributes) blanks
// normalised as in XML. source_offsets, when given, gets the source place of each byte of the
// result, and one more for the end.
std::string decoded(const Document& document, std::uint32_t begin, std::uint32_t end,
                    std::vector<std::uint32_t>* source_offsets = nullptr);

}  // namespace panwright::pxn::xml
