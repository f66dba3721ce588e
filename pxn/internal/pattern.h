// Name patterns: '*' stands for any characters, '?' for one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace panwright::pxn {

// Whether a whole text fits a pattern. Cost: O(text · pattern) at worst.
bool matches(std::string_view pattern, std::string_view text);

// For each node of a scene whether a pattern, or one above it, names it. A pattern with '/' is held
// against the path below the node `top`, one without against the node's own name.
std::vector<char> matching_nodes(const scene::Scene& scene, std::uint32_t top,
                                 std::string_view pattern);

}  // namespace panwright::pxn
