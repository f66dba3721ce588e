// Text inside HTML pages.
#pragma once

#include <string>
#include <string_view>

namespace panwright::tools {

// Escapes a text as the content of an element or a quoted attribute, as valid UTF-8.
std::string html_escaped(std::string_view text);

}  // namespace panwright::tools
