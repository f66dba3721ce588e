#include "pxn/internal/pattern.h"

namespace panwright::pxn {

bool matches(std::string_view pattern, std::string_view text) {
  std::size_t p = 0, t = 0;
  // where the last star stands, and the text that it has taken so far ends
  std::size_t star = std::string_view::npos, taken = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      taken = t;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++taken;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

std::vector<char> matching_nodes(const scene::Scene& scene, std::uint32_t top,
                                 std::string_view pattern) {
  std::vector<char> out(scene.nodes.size());
  const bool by_path = pattern.find('/') != std::string_view::npos;
  std::vector<std::string> paths(by_path ? scene.nodes.size() : 0);
  for (std::size_t i = top + 1; i < scene.nodes.size(); ++i) {
    const scene::Node& node = scene.nodes[i];
    const auto parent = static_cast<std::size_t>(node.parent);
    if (by_path) paths[i] = parent <= top ? node.name : paths[parent] + "/" + node.name;
    out[i] = static_cast<char>(out[parent] || matches(pattern, by_path ? paths[i] : node.name));
  }
  return out;
}

}  // namespace panwright::pxn
