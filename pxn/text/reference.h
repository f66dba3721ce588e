// References in XML text: the five predefined entities and characters by number.
#pragma once

#include <cstdint>
#include <string_view>

namespace panwright::pxn::xml {

struct Reference {
  std::uint32_t length = 0;  // bytes with & and ;, or 0: unsupported
  std::uint32_t character = 0;
};

// Returns the reference at the start of a text. Expects: text[0] == '&'.
Reference reference_at(std::string_view text);

}  // namespace panwright::pxn::xml
