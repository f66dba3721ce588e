// Simplified meshes, for shadow maps with texels wider than their triangles. Private to preview.
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <span>
#include <tuple>

#include "base/stamp.h"
#include "geometry/mesh.h"
#include "pan/model.h"
#include "preview/gl/gl_objects.h"
#include "preview/model/draw_list.h"

namespace panwright::preview {

// A shape on a context: positions and triangles alone.
class CasterMesh {
 public:
  CasterMesh(const GladGLContext& gl, const geometry::Mesh& shape);

  std::size_t triangles() const { return triangles_; }
  void bind_vertices(const GladGLContext& gl) const;
  // Expects: bind_vertices().
  void draw(const GladGLContext& gl, std::size_t instances) const;

 private:
  std::size_t triangles_ = 0;
  GlVertexArray array_;
  GlBuffer positions_, indices_;
};

// Casters of targets, one mesh each, made on first use.
class CasterMeshes {
 public:
  // Returns all visible items but those with holes, in the model's frame; large meshes are
  // simplified. Valid until the next call of begin().
  //
  //   stamp, level  of the shapes and places of the items, and which are visible (target_states.h)
  //   tolerance     metres, by the simplifier's measure (geometry/mesh/simplify.h)
  // Cost: of each large mesh and factor of two of the tolerance about 1 µs a triangle, once; O(V)
  // of what is left for each stamp.
  const CasterMesh& find(const GladGLContext& gl, const std::shared_ptr<const pan::Model>& model,
                         std::span<const DrawItem> items, Stamp stamp, std::size_t level,
                         double tolerance);
  // Frees those not used lately.
  void begin();

 private:
  struct Simplified {
    std::weak_ptr<const pan::Model> owner;
    geometry::Mesh mesh;
  };
  struct Target {
    Stamp stamp = 0;
    std::size_t level = 0;
    int step = 0;
    CasterMesh mesh;
  };
  const geometry::Mesh* simplified(const std::shared_ptr<const pan::Model>& model,
                                   std::uint32_t mesh, int step);

  std::map<std::tuple<const pan::Model*, std::uint32_t, int>, Simplified> simplified_;
  std::list<Target> targets_;  // by use, the last one first
};

}  // namespace panwright::preview
