#include "pxn/named_files.h"

#include <set>

namespace panwright::pxn {

namespace {

constexpr std::size_t kLongest = 255;  // bytes of a name
constexpr std::size_t kMost = 10'000;

bool is_ascii_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

// "panel.png", but not "0.5", "1e3" or "{2 * size}".
bool looks_like_a_file(std::string_view name) {
  const std::size_t point = name.rfind('.');
  if (name.size() > kLongest || point == name.npos || point + 1 == name.size() ||
      name.size() - point > 8 || name.front() == '{')
    return false;
  for (const char c : name.substr(point + 1))
    if (!is_ascii_letter(c) && !(c >= '0' && c <= '9')) return false;
  return name.find('\n') == name.npos &&
         (is_ascii_letter(name[point + 1]) || is_ascii_letter(name.back()));
}

}  // namespace

void declare_named_files(const std::filesystem::path& path, std::string_view text,
                         FileUses& files) {
  const std::filesystem::path folder = path.parent_path();
  std::set<std::string_view> seen;
  const auto look_at = [&](std::string_view name) {
    const std::size_t first = name.find_first_not_of(" \t\r\n");
    if (first == name.npos) return;
    name = name.substr(first, name.find_last_not_of(" \t\r\n") + 1 - first);
    if (looks_like_a_file(name) && seen.size() < kMost && seen.insert(name).second)
      files.will_read(folder / name);
  };
  // what stands between quotes, and between '>' and '<'
  std::size_t at = 0;
  while ((at = text.find_first_of("\"'>", at)) != text.npos) {
    if (text[at] == '>') {
      const std::size_t to = text.find('<', at + 1);
      if (to == text.npos) break;
      if (to - at <= kLongest) look_at(text.substr(at + 1, to - at - 1));
      at = to;
      continue;
    }
    const std::string_view rest = text.substr(at + 1, kLongest + 1);
    const std::size_t length = rest.find(text[at]);
    if (length != rest.npos) {
      look_at(rest.substr(0, length));
      at += length + 1;
    }
    ++at;
  }
}

}  // namespace panwright::pxn
