// What lies in the way of blankets: the other parts of a scene.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/job.h"
#include "geometry/ray/box_tree.h"
#include "geometry/ray/instances.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Of a shape's size: no facets need to be nearer to it.
inline constexpr double kFinest = 1e-5;

// A shape as triangles, good to `error` in its own frame; null where it cannot be made.
geometry::MeshShape mesh_of(const geometry::Shape& shape, double error);

class Obstacles {
 public:
  // Of the instances of a scene those that come within `reach` (metres) of the boxes around some of
  // them, as they stand at rest. Curved shapes are as good as a fiftieth of the reach.
  // Throws Cancelled.
  Obstacles(const scene::Scene& scene, std::span<const std::int32_t> wrapped, double reach,
            const Job& job);

  // To be called before room(), which may be called from any thread then. Once is enough. Throws
  // Cancelled.
  void build(const Job& job);

  // Metres that are free from a place along a unit direction, in the world, at most `most`.
  //
  //   of     the instance that the place lies on: it is in its own way only where it is a mesh
  //   least  metres: what is nearer counts as the surface itself
  double room(std::int32_t of, const Vec3& from, const Vec3& along, double least,
              double most) const;

  // Adds to a key what comes into one of some boxes in the world: from places from which nothing
  // further than a box is asked for, it is all that room() follows from. Returns whether there is
  // anything. Cost: O(obstacles · boxes) at most.
  bool add_near(std::int32_t of, std::span<const geometry::AxisBox> boxes, KeyHasher& key) const;

 private:
  // What add_near() looks at, by instances of the caster.
  struct Standing {
    Hash128 mesh;
    Mat4 world;
    geometry::AxisBox box;
  };

  geometry::InstanceCaster caster_;
  bool built_ = false;
  std::vector<Standing> standing_;
  std::vector<std::int32_t> instances_;  // of the scene, by those of the caster
  std::vector<char> exact_;              // the same: no mesh
};

}  // namespace panwright::pxn
