#include "tools/html.h"

#include "base/source.h"

namespace panwright::tools {

std::string html_escaped(std::string_view text) {
  std::string out;
  for (const char c : to_utf8(text, Encoding::utf8)) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

}  // namespace panwright::tools
