// Encodings of XML texts. Private to importers.
//
// Source: XML 1.0, 4.3.3 and appendix F; Windows-1252 as in the WHATWG Encoding Standard.
#pragma once

#include <string>

#include "base/source.h"

namespace panwright::importers::internal {

struct Recoded {
  SharedText bytes;
  std::string deviation;  // guesses: one lower-case sentence, or empty
};

// Returns an XML text in UTF-8: by its byte order mark, the width of its first characters, or its
// declaration. Reads UTF-8, UTF-16, UTF-32, ISO-8859-1, ISO-8859-15 and Windows-1252; what is no
// UTF-8, and declares nothing else, is taken for Windows-1252. Other texts are unchanged, except
// those of UTF-16 or UTF-32 with a byte order mark.
Recoded xml_in_utf8(SharedText bytes);

}  // namespace panwright::importers::internal
