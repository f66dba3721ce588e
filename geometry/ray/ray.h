// Ray casting on triangle meshes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "geometry/mesh.h"

namespace panwright::geometry {

struct Ray {
  Vec3 origin{0};
  Vec3 direction{0};           // any non-zero length
  double min_distance = 0;     // metres along the unit direction
  double max_distance = 1e30;  // metres
};

struct RayHit {
  double distance;         // metres from the ray's origin, recomputed in double
  std::uint32_t instance;  // as returned by add()
  std::uint32_t triangle;  // in the mesh
  Vec2 barycentric{0};     // weights of the second and third corner, in the triangle
  Vec3 normal{0};  // geometric, unit, world, outwards (counter-clockwise in the mesh's frame)
};

// A set of placed meshes that answers rays.
//
// The search for boxes is single precision about the set's centre; triangles are decided in double,
// and a ray never slips between triangles of a mesh that share an edge or a corner, by their
// places: outlines count as inside, and their sides are exact (internal/ray_triangle.h). Both sides
// of a triangle count; triangles that are seen edge on, or have no area, are not hit. At equal
// distances the lower instance, then the lower triangle is given.
//
// Cost: about 80 bytes a triangle; O(log T) a ray, expected. Embree 3 (Wald et al., "Embree: a
// kernel framework for efficient CPU ray tracing", 2014).
class RayCaster {
 public:
  RayCaster();
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  // Adds a mesh; world_from_mesh may mirror. Returns 0, 1, 2…
  // Expects: indices in range, world positions finite and within ±1e100; before build().
  std::uint32_t add(const Mesh& mesh, const Mat4& world_from_mesh);

  // Builds the search tree. Expects: called once, after the last add(), before the first ray.
  void build();

  // The nearest hit within the ray's range, both ends included.
  std::optional<RayHit> closest(const Ray& ray) const;
  // Whether closest() has a hit, sooner.
  bool any(const Ray& ray) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::geometry
