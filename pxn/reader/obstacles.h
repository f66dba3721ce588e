// Obstacles of blankets: the other parts of a scene.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/axis_box.h"
#include "base/bytes.h"
#include "base/job.h"
#include "geometry/ray/box_tree.h"
#include "geometry/ray/instances.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Smallest useful error of facets, relative to a shape's size.
inline constexpr double kFinest = 1e-5;

// Tessellates a shape to `error` in its own frame; null on failure.
geometry::MeshShape mesh_of(const geometry::Shape& shape, double error);

class Obstacles {
 public:
  // Collects the instances of a scene within `reach` (metres) of the boxes around some of them, at
  // rest. Curved shapes are approximated to a fiftieth of the reach. Throws Cancelled.
  Obstacles(const scene::Scene& scene, std::span<const std::int32_t> wrapped, double reach,
            const Job& job);

  // Builds the search trees, once, before room(), which is then thread-safe. Throws Cancelled.
  void build(const Job& job);

  // Returns the free distance from a place along a unit direction, in the world, metres, at most
  // `most`.
  //
  //   of     the instance of the place: it is its own obstacle only if it is a mesh
  //   least  metres: nearer hits count as the surface itself
  double room(std::int32_t of, const Vec3& from, const Vec3& along, double least,
              double most) const;

  // Adds to a key the obstacles in some boxes in the world: all inputs of room() for places that
  // query nothing beyond a box. Returns true if there are any. Cost: O(obstacles · boxes) at most.
  bool add_near(std::int32_t of, std::span<const AxisBox> boxes, KeyHasher& key) const;

 private:
  // Data of add_near(), by instances of the caster.
  struct Standing {
    Hash128 mesh;
    Mat4 world;
    AxisBox box;
  };

  geometry::InstanceCaster caster_;
  bool built_ = false;
  std::vector<Standing> standing_;
  std::vector<std::int32_t> instances_;  // of the scene, by those of the caster
  std::vector<char> exact_;              // the same: no mesh
};

}  // namespace panwright::pxn
