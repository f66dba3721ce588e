// Tangents of a mesh along u, for normal maps and anisotropic surfaces. Private to
// preview/reference.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/math.h"
#include "pan/model.h"

namespace panwright::preview::reference {

// Tangents at the corners of a mesh's triangles.
class TangentField {
 public:
  // Computes the tangents. A corner takes the mean of the directions of u, each in the plane of the
  // corner's normal and weighted by its triangle's angle there. The mean is over all triangles with
  // a corner of this place, normal and texel (whole repeats apart), and the same orientation of the
  // texture. Triangles without area in the texture are ignored; if all are such, any direction
  // perpendicular to the normal.
  //
  // Expects: texture coordinates. Cost: O(T).
  explicit TangentField(const pan::MeshView& mesh);

  // tangent: interpolated, any length. handed: 1, or −1 if the texture is mirrored.
  struct At {
    Vec3 tangent{0};
    double handed = 1;
  };
  At operator()(std::uint32_t triangle, const Vec3& weight) const;

 private:
  std::vector<Vec3> tangents_;                         // unit
  std::vector<std::array<std::uint32_t, 3>> corners_;  // T; into tangents_
  std::vector<std::int8_t> handed_;                    // T; 1 or −1
};

}  // namespace panwright::preview::reference
