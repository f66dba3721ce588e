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

  // Whether a whole text fits. Cost: O(text · pattern) at worst.
  bool fits(std::string_view text) const;

  bool has_slash() const { return has_slash_; }

 private:
  static constexpr std::int16_t kAny = -1, kOne = -2;
  std::vector<std::int16_t> parts_;  // bytes, kAny, kOne
  bool has_slash_ = false;
};

// The pattern that fits this name alone and that an attribute of a pxn text can hold, unescaped as
// XML.
std::string pattern_of(std::string_view name);

// What to say of a pattern that fits none of some names: the nearest, or the first six.
std::string near_names(std::string_view pattern, const std::set<std::string>& names);

// For each node of a scene whether a pattern, or one above it, names it. A pattern with '/' is held
// against the path below the node `top`, one without against the node's own name.
std::vector<char> matching_nodes(const scene::Scene& scene, std::uint32_t top,
                                 const Pattern& pattern);

}  // namespace panwright::pxn
