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
  void bind_material(std::uint32_t material) const;
  void bind_texture(std::int32_t texture) const;

  // Draws the whole mesh whose vertices are bound.
  void draw(const pan::layout::Mesh& mesh) const;
  // The same with the normals of its triangles bound, in as many parts as the context's storage
  // blocks ask for.
  void draw_flat(const pan::layout::Mesh& mesh, std::size_t mesh_index) const;

 private:
  bool upload_textures(const pan::Model& model, std::span<const DrawItem> list, DiagnosticLog& log);
  void draw_range(const pan::layout::Mesh& mesh, std::uint64_t first_triangle,
                  std::uint64_t triangles) const;

  const Context* context_ = nullptr;
  const GladGLContext* gl_ = nullptr;
  GlVertexArray vertex_array_;
  GlBuffer positions_, normals_, texcoords_, colours_, indices_;
  GlBuffer materials_;
  std::size_t material_stride_ = 0;  // bytes
  std::vector<GlTexture> textures_;  // one for each of the model's; empty where unused
  GlBuffer triangle_normals_;
  std::vector<std::uint64_t> triangle_normals_at_;  // bytes, one for each mesh
};

}  // namespace panwright::preview
