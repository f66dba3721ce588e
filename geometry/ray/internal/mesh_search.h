// Ray search in the frame of one mesh. Private to geometry.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/job.h"
#include "base/math.h"
#include "geometry/mesh.h"
#include "geometry/ray/instances.h"

struct RTCSceneTy;
struct RTCBoundsFunctionArguments;

namespace panwright::geometry {

// Ray in progress among the instances, with the best hit so far.
struct SearchRay {
  Vec3 origin;     // world
  Vec3 direction;  // world, unit
  double min_distance = 0;
  double max_distance = 0;  // shrinks to the best hit
  HitFilter filter;
  bool found = false;
  InstanceHit best;
};

// A mesh and the tree over its triangles.
class MeshSearch {
 public:
  MeshSearch(std::vector<Vec3> positions, std::vector<Triangle> triangles);
  ~MeshSearch();
  MeshSearch(const MeshSearch&) = delete;
  MeshSearch& operator=(const MeshSearch&) = delete;

  // Builds the tree. Throws Cancelled: it may be built again then.
  void build(const Job& job = {});

  const std::vector<Vec3>& positions() const { return positions_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }
  Vec3 low() const { return low_; }  // of the triangles' corners
  Vec3 high() const { return high_; }
  bool empty() const { return !(radius_ > 0); }

  // Improves the ray's best hit by those of this mesh, or, for `any`, stops at the first.
  //
  //   origin     of the ray, in the mesh's frame
  //   direction  the ray's unit world direction, in the mesh's frame: any length
  //   asked      true: the ray's filter is called
  void search(SearchRay& ray, const Vec3& origin, const Vec3& direction, std::uint32_t instance,
              bool asked, bool any) const;

  // Triangles [first, first + count) within a slice of their bounds, `slice` of `slices` along the
  // longest side. Thin slanted triangles fill little of one box.
  struct Leaf {
    std::uint32_t first = 0;
    std::uint8_t count = 1;
    std::uint8_t slice = 0;
    std::uint8_t slices = 1;
    // note: a copy of their corners, to save rays a cache miss
    std::array<Triangle, 2> triangles{};
  };
  const Leaf& leaf(std::size_t index) const { return leaves_[index]; }

 private:
  static void bound(const RTCBoundsFunctionArguments* arguments);

  void list_leaves();
  std::uint8_t slices_of(const Leaf& leaf) const;

  std::vector<Vec3> positions_;
  std::vector<Triangle> triangles_;
  std::vector<Leaf> leaves_;
  Vec3 low_{0};
  Vec3 high_{0};
  Vec3 centre_{0};
  double radius_ = 0;     // of the ball about the bounds; 0: nothing to hit
  double to_search_ = 0;  // 1 / radius
  RTCSceneTy* scene_ = nullptr;
};

}  // namespace panwright::geometry
