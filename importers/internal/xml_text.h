// Tree of an XML text with places of elements and attributes.
#pragma once

#include <initializer_list>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "importers/internal/reader_context.h"

namespace panwright::importers {

// Returns true if the first element of a text has this name.
bool first_element_is(std::string_view text, std::string_view name);

class XmlText {
 public:
  // Parses the text. Reports E6220 if it is not well-formed, and keeps the part before. False over
  // the limit of memory (E6002).
  bool parse(meshes::ReaderContext& context);

  pugi::xml_node top() const { return document_.document_element(); }

  // Reads another text into the tree: the contents of its first element replace `element`. Reports
  // E6220 if the text is not well-formed, keeping the part before, or if its first element has none
  // of the names; E6002.
  //
  //   path, bytes  of the other text, in any encoding; it is included at `where`
  //   names        that its first element may have
  //   returns      the first inserted node, or the one after `element`; null: nothing
  pugi::xml_node include(pugi::xml_node element, const std::string& path, const SharedText& bytes,
                         SourceSpan where, std::initializer_list<std::string_view> names);
  // Returns true if an element lies in the text of a path, or in one that it includes.
  bool is_within(const pugi::xml_node& element, const std::string& path) const;
  // Returns the path of the text of an element, as in Files.
  const std::string& path_of(const pugi::xml_node& element) const;

  SourceSpan at(const pugi::xml_node& element) const;         // its name
  SourceSpan at(const pugi::xml_attribute& attribute) const;  // its value

 private:
  // Text of the tree: its names and values are parts of memory of that length.
  struct Piece {
    std::size_t size;
    FileId file;
    std::string path;
    const Piece* around;  // its includer; null: the model
  };
  const Piece* piece_at(const char* place, const char*& begin) const;  // null: the model
  SourceSpan span(const char* begin, std::size_t size) const;

  std::map<const char*, Piece, std::less<>> included_;  // by the begin of its memory
  std::string text_;  // parsed in place: names and values are parts of it
  pugi::xml_document document_;
  meshes::ReaderContext* context_ = nullptr;
};

}  // namespace panwright::importers
