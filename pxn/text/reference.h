// References in XML text: the five predefined entities and characters by number.
#pragma once

#include <cstdint>
#include <string_view>

namespace panwright::pxn::xml {

struct Reference {
  std::uint32_t length = 0;  // bytes with & and ;, or 0: not one of those that are read
  std::uint32_t character = 0;
};

// The reference that a text begins with. Expects: text[0] == '&'.
Reference reference_at(std::string_view text);

}  // namespace panwright::pxn::xml
