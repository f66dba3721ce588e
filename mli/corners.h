// Inner corners: blankets of faces that face each other share the space between them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/axis_box.h"
#include "base/bytes.h"
#include "base/math.h"
#include "geometry/mesh.h"
#include "geometry/ray/box_tree.h"

namespace panwright::mli {

// Faces with blankets, each of an owner.
class Corners {
 public:
  // metres
  void add(const Vec3& a, const Vec3& b, const Vec3& c, std::uint32_t owner);
  void build();  // after the last face

  // Returns the metres from a place on an owner's face along a unit direction, until another
  // owner's face is as near as the distance travelled; at most `most`. Blankets below it stay on
  // their own half of the space and never intersect. 0 on an inner edge; outer edges are never
  // nearer. Faces further than 2 · most from the place change no bit. Cost: O(log faces + faces
  // within 2 · most).
  double room(std::uint32_t owner, const Vec3& from, const Vec3& along, double most) const;

  // Returns true if a segment on an owner's face meets another owner's face, its border included.
  // tolerance: metres.
  bool crossed(std::uint32_t owner, const Vec3& a, const Vec3& b, double tolerance) const;

  // Adds to a key the other owners' faces that meet one of some boxes (metres), in order: all
  // inputs of room() and crossed() for places that need nothing beyond a box. Returns true if there
  // are any.
  bool add_near(std::uint32_t owner, std::span<const AxisBox> boxes, KeyHasher& key) const;

 private:
  struct Face {
    Vec3 a, b, c, normal;
    std::uint32_t owner;
    AxisBox box() const;
  };
  std::vector<Face> faces_;
  geometry::BoxTree tree_;
};

}  // namespace panwright::mli
