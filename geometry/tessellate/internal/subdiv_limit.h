// Limit of a Catmull-Clark cage at any parameter. The only user of OpenSubdiv.
#pragma once

#include <memory>
#include <span>

#include "geometry/tessellate/internal/subdiv_cage.h"

namespace panwright::geometry::internal {

// Point of the limit, with its derivatives by the parameters of a patch or cell.
struct LimitPoint {
  Vec3 position{0};
  Vec3 du{0};
  Vec3 dv{0};
};

// Limit at a vertex, seen from one of its faces.
struct CornerLimit {
  Vec3 position{0};
  Vec3 normal{0};  // unit, of the surface between the sharp edges about that face; 0: none
};

// Limit surface, exact but for rounding. The cage is refined about its irregular vertices and
// semi-sharp edges until all requested points lie on regular patches, which are uniform bicubic
// B-splines. Irregular vertices have limits in closed form.
//
// Patches are the faces of four sides, and of each other face, one for each corner i: u runs from
// the corner towards the next one, v towards the one before, and (1, 1) is the face's centre. Of
// four-sided faces u runs along the first side.
class LimitSurface {
 public:
  //   positions  V, in place of the shape's own
  //   depth      levels of refinement, 1 to kMaxDepth; at least the largest finite sharpness
  //
  // Expects: no problem(shape). Cost: O(faces), and O(depth) about irregular vertices,
  // O(2^sharpness) about semi-sharp edges.
  LimitSurface(const Subdiv& shape, const Cage& cage, std::span<const Vec3> positions, int depth);
  ~LimitSurface();

  static constexpr int kMaxDepth = 10;

  // Evaluates a point. False within 2^-depth of irregular vertices, and only there.
  //
  // Expects: 0 ≤ u, v ≤ 1. Thread-safe.
  bool evaluate(std::uint32_t patch, double u, double v, LimitPoint& out) const;

  // Evaluates the limit of a corner of a face, or of the centre of a face that is not four-sided,
  // from its patch there. Expects: an irregular vertex.
  CornerLimit at_corner(std::uint32_t face, std::uint32_t corner) const;
  CornerLimit at_centre(std::uint32_t face, std::uint32_t corner) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::geometry::internal
