// Holds a document against the tables of the language. Knows no element by name.
#pragma once

#include "pxn/text/reporter.h"
#include "pxn/text/xml.h"
#include "schemas/generated/pxn_schema.h"

namespace panwright::pxn {

// Gives every element its id, or kNoElement to those that are unknown, not supported, or one too
// many, and to all inside them. Each problem is reported once, where it begins.
//
//   returns  whether the root is the language's, in a version that is read; if not, no element has
//            an id
//
// Reports: E1101 to E1108. Cost: O(elements · places for children of one element).
bool check_grammar(xml::Document& document, const schemas::Language& language, Reporter& reporter);

// The attribute of an element by its index in the tables; nullptr when it is not there.
const xml::Attribute* find_attribute(const xml::Document& document, std::uint32_t element,
                                     std::string_view name);

}  // namespace panwright::pxn
