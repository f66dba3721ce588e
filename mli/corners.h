// Inner corners: where blankets of faces that look at each other share the room between them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/math.h"
#include "geometry/mesh.h"
#include "geometry/ray/box_tree.h"

namespace panwright::mli {

// Faces that wear blankets, each of an owner.
class Corners {
 public:
  // metres
  void add(const Vec3& a, const Vec3& b, const Vec3& c, std::uint32_t owner);
  void build();  // once all are there

  // Metres along a unit direction until a place on an owner's face is as near to another owner's
  // face as it has come; at most `most`. Where every blanket stays below, each keeps to what is
  // nearer to its own faces, so that none goes through another. 0 on an inner edge; outer edges are
  // never nearer. The same bits whatever faces are further than 2 · most from the place. Cost:
  // O(log faces + faces within 2 · most).
  double room(std::uint32_t owner, const Vec3& from, const Vec3& along, double most) const;

  // Whether a segment on an owner's face leads through another owner's face, its border included,
  // or ends there. tolerance: metres.
  bool crossed(std::uint32_t owner, const Vec3& a, const Vec3& b, double tolerance) const;

  // Adds to a key the other owners' faces that meet one of some boxes (metres), in order: around
  // places from which nothing further than a box is asked for, they are all that room() and
  // crossed() follow from. Returns whether there are any.
  bool add_near(std::uint32_t owner, std::span<const geometry::AxisBox> boxes,
                KeyHasher& key) const;

 private:
  struct Face {
    Vec3 a, b, c, normal;
    std::uint32_t owner;
    geometry::AxisBox box() const;
  };
  std::vector<Face> faces_;
  geometry::BoxTree tree_;
};

}  // namespace panwright::mli
