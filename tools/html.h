// Text inside HTML pages.
#pragma once

#include <string>
#include <string_view>

namespace panwright::tools {

// Text as the content of an element or a quoted attribute, in UTF-8 whatever it was.
std::string html_escaped(std::string_view text);

}  // namespace panwright::tools
