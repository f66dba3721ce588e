// Search for the nearest surface of placed models to points. Private to instruments.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "base/job.h"
#include "geometry/ray/box_tree.h"
#include "trace/scene.h"

namespace panwright::instruments {

struct NearestPoint {
  double squared = 0;           // m², of the distance
  Vec3 in_model{0};             // metres, on the triangle
  std::uint32_t target = 0;     // index in the scene
  std::uint32_t part = 0;       // of its trace::Model; trace::Hit::kGround: its terrain
  std::uint32_t triangle = 0;   // of the part's mesh
  terrain::GroundPoint ground;  // of terrain
};

// Trees of points over the meshes of traced models, and over the placed parts of targets; the
// terrain of targets.
class NearestSearch {
 public:
  // Builds what is missing. Expects: the scene outlives its use. Throws Cancelled.
  void update(const trace::Scene& scene, const Job& job);
  // Returns the nearest point of all targets; none: nothing is visible.
  std::optional<NearestPoint> nearest(const Vec3& world_point) const;

 private:
  struct MeshTrees {
    std::shared_ptr<const trace::Model> model;
    std::vector<std::unique_ptr<geometry::BoxTree>> trees;  // one per mesh; null: not placed
  };
  struct Parts {
    std::shared_ptr<const trace::Target> target;
    std::shared_ptr<const MeshTrees> meshes;
    geometry::BoxTree tree;  // of its visible parts, model axes
    struct Part {
      Mat3 mesh_from{1};    // inverse of the placement's linear part
      double smallest = 0;  // stretch of the placement; 0: flat, without an inverse
    };
    std::vector<Part> parts;
  };
  std::shared_ptr<const MeshTrees> meshes_of(const std::shared_ptr<const trace::Model>& model,
                                             const Job& job);
  void improve(const Parts& parts, std::uint32_t target, const Vec3& point,
               std::optional<NearestPoint>& best, double& limit) const;

  const trace::Scene* scene_ = nullptr;
  std::unordered_map<const trace::Model*, std::shared_ptr<const MeshTrees>> meshes_;
  std::unordered_map<const trace::Target*, std::shared_ptr<const Parts>> states_;
  std::vector<std::shared_ptr<const Parts>> targets_;  // one per target; null: hidden
};

}  // namespace panwright::instruments
