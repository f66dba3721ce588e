// Ray casting among placements of shared meshes, exact at any distance.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/job.h"
#include "geometry/mesh.h"
#include "geometry/ray/ray.h"

namespace panwright::geometry {

struct InstanceHit {
  double distance = 0;         // metres from the ray's origin
  std::uint32_t instance = 0;  // as returned by add()
  std::uint32_t triangle = 0;  // in the mesh
  Vec2 barycentric{0};         // weights of the second and third corner, in the triangle
  bool front = true;           // its outside is seen: counter-clockwise in the mesh's frame
};

// Which hits count: all, or those that `counts` accepts. It is called for instances added with it
// only, from any thread, not in the order of distance, and maybe more than once for one hit.
struct HitFilter {
  bool (*counts)(const void* data, const InstanceHit& hit) = nullptr;
  const void* data = nullptr;
};

class MeshSearch;
// A mesh with its search tree, for any number of casters. It never changes.
using SearchMesh = std::shared_ptr<const MeshSearch>;

// Builds a tree over a mesh.
// Expects: indices in range; positions finite and within ±1e100. Cost: about 80 bytes a triangle.
SearchMesh search_mesh(std::vector<Vec3> positions, std::vector<Triangle> triangles,
                       const Job& job = {});

// Meshes that are stored once and placed many times.
//
// A ray goes into each mesh's own frame in double and is moved next to the mesh; there it is
// decided in double, outlines inside. So neither the distance of a ray's origin nor other instances
// costs precision: a hit lies on its triangle to some 1e-15 of the mesh's size and along the ray to
// the rounding of the origin's coordinates. A ray that starts on one side of a triangle and leads
// away from it never hits it. No ray slips between triangles of one mesh that share an edge or a
// corner, by position. Triangles that are seen edge on, or have no area, are not hit. At equal
// distances the lower instance, then the lower triangle is given.
//
// Cost: about 80 bytes a triangle of a mesh and 400 an instance; O(log instances + log T) a ray,
// expected. Embree 3 within a mesh; among them a tree of boxes in double.
class InstanceCaster {
 public:
  InstanceCaster();
  ~InstanceCaster();
  InstanceCaster(InstanceCaster&&) noexcept;
  InstanceCaster& operator=(InstanceCaster&&) noexcept;

  // Copies a mesh. Returns 0, 1, 2…
  // Expects: indices in range; positions finite and within ±1e100.
  std::uint32_t add_mesh(std::span<const Vec3> positions, std::span<const Triangle> triangles);
  // Shares a mesh, which is not built again. Expects: not null.
  std::uint32_t add_mesh(SearchMesh mesh);

  // Places a mesh; world_from_mesh may mirror, stretch and flatten. Returns 0, 1, 2…
  //
  //   asked    whether filters are called for its hits
  //   Expects  finite world positions, within ±1e100; before build()
  std::uint32_t add(std::uint32_t mesh, const Mat4& world_from_mesh, bool asked);

  // Expects: called once, after the last add(), before the first ray. Throws Cancelled: may be
  // called again then.
  void build(const Job& job = {});

  // The nearest hit that counts within the ray's range, both ends included.
  // Expects: a unit direction.
  std::optional<InstanceHit> closest(const Ray& ray, const HitFilter& filter = {}) const;
  // Whether closest() has a hit, sooner.
  bool any(const Ray& ray, const HitFilter& filter = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::geometry
