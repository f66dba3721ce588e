// Ray casting on triangle meshes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "geometry/mesh.h"

namespace panwright::geometry {

struct Ray {
  Vec3 origin;
  Vec3 direction;                    // any non-zero length
  double min_distance = 0;           // metres along the unit direction
  double max_distance = 1e30;        // metres
};

struct RayHit {
  double distance;         // metres from the ray's origin, recomputed in double
  std::uint32_t instance;  // as returned by add()
  std::uint32_t triangle;  // in the mesh
  Vec2 barycentric;        // weights of the second and third corner
  Vec3 normal;             // geometric, unit, world, on the counter-clockwise side
};

// A set of placed meshes that answers rays. The search is single precision about the set's centre
// (with watertight traversal); the hit that it finds is recomputed in double.
class RayCaster {
 public:
  RayCaster();
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  // Adds a mesh; world_from_mesh may mirror. Returns 0, 1, 2…
  std::uint32_t add(const Mesh& mesh, const Mat4& world_from_mesh);

  // Builds the search tree. Expects: called once, after the last add(), before the first ray.
  void build();

  std::optional<RayHit> closest(const Ray& ray) const;
  bool any(const Ray& ray) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::geometry
