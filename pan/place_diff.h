// Differences between the surfaces of two models, by place.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pan/model.h"

namespace panwright::pan {

// Triangles of one instance without a counterpart in the other model.
struct UnmatchedPart {
  std::string where;  // "mesh 'hull' at node 'root/body'"
  bool in_a = false;
  std::uint64_t unmatched = 0;
  std::uint64_t triangles = 0;  // of the instance
};

struct PlaceDifferences {
  double tolerance = 0;  // metres
  double largest = 0;    // metres: largest distance of corresponding corners
  std::uint64_t triangles_a = 0, triangles_b = 0;
  std::vector<UnmatchedPart> parts;  // first those of a

  bool same() const { return parts.empty(); }
};

// Compares the triangles of two models in the world, joints at their initial values: whatever the
// tree, names, sharing and order. Two triangles correspond if each corner has one of the other
// within the tolerance, in the same sense of rotation; each has one counterpart at most.
//
//   tolerance  metres; 0: 1e-6 of the larger model's diagonal
//
// Expects: both checked(). Cost: O(triangles), 80 bytes each.
PlaceDifferences diff_by_place(const Model& a, const Model& b, double tolerance = 0);

}  // namespace panwright::pan
