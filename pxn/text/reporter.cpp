#include "pxn/text/reporter.h"

#include <fmt/core.h>

#include <vector>

namespace panwright::pxn {

std::string object_path(const xml::Document& document, std::uint32_t element) {
  // finding an index among more siblings than this costs more than it tells
  constexpr std::uint32_t kMostSiblings = 100'000;
  std::vector<std::string> parts;
  for (std::uint32_t e = element;; e = document.elements[e].parent) {
    const std::uint32_t parent = document.elements[e].parent;
    std::uint32_t same = 0;
    std::uint32_t index = 0;
    std::uint32_t seen = 0;
    if (parent != e) {
      for (std::uint32_t c = parent + 1; c < document.elements[parent].next && seen < kMostSiblings;
           c = document.elements[c].next, ++seen) {
        if (document.name(c) != document.name(e)) continue;
        ++same;
        if (c == e) index = same;
      }
    }
    std::string part = to_utf8(document.name(e).substr(0, 60), document.encoding);
    if (same > 1 && index > 0) part += fmt::format("[{}]", index);
    parts.push_back(std::move(part));
    if (parent == e) break;
  }
  std::string path;
  for (auto part = parts.rbegin(); part != parts.rend(); ++part) {
    if (!path.empty()) path += '/';
    path += *part;
  }
  return path;
}

}  // namespace panwright::pxn
