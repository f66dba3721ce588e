#include "preview/internal/gpu_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "base/text.h"
#include "preview/internal/programs.h"
#include "preview/internal/texture_levels.h"

namespace panwright::preview {
namespace {

namespace layout = pan::layout;

// float texels up to this many bytes in all, half floats beyond
constexpr std::uint64_t kFloatTextureBytes = 1ull << 30;

// OpenGL counts the indices of a draw in 31 bits
constexpr std::uint64_t kMeshTriangles = 0x7fffffff / 3;

template <class T>
GlBuffer uploaded(const GladGLContext& gl, std::span<const T> values) {
  return make_buffer(gl, values.data(), values.size_bytes());
}

std::uint64_t rounded_up(std::uint64_t value, std::uint64_t step) {
  return (value + step - 1) / step * step;
}

std::uint64_t integer(const GladGLContext& gl, GLenum name) {
  GLint value = 1;
  gl.GetIntegerv(name, &value);
  return static_cast<std::uint64_t>(std::max(value, 1));
}

// whether everything since the last call fitted
bool fits(const GladGLContext& gl, const char* what, DiagnosticLog& log) {
  bool good = true;
  for (GLenum error = gl.GetError(); error != GL_NO_ERROR; error = gl.GetError()) good = false;
  if (!good)
    log.report_file(Code::E5003, {},
                    fmt::format("the context has no memory for the model's {}", what));
  return good;
}

}  // namespace

bool GpuModel::upload(const Context& context, const pan::Model& model,
                      std::span<const DrawItem> list, DiagnosticLog& log) {
  context_ = &context;
  gl_ = &context.gl();
  const GladGLContext& gl = *gl_;
  for (std::size_t i = 0; i < model.meshes().size(); ++i)
    if (model.meshes()[i].triangle_count > kMeshTriangles) {
      log.report_file(
          Code::E5003, model.name(),
          fmt::format("mesh '{}' has {} triangles; one draw takes {}", model.mesh_name(i),
                      model.meshes()[i].triangle_count, kMeshTriangles));
      return false;
    }
  positions_ = uploaded(gl, model.positions());
  normals_ = uploaded(gl, model.normals());
  texcoords_ = uploaded(gl, model.texcoords());
  colours_ = uploaded(gl, model.colours());
  indices_ = uploaded(gl, model.index_bytes());

  vertex_array_ = make_vertex_array(gl);
  const GLuint array = vertex_array_.id();
  const auto attribute = [&](GLuint index, GLint components) {
    gl.EnableVertexArrayAttrib(array, index);
    gl.VertexArrayAttribFormat(array, index, components, GL_FLOAT, GL_FALSE, 0);
    gl.VertexArrayAttribBinding(array, index, index);
  };
  attribute(0, 3);
  attribute(1, 3);
  attribute(2, 2);
  attribute(3, 3);
  gl.VertexArrayElementBuffer(array, indices_.id());
  return fits(gl, "vertices", log) && upload_materials(model, list, log) &&
         upload_textures(model, list, log);
}

bool GpuModel::upload_materials(const pan::Model& model, std::span<const DrawItem> list,
                                DiagnosticLog& log) {
  const GladGLContext& gl = *gl_;
  const std::uint64_t texels = integer(gl, GL_MAX_TEXTURE_BUFFER_SIZE);
  const std::uint64_t rows = sizeof(layout::Material) / (4 * sizeof(float));
  // note: items are told apart by floats, which count exactly to 2^24
  const std::uint64_t most_items = std::min<std::uint64_t>(texels, (1u << 24) - 1);
  if (model.materials().size() > texels / rows || list.size() > most_items) {
    log.report_file(
        Code::E5003, model.name(),
        fmt::format("{} and {}; this context takes {} and {}", counted(list.size(), "instance"),
                    counted(model.materials().size(), "material"), most_items, texels / rows));
    return false;
  }
  materials_ = uploaded(gl, model.materials());
  materials_texture_ = make_buffer_texture(gl);
  gl.TextureBuffer(materials_texture_.id(), GL_RGBA32F, materials_.id());

  std::vector<std::uint32_t> items;
  for (const DrawItem& item : list) {
    items.push_back(item.material);
    items.push_back(law_pair(item.variant));
  }
  items_ = uploaded(gl, std::span<const std::uint32_t>(items));
  items_texture_ = make_buffer_texture(gl);
  gl.TextureBuffer(items_texture_.id(), GL_RG32UI, items_.id());

  material_stride_ =
      rounded_up(sizeof(layout::Material), integer(gl, GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT));
  std::vector<std::byte> records(material_stride_ * model.materials().size());
  for (std::size_t i = 0; i < model.materials().size(); ++i)
    std::memcpy(records.data() + i * material_stride_, &model.materials()[i],
                sizeof(layout::Material));
  padded_materials_ = make_buffer(gl, records.data(), records.size());
  return fits(gl, "materials", log);
}

bool GpuModel::upload_textures(const pan::Model& model, std::span<const DrawItem> list,
                               DiagnosticLog& log) {
  const GladGLContext& gl = *gl_;
  std::vector<bool> used(model.textures().size());
  for (const DrawItem& item : list)
    if (item.texture >= 0) used[static_cast<std::size_t>(item.texture)] = true;
  std::uint64_t bytes = 0;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) bytes += 4 * model.textures()[i].bytes;
  const GLenum format = bytes <= kFloatTextureBytes ? GL_RGBA32F : GL_RGBA16F;
  textures_.resize(used.size());
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    const layout::Texture& texture = model.textures()[i];
    if (std::max(texture.width, texture.height) > context_->limits().texture_side) {
      log.report_file(Code::E5003, model.name(),
                      fmt::format("texture '{}' is {} by {} texels; this context takes {} a side",
                                  model.texture_name(i), texture.width, texture.height,
                                  context_->limits().texture_side));
      return false;
    }
    const std::vector<TextureLevel> levels =
        texture_levels(model.texels(i), texture.width, texture.height,
                       (texture.flags & layout::kTextureLinear) != 0);
    GlTexture object =
        make_texture_2d(gl, static_cast<GLsizei>(levels.size()), format,
                        static_cast<GLsizei>(texture.width), static_cast<GLsizei>(texture.height));
    for (std::size_t level = 0; level < levels.size(); ++level)
      gl.TextureSubImage2D(
          object.id(), static_cast<GLint>(level), 0, 0, static_cast<GLsizei>(levels[level].width),
          static_cast<GLsizei>(levels[level].height), GL_RGBA, GL_FLOAT, levels[level].rgba.data());
    gl.TextureParameteri(object.id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    gl.TextureParameteri(object.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.TextureParameteri(object.id(), GL_TEXTURE_WRAP_S, GL_REPEAT);
    gl.TextureParameteri(object.id(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    textures_[i] = std::move(object);
    if (!fits(gl, "textures", log)) return false;
  }
  return true;
}

bool GpuModel::upload_triangle_normals(const pan::Model& model, DiagnosticLog& log) {
  if (triangle_normals_) return true;
  // parts begin where the context lets a buffer texture begin: a part of 2^k triangles is a
  // multiple of any power of two up to 4·2^k bytes
  const std::uint64_t alignment = integer(*gl_, GL_TEXTURE_BUFFER_OFFSET_ALIGNMENT);
  flat_triangles_ = std::uint64_t{1} << 21;
  while (flat_triangles_ > integer(*gl_, GL_MAX_TEXTURE_BUFFER_SIZE)) flat_triangles_ /= 2;
  triangle_normals_texture_ = make_buffer_texture(*gl_);
  std::uint64_t bytes = 0;
  for (const layout::Mesh& mesh : model.meshes()) {
    triangle_normals_at_.push_back(bytes);
    bytes = rounded_up(bytes + std::uint64_t{mesh.triangle_count} * 3 * sizeof(float), alignment);
  }
  triangle_normals_ = make_stream_buffer(*gl_);
  gl_->NamedBufferData(triangle_normals_.id(),
                       static_cast<GLsizeiptr>(std::max<std::uint64_t>(bytes, 16)), nullptr,
                       GL_STATIC_DRAW);
  if (!fits(*gl_, "triangle normals", log)) {
    triangle_normals_ = {};
    triangle_normals_at_.clear();
    return false;
  }
  for (std::size_t i = 0; i < model.meshes().size(); ++i) {
    const std::vector<float> normals = triangle_normals(model.mesh(i));
    gl_->NamedBufferSubData(triangle_normals_.id(), static_cast<GLintptr>(triangle_normals_at_[i]),
                            static_cast<GLsizeiptr>(normals.size() * sizeof(float)),
                            normals.data());
  }
  return true;
}

void GpuModel::bind_vertices(const layout::Mesh& mesh) const {
  const GladGLContext& gl = *gl_;
  const GLuint array = vertex_array_.id();
  const auto bind = [&](GLuint index, const GlBuffer& buffer, std::uint64_t first, GLsizei stride) {
    gl.VertexArrayVertexBuffer(array, index, buffer.id(),
                               static_cast<GLintptr>(first * static_cast<std::uint64_t>(stride)),
                               stride);
  };
  gl.BindVertexArray(array);
  bind(0, positions_, mesh.first_vertex, sizeof(layout::Float3));
  bind(1, normals_, mesh.first_vertex, sizeof(layout::Float3));
  // note: meshes without them leave these to shaders that do not read them
  bind(2, texcoords_, mesh.first_texcoord, sizeof(layout::Float2));
  bind(3, colours_, mesh.first_colour, sizeof(layout::Float3));
}

void GpuModel::bind_one_material(std::uint32_t material) const {
  gl_->BindBufferRange(GL_UNIFORM_BUFFER, kMaterialBinding, padded_materials_.id(),
                       static_cast<GLintptr>(material * material_stride_),
                       sizeof(layout::Material));
}

void GpuModel::bind_materials() const {
  gl_->BindTextureUnit(kMaterialsUnit, materials_texture_.id());
  gl_->BindTextureUnit(kItemsUnit, items_texture_.id());
}

void GpuModel::bind_texture(std::int32_t texture) const {
  if (texture >= 0)
    gl_->BindTextureUnit(kDiffuseMapUnit, textures_[static_cast<std::size_t>(texture)].id());
}

void GpuModel::draw_range(const layout::Mesh& mesh, std::uint64_t first_triangle,
                          std::uint64_t triangles) const {
  const std::uint64_t offset =
      mesh.index_offset + first_triangle * 3 * std::uint64_t{mesh.index_size};
  gl_->DrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * triangles),
                    mesh.index_size == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT,
                    reinterpret_cast<const void*>(offset));
}

void GpuModel::draw(const layout::Mesh& mesh) const { draw_range(mesh, 0, mesh.triangle_count); }

void GpuModel::draw_flat(const layout::Mesh& mesh, std::size_t mesh_index) const {
  gl_->BindTextureUnit(kTriangleNormalsUnit, triangle_normals_texture_.id());
  for (std::uint64_t first = 0; first < mesh.triangle_count; first += flat_triangles_) {
    const std::uint64_t count = std::min(flat_triangles_, mesh.triangle_count - first);
    gl_->TextureBufferRange(
        triangle_normals_texture_.id(), GL_RGB32F, triangle_normals_.id(),
        static_cast<GLintptr>(triangle_normals_at_[mesh_index] + first * 3 * sizeof(float)),
        static_cast<GLsizeiptr>(count * 3 * sizeof(float)));
    draw_range(mesh, first, count);
  }
}

}  // namespace panwright::preview
