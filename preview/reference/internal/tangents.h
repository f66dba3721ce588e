// Where u grows along a mesh, for normal maps and for surfaces that are not isotropic. Private to
// preview/reference.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/math.h"
#include "pan/model.h"

namespace panwright::preview::reference {

// The tangents at the corners of a mesh's triangles.
class TangentField {
 public:
  // A corner takes the mean of the directions of u, each in the plane of the corner's normal and
  // weighted by its triangle's angle there, over all triangles that have a corner of this place,
  // normal and texel, whole repeats of the texture apart, and show the texture the same way round.
  // Triangles without an area in the texture count nowhere; where all are such, any direction
  // perpendicular to the normal.
  //
  // Expects: texture coordinates. Cost: O(T).
  explicit TangentField(const pan::MeshView& mesh);

  // tangent: interpolated, any length. handed: 1, or −1 where the texture is mirrored.
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
