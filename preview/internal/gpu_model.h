// A model's arrays on a context. Private to preview.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/diagnostic.h"
#include "pan/model.h"
#include "preview/context.h"
#include "preview/internal/draw_list.h"
#include "preview/internal/gl_objects.h"

namespace panwright::preview {

class GpuModel {
 public:
  // Uploads vertices, indices, materials and the textures that are used.
  // Fails: E5003.
  bool upload(const Context& context, const pan::Model& model, std::span<const DrawItem> list,
              DiagnosticLog& log);

  // Computes and uploads the triangles' normals, once. Fails: E5003.
  bool upload_triangle_normals(const pan::Model& model, DiagnosticLog& log);

  void bind_vertices(const pan::layout::Mesh& mesh) const;
  void bind_texture(std::int32_t texture) const;
  void bind_one_material(std::uint32_t material) const;
  // Materials and items as textures, for shading that looks them up.
  void bind_materials() const;

  // Draws the whole mesh whose vertices are bound.
  void draw(const pan::layout::Mesh& mesh) const;
  // The same with the normals of its triangles bound, in parts that the context's buffer textures
  // can hold.
  void draw_flat(const pan::layout::Mesh& mesh, std::size_t mesh_index) const;

 private:
  bool upload_materials(const pan::Model& model, std::span<const DrawItem> list,
                        DiagnosticLog& log);
  bool upload_textures(const pan::Model& model, std::span<const DrawItem> list, DiagnosticLog& log);
  void draw_range(const pan::layout::Mesh& mesh, std::uint64_t first_triangle,
                  std::uint64_t triangles) const;

  const Context* context_ = nullptr;
  const GladGLContext* gl_ = nullptr;
  GlVertexArray vertex_array_;
  GlBuffer positions_, normals_, texcoords_, colours_, indices_;
  GlBuffer materials_, padded_materials_, items_;
  GlTexture materials_texture_, items_texture_;
  std::size_t material_stride_ = 0;  // bytes, of padded_materials_
  std::vector<GlTexture> textures_;  // one for each of the model's; empty where unused
  GlBuffer triangle_normals_;
  GlTexture triangle_normals_texture_;
  std::uint64_t flat_triangles_ = 0;                // of one part
  std::vector<std::uint64_t> triangle_normals_at_;  // bytes, one for each mesh
};

}  // namespace panwright::preview
