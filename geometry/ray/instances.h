// Ray casting among instances of shared meshes, exact at any distance.
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
  bool front = true;           // hit from outside: counter-clockwise in the mesh's frame
};

// Filter of hits: all, or those accepted by `counts`. Called only for instances added with it, from
// any thread, not in the order of distance, perhaps repeatedly for one hit.
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
// A ray is transformed into each mesh's frame and moved next to the mesh, then tested in double,
// outlines included. So neither the distance of its origin nor other instances cost precision: a
// hit lies on its triangle to some 1e-15 of the mesh's size and along the ray to the rounding of
// the origin's coordinates. A ray that leads away from a triangle never hits it. No ray slips
// between triangles of one mesh that share an edge or a corner, by position. Edge-on triangles and
// those without area are not hit. At equal distances the lower instance, then the lower triangle
// wins.
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
  // Shares a mesh without rebuilding it. Expects: not null.
  std::uint32_t add_mesh(SearchMesh mesh);

  // Places a mesh; world_from_mesh may mirror, stretch and flatten. Returns 0, 1, 2…
  //
  //   asked    true: filters are called for its hits
  //   Expects  finite world positions, within ±1e100; before build()
  std::uint32_t add(std::uint32_t mesh, const Mat4& world_from_mesh, bool asked);

  // Expects: called once, after the last add(), before the first ray. Throws Cancelled: may be
  // called again then.
  void build(const Job& job = {});

  // Returns the nearest accepted hit within the ray's range, both ends included.
  // Expects: a unit direction.
  std::optional<InstanceHit> closest(const Ray& ray, const HitFilter& filter = {}) const;
  // The same for rays of one origin, as one by one; faster where their directions are similar.
  //
  //   hits  R, one for each ray
  void closest(std::span<const Ray> rays, std::span<std::optional<InstanceHit>> hits,
               const HitFilter& filter = {}) const;
  // Returns true if closest() has a hit, faster.
  bool any(const Ray& ray, const HitFilter& filter = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::geometry
