// The tree of an XML text whose elements and attributes know their places.
#pragma once

#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "importers/meshes/reader_context.h"

namespace panwright::importers {

// Whether the first element of a text has this name.
bool first_element_is(std::string_view text, std::string_view name);

class XmlText {
 public:
  // Reports E6220 where the text is not well-formed; what stands before the place is read. False
  // where the text is over the limit of memory (E6002).
  bool parse(meshes::ReaderContext& context);

  pugi::xml_node top() const { return document_.document_element(); }
  SourceSpan at(const pugi::xml_node& element) const;         // its name
  SourceSpan at(const pugi::xml_attribute& attribute) const;  // its value

 private:
  SourceSpan span(const char* begin, std::size_t size) const;

  std::string text_;  // parsed in place: names and values are parts of it
  pugi::xml_document document_;
  meshes::ReaderContext* context_ = nullptr;
};

}  // namespace panwright::importers
