// Name patterns: '*' stands for any characters, '?' for one; '\' makes a '*', '?' or '\' behind it
// plain, and "\xHH" is the byte of these two hexadecimal digits.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace panwright::pxn {

class Pattern {
 public:
  // text: UTF-8. Every text is a pattern: a '\' before anything else is itself.
  explicit Pattern(std::string_view text);

  // Returns true if a whole text matches. Cost: O(text · pattern) at worst.
  bool fits(std::string_view text) const;

  bool has_slash() const { return has_slash_; }

 private:
  static constexpr std::int16_t kAny = -1, kOne = -2;
  std::vector<std::int16_t> parts_;  // bytes, kAny, kOne
  bool has_slash_ = false;
};

// Returns the pattern that matches only this name and fits into an attribute of a pxn text,
// unescaped as XML.
std::string pattern_of(std::string_view name);

// Returns a hint for a pattern that matches none of some names: the nearest, or the first six.
std::string near_names(std::string_view pattern, const std::set<std::string>& names);

// Marks the nodes of a scene matched by a pattern, themselves or by an ancestor. A pattern with '/'
// is matched against the path below the node `top`, one without against the node's own name.
std::vector<char> matching_nodes(const scene::Scene& scene, std::uint32_t top,
                                 const Pattern& pattern);

}  // namespace panwright::pxn
