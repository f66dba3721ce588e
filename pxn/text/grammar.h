// Check of a document against the tables of the language. Independent of single elements.
#pragma once

#include "pxn/text/reporter.h"
#include "pxn/text/xml.h"
#include "schemas/generated/pxn_schema.h"

namespace panwright::pxn {

// Sets every element's id, or kNoElement for unknown, unsupported and surplus ones with all their
// contents. Each problem is reported once, at its begin.
//
//   returns  true if the root is the language's, in a supported version; if not, no element has an
//            id
//
// Reports: E1101 to E1108. Cost: O(elements · places for children of one element).
bool check_grammar(xml::Document& document, const schemas::Language& language, Reporter& reporter);

// Returns the attribute of an element by its index in the tables; nullptr if absent.
const xml::Attribute* find_attribute(const xml::Document& document, std::uint32_t element,
                                     std::string_view name);

}  // namespace panwright::pxn
