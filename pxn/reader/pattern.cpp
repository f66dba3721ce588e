#include "pxn/reader/pattern.h"

#include <fmt/core.h>

#include "base/text.h"

namespace panwright::pxn {

namespace {

constexpr std::size_t kMostNames = 6;  // in a message

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; }

std::size_t behind_character(std::string_view text, std::size_t at) {
  ++at;
  while (at < text.size() && continues_character(text[at])) ++at;
  return at;
}

}  // namespace

Pattern::Pattern(std::string_view text) {
  const auto plain = [&](char c) {
    parts_.push_back(static_cast<unsigned char>(c));
    has_slash_ = has_slash_ || c == '/';
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string_view left = text.substr(i + 1);
    if (text[i] == '*') {
      parts_.push_back(kAny);
    } else if (text[i] == '?') {
      parts_.push_back(kOne);
    } else if (text[i] == '\\' && !left.empty() &&
               std::string_view("*?\\").find(left[0]) != left.npos) {
      plain(left[0]);
      ++i;
    } else if (text[i] == '\\' && left.size() >= 3 && left[0] == 'x' && hex_digit(left[1]) >= 0 &&
               hex_digit(left[2]) >= 0) {
      plain(static_cast<char>(16 * hex_digit(left[1]) + hex_digit(left[2])));
      i += 3;
    } else {
      plain(text[i]);
    }
  }
}

bool Pattern::fits(std::string_view text) const {
  std::size_t p = 0, t = 0;
  // where the last star stands, and the text that it has taken so far ends
  std::size_t star = std::string_view::npos, taken = 0;
  while (t < text.size()) {
    if (p < parts_.size() && parts_[p] == kAny) {
      star = p++;
      taken = t;
    } else if (p < parts_.size() && parts_[p] == kOne) {
      ++p;
      t = behind_character(text, t);
    } else if (p < parts_.size() && parts_[p] == static_cast<unsigned char>(text[t])) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = taken = behind_character(text, taken);
    } else {
      return false;
    }
  }
  while (p < parts_.size() && parts_[p] == kAny) ++p;
  return p == parts_.size();
}

std::string pattern_of(std::string_view name) {
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool at_end = i == 0 || i + 1 == name.size();
    // U+FFFE and U+FFFF are no characters of XML
    const bool not_xml = c == '\xef' && name.substr(i + 1, 1) == "\xbf" && i + 2 < name.size() &&
                         (name[i + 2] == '\xbe' || name[i + 2] == '\xbf');
    const bool blank = c == ' ' && (at_end || name[i - 1] == ' ');
    if (not_xml) {
      for (int k = 0; k < 3; ++k)
        out += fmt::format("\\x{:02x}", static_cast<unsigned char>(name[i + k]));
      i += 2;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '{' || c == '}' || blank) {
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    } else {
      if (c == '*' || c == '?' || c == '\\') out += '\\';
      out += c;
    }
  }
  return out;
}

std::string near_names(std::string_view pattern, const std::set<std::string>& names) {
  std::string plain;
  for (const char c : pattern)
    if (c != '*' && c != '?') plain += c;
  // whole, to be copied
  const auto quoted = [](std::string_view name) { return "'" + pattern_of(name) + "'"; };
  const std::vector<std::string_view> all(names.begin(), names.end());
  if (const auto near = nearest_name(plain, all))
    return fmt::format("did you mean {}?", quoted(*near));
  std::string out;
  std::size_t count = 0;
  for (const std::string_view name : all) {
    if (name.empty()) continue;
    if (count++ == kMostNames)
      return "there are " + out +
             "…; 'panwright info --nodes' lists the nodes of a file, with "
             "their materials";
    out += (out.empty() ? "" : ", ") + quoted(name);
  }
  return out.empty() ? "none has a name" : "there are " + out;
}

std::vector<char> matching_nodes(const scene::Scene& scene, std::uint32_t top,
                                 const Pattern& pattern) {
  std::vector<char> out(scene.nodes.size());
  const bool by_path = pattern.has_slash();
  std::vector<std::string> paths(by_path ? scene.nodes.size() : 0);
  for (std::size_t i = top + 1; i < scene.nodes.size(); ++i) {
    const scene::Node& node = scene.nodes[i];
    const auto parent = static_cast<std::size_t>(node.parent);
    if (by_path) paths[i] = parent <= top ? node.name : paths[parent] + "/" + node.name;
    out[i] = static_cast<char>(out[parent] || pattern.fits(by_path ? paths[i] : node.name));
  }
  return out;
}

}  // namespace panwright::pxn
