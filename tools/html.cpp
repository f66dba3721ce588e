#include "tools/html.h"

#include "base/source.h"
#include "base/text.h"

namespace panwright::tools {

std::string html_escaped(std::string_view text) {
  return markup_escaped(to_utf8(text, Encoding::utf8));
}

}  // namespace panwright::tools
