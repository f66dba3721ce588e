// Model ready for rays: meshes with search trees, and their holes. The part independent of a world.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/job.h"
#include "geometry/ray/instances.h"
#include "pan/model.h"
#include "terrain/ground.h"
#include "trace/mesh_point.h"
#include "trace/placement.h"
#include "trace/texture.h"
#include "world/world.h"

namespace panwright::trace {

// Placement of a part in its model's frame.
struct Placement {
  Affine model_from_mesh;  // of float positions, the mesh's origin included
  Mat3 normals{1};         // maps outward normals to outward normals of any length
};

// It never changes; worlds and threads share it.
class Model {
 public:
  // Instance with its own mesh, or with that of a level of detail.
  struct Part {
    pan::MeshView mesh;
    std::uint32_t mesh_index = 0;
    std::uint32_t instance = 0;
    std::uint32_t node = 0;
    Vec3 origin{0};          // metres, of the mesh
    Vec3 low{0}, high{0};    // metres, bounds of the float positions
    bool closed = false;     // its inside is invisible: closed, and without holes
    bool has_holes = false;  // a texture cuts some
    double detail = 0;       // mesh metres: smallest pixel footprint for this level; 0: the finest
    std::int32_t cutout = -1;  // texture whose alpha cuts holes
    double threshold = 0;      // alpha below it: a hole
    Vec2 repeat{1};            // of the texture coordinates, for the cutout
  };

  // levels: makes trees of the levels of detail too. ground: has the terrain of the file, if any.
  //
  // Expects: checked. Throws Cancelled. Cost: O(T log T), about 150 bytes a triangle; textures are
  // read in place.
  Model(world::ModelPtr model, bool levels, bool ground, const Job& job);
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  const world::ModelPtr& model() const { return model_; }
  // The instances, in the model's order; then, with levels, those.
  std::span<const Part> parts() const { return parts_; }
  // Those of an instance's levels, ascending by detail.
  std::span<const Part> levels(std::uint32_t instance) const;
  std::span<const Texture> textures() const { return textures_; }  // the model's
  // Returns the search mesh of a placed mesh; null for others.
  const geometry::SearchMesh& search_mesh(std::uint32_t mesh) const { return meshes_[mesh]; }
  const terrain::Ground* ground() const { return ground_.get(); }  // null: none
  Placement placement(std::uint32_t part, const PlacedNodes& nodes) const;

  // Returns false in a hole.
  bool is_there(std::uint32_t part, std::uint32_t triangle, const Vec2& barycentric) const;

 private:
  void add_part(std::uint32_t instance, std::uint32_t mesh, std::uint32_t material, double detail);
  void add_meshes(const Job& job);

  world::ModelPtr model_;
  std::vector<Texture> textures_;
  std::vector<Part> parts_;
  std::vector<geometry::SearchMesh> meshes_;  // one per mesh
  std::unique_ptr<const terrain::Ground> ground_;
};

}  // namespace panwright::trace
