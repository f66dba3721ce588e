// Encoding of a file, and check of its bytes.
#pragma once

#include <string_view>

#include "base/diagnostic.h"

namespace panwright::pxn::xml {

struct Prolog {
  bool readable = false;
  Encoding encoding = Encoding::utf8;
  std::uint32_t body = 0;  // past the byte order mark and the XML declaration
};

// Reads the byte order mark and the XML declaration, and checks every byte.
//
// Reports: E1001 (the declaration), E1003, E1004 (once, with the number of bad places).
Prolog read_prolog(std::string_view bytes, FileId file, DiagnosticLog& log);

}  // namespace panwright::pxn::xml
