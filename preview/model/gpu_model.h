// Arrays of a model on a context. Private to preview.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "pan/model.h"
#include "preview/context.h"
#include "preview/gl/gl_objects.h"
#include "preview/model/decals.h"
#include "preview/model/draw_list.h"
#include "preview/model/gpu_textures.h"
#include "preview/model/tangents.h"

namespace panwright::preview {

class GpuModel {
 public:
  // Uploads vertices, indices, materials and used textures, tangents for meshes with normal maps,
  // and decals.
  // Fails: E5003. Throws Cancelled: uploaded parts are freed with this.
  bool upload(const Context& context, const pan::Model& model, std::span<const DrawItem> list,
              const Families& brdf_models, DiagnosticLog& log, const Job& job);
  std::uint64_t bytes() const { return bytes_; }  // uploaded so far

  // Computes and uploads the triangles' normals, once. Fails: E5003.
  bool upload_triangle_normals(const pan::Model& model, DiagnosticLog& log);

  void bind_vertices(const pan::layout::Mesh& mesh, std::size_t mesh_index) const;
  void bind_maps(std::size_t item) const;
  void bind_one_material(std::uint32_t material) const;
  void bind_items() const;
  // Binds materials and items as textures, for look-ups in shading.
  void bind_materials() const;

  // Draws consecutive triangles of the mesh whose vertices are bound, in parts small enough for
  // prompt cancellation. False: cancelled.
  bool draw(const pan::layout::Mesh& mesh, std::size_t mesh_index, std::size_t instances,
            const Job& job, std::uint64_t first, std::uint64_t count) const;
  // The whole mesh in one draw: its triangles are numbered from its first.
  bool draw_whole(const pan::layout::Mesh& mesh, std::size_t mesh_index, std::size_t instances,
                  const Job& job) const;
  // The same with the normals of its triangles bound, in parts within the limit of buffer textures.
  bool draw_flat(const pan::layout::Mesh& mesh, std::size_t mesh_index, std::size_t instances,
                 const Job& job) const;

  std::span<const PlacedDecal> decals() const { return decals_; }  // from the lowest
  // Draws the triangles under a decal. Expects: the vertices of its mesh bound; bind_vertices()
  // again before any other draw.
  void draw_decal(std::size_t decal) const;

 private:
  // Mesh with vertices repeated for its tangents.
  struct Repeated {
    GlBuffer positions, normals, texcoords, colors, indices;
  };

  template <class T>
  GlBuffer uploaded(std::span<const T> values);
  bool upload_materials(const pan::Model& model, std::span<const DrawItem> list,
                        const Families& brdf_models, DiagnosticLog& log);
  bool upload_textures(const pan::Model& model, std::span<const DrawItem> list, DiagnosticLog& log,
                       const Job& job);
  void choose_samplers(const pan::Model& model, std::span<const DrawItem> list, const Job& job);
  bool upload_tangents(const pan::Model& model, std::span<const DrawItem> list, DiagnosticLog& log,
                       const Job& job);
  bool upload_decals(const pan::Model& model, std::span<const DrawItem> list, DiagnosticLog& log);
  const Repeated* own_vertices(std::size_t mesh_index) const;  // null: the model's
  Repeated repeated(const pan::MeshView& mesh, const Tangents& tangents);
  void draw_range(const pan::layout::Mesh& mesh, std::size_t mesh_index,
                  std::uint64_t first_triangle, std::uint64_t triangles,
                  std::size_t instances) const;

  // Texture of an item on a unit.
  struct Binding {
    GLuint unit = 0;
    std::uint32_t texture = 0;  // number in textures_
    GLuint sampler = 0;         // 0: the texture's own
  };

  const Context* context_ = nullptr;
  const GladGLContext* gl_ = nullptr;
  std::uint64_t bytes_ = 0;
  GlVertexArray vertex_array_;
  GlBuffer positions_, normals_, texcoords_, colors_, indices_;
  GlBuffer materials_, padded_materials_, items_;
  GlTexture materials_texture_, items_texture_;
  std::size_t material_stride_ = 0;  // bytes, of padded_materials_
  GpuTextures textures_;
  std::vector<std::vector<Binding>> bindings_;  // one per item
  GlSampler map_sampler_;                       // repeats
  GlSampler decal_sampler_;                     // clamps
  // by wraps and largest level
  std::map<std::tuple<GLint, GLint, int>, GlSampler> limited_samplers_;
  GlBuffer tangents_;
  std::vector<std::uint64_t> tangents_at_;         // bytes, one per mesh
  std::vector<std::optional<Repeated>> repeated_;  // one per mesh, if it has tangents
  std::vector<PlacedDecal> decals_;                // their indices are in decal_indices_
  struct DecalRange {
    std::uint64_t first = 0;  // bytes, in decal_indices_
    std::uint64_t count = 0;  // indices
    std::uint32_t texture = 0;
  };
  std::vector<DecalRange> decal_ranges_;
  GlBuffer decal_indices_;
  GlBuffer decal_blocks_;
  std::size_t decal_stride_ = 0;  // bytes, of decal_blocks_
  GlBuffer triangle_normals_;
  GlTexture triangle_normals_texture_;
  std::uint64_t flat_triangles_ = 0;                // of one part
  std::vector<std::uint64_t> triangle_normals_at_;  // bytes, one per mesh
};

}  // namespace panwright::preview
