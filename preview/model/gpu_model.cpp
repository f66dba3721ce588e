#include "preview/model/gpu_model.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/text.h"
#include "preview/gl/programs.h"
#include "preview/model/texture_charts.h"

namespace panwright::preview {
namespace {

namespace layout = pan::layout;

// OpenGL counts the indices of a draw in 31 bits
constexpr std::uint64_t kMeshTriangles = 0x7fffffff / 3;

// of one draw: some 50 ms where the context draws in software
constexpr std::uint64_t kPartTriangles = std::uint64_t{1} << 18;

std::uint64_t rounded_up(std::uint64_t value, std::uint64_t step) {
  return (value + step - 1) / step * step;
}

std::uint64_t integer(const GladGLContext& gl, GLenum name) {
  GLint value = 1;
  gl.GetIntegerv(name, &value);
  return static_cast<std::uint64_t>(std::max(value, 1));
}

}  // namespace

template <class T>
GlBuffer GpuModel::uploaded(std::span<const T> values) {
  bytes_ += values.size_bytes();
  return make_buffer(*gl_, values.data(), values.size_bytes());
}

bool GpuModel::upload(const Context& context, const pan::Model& model,
                      std::span<const DrawItem> list, const Families& brdf_models,
                      DiagnosticLog& log, const Job& job) {
  context_ = &context;
  gl_ = &context.gl();
  const GladGLContext& gl = *gl_;
  for (std::size_t i = 0; i < model.meshes().size(); ++i)
    if (model.meshes()[i].triangle_count > kMeshTriangles) {
      log.report_file(
          Code("E5003"), model.name(),
          fmt::format("mesh '{}' has {} triangles; one draw takes {}", model.mesh_name(i),
                      model.meshes()[i].triangle_count, kMeshTriangles));
      return false;
    }
  if (model.header().required_features & layout::kFeatureLongRuns) {
    log.report_file(Code("E5003"), model.name(),
                    fmt::format("{} vertices; the preview takes {}", model.positions().size(),
                                std::uint64_t{1} << 32));
    return false;
  }
  positions_ = uploaded(model.positions());
  normals_ = uploaded(model.normals());
  texcoords_ = uploaded(model.texcoords());
  colors_ = uploaded(model.colors());
  indices_ = uploaded(model.index_bytes());

  vertex_array_ = make_vertex_array(gl);
  const GLuint array = vertex_array_.id();
  const auto attribute = [&](GLuint index, GLint components) {
    gl.EnableVertexArrayAttrib(array, index);
    gl.VertexArrayAttribFormat(array, index, components, GL_FLOAT, GL_FALSE, 0);
    gl.VertexArrayAttribBinding(array, index, index);
  };
  attribute(kPositionAttribute, 3);
  attribute(kNormalAttribute, 3);
  attribute(kTexcoordAttribute, 2);
  attribute(kColorAttribute, 3);
  return fits(gl, "vertices", log) && upload_materials(model, list, brdf_models, log) &&
         upload_decals(model, list, log) && upload_textures(model, list, log, job) &&
         upload_tangents(model, list, log, job);
}

bool GpuModel::upload_materials(const pan::Model& model, std::span<const DrawItem> list,
                                const Families& brdf_models, DiagnosticLog& log) {
  const GladGLContext& gl = *gl_;
  const std::uint64_t texels = integer(gl, GL_MAX_TEXTURE_BUFFER_SIZE);
  const std::uint64_t rows = sizeof(layout::Material) / (4 * sizeof(float));
  const std::uint64_t most_items = std::min<std::uint64_t>(texels, kMostItems);
  if (model.materials().size() > texels / rows || list.size() > most_items) {
    log.report_file(
        Code("E5003"), model.name(),
        fmt::format("{} and {}; this context takes {} and {}", counted(list.size(), "instance"),
                    counted(model.materials().size(), "material"), most_items, texels / rows));
    return false;
  }
  materials_ = uploaded(model.materials());
  materials_texture_ = make_buffer_texture(gl);
  gl.TextureBuffer(materials_texture_.id(), GL_RGBA32F, materials_.id());

  std::vector<std::uint32_t> items;
  for (const DrawItem& item : list) {
    items.push_back(item.material);
    items.push_back(brdf_models.of_material[item.material]);
    items.push_back(0);
    items.push_back(0);
  }
  items_ = uploaded(std::span<const std::uint32_t>(items));
  items_texture_ = make_buffer_texture(gl);
  gl.TextureBuffer(items_texture_.id(), GL_RGBA32UI, items_.id());

  material_stride_ =
      rounded_up(sizeof(layout::Material), integer(gl, GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT));
  std::vector<std::byte> records(material_stride_ * model.materials().size());
  for (std::size_t i = 0; i < model.materials().size(); ++i)
    std::memcpy(records.data() + i * material_stride_, &model.materials()[i],
                sizeof(layout::Material));
  padded_materials_ = uploaded(std::span<const std::byte>(records));
  return fits(gl, "materials", log);
}

bool GpuModel::upload_textures(const pan::Model& model, std::span<const DrawItem> list,
                               DiagnosticLog& log, const Job& job) {
  for (const DrawItem& item : list) {
    const layout::Material& material = model.materials()[item.material];
    std::vector<Binding>& bindings = bindings_.emplace_back();
    const auto bind = [&](GLuint unit, std::int32_t texture, TextureRole role, float threshold) {
      if (texture >= 0) bindings.push_back({unit, textures_.number({texture, role, threshold})});
    };
    // what colour a hole has in the texture that cuts it counts nowhere
    const auto color = [&](std::int32_t texture) {
      return texture == material.cutout_map ? TextureRole::premultiplied : TextureRole::color;
    };
    bind(kDiffuseMapUnit, item.texture, color(item.texture), 0);
    bind(kAlbedoMapUnit, material.albedo_map, color(material.albedo_map), 0);
    bind(kNormalMapUnit, material.normal_map, TextureRole::normal, 0);
    bind(kSlopeMapUnit, material.normal_map, TextureRole::slopes, 0);
    bind(kRoughnessMapUnit, material.roughness_map, TextureRole::roughness, 0);
    if (item.variant.reflectance_map)
      bind(kReflectanceMapUnit, material.reflectance_map, color(material.reflectance_map), 0);
    bind(kCutoutMapUnit, material.cutout_map, TextureRole::cutout, material.cutout_threshold);
  }
  for (std::size_t i = 0; i < decals_.size(); ++i)
    decal_ranges_[i].texture = textures_.number(
        {static_cast<std::int32_t>(decals_[i].texture), TextureRole::premultiplied, 0});
  map_sampler_ = make_sampler(*gl_, GL_REPEAT);
  decal_sampler_ = make_sampler(*gl_, GL_CLAMP_TO_EDGE);
  const bool good = textures_.upload(*context_, model, log, job);
  bytes_ += textures_.bytes();
  if (good) choose_samplers(model, list, job);
  return good;
}

// Levels of a texture beyond the width of a mesh's charts show what lies beside them.
void GpuModel::choose_samplers(const pan::Model& model, std::span<const DrawItem> list,
                               const Job& job) {
  std::map<std::tuple<std::uint32_t, std::size_t, double, double>, double> known;
  for (std::size_t i = 0; i < list.size(); ++i)
    for (Binding& binding : bindings_[i]) {
      const bool own = binding.unit == kDiffuseMapUnit;
      binding.sampler = own ? 0 : map_sampler_.id();
      if (binding.unit == kCutoutMapUnit) continue;  // its level is computed
      const auto texture = static_cast<std::size_t>(textures_.use(binding.texture).texture);
      const Vec2 sides(model.textures()[texture].width, model.textures()[texture].height);
      const Vec2 repeat = own ? Vec2(1) : glm::abs(list[i].repeat);
      const auto [entry, added] = known.try_emplace({list[i].mesh, texture, repeat.x, repeat.y}, 0);
      if (added) {
        job.poll();
        entry->second = largest_level(model.mesh(list[i].mesh), repeat, sides);
      }
      if (!(entry->second < std::log2(std::max(sides.x, sides.y)))) continue;
      GLint wrap[2] = {GL_REPEAT, GL_REPEAT};
      if (own)
        gl_->GetTextureParameteriv(textures_.id(binding.texture), GL_TEXTURE_WRAP_T, &wrap[1]);
      const int level = static_cast<int>(entry->second);
      GlSampler& sampler = limited_samplers_[{wrap[0], wrap[1], level}];
      if (!sampler) {
        sampler = make_sampler(*gl_, wrap[0]);
        gl_->SamplerParameteri(sampler.id(), GL_TEXTURE_WRAP_T, wrap[1]);
        gl_->SamplerParameterf(sampler.id(), GL_TEXTURE_MAX_LOD, static_cast<float>(level));
      }
      binding.sampler = sampler.id();
    }
}

bool GpuModel::upload_tangents(const pan::Model& model, std::span<const DrawItem> list,
                               DiagnosticLog& log, const Job& job) {
  std::vector<bool> used(model.meshes().size());
  bool any = false;
  for (const DrawItem& item : list)
    if (item.variant.tangents) any = used[item.mesh] = true;
  if (!any) return true;
  tangents_at_.resize(used.size());
  repeated_.resize(used.size());
  std::vector<float> all;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    job.poll();
    const Tangents found = tangents(model.mesh(i));
    tangents_at_[i] = all.size() * sizeof(float);
    all.insert(all.end(), found.tangents.begin(), found.tangents.end());
    if (!found.repeats.empty()) repeated_[i] = repeated(model.mesh(i), found);
  }
  tangents_ = uploaded(std::span<const float>(all));
  const GLuint array = vertex_array_.id();
  gl_->EnableVertexArrayAttrib(array, kTangentAttribute);
  gl_->VertexArrayAttribFormat(array, kTangentAttribute, 4, GL_FLOAT, GL_FALSE, 0);
  gl_->VertexArrayAttribBinding(array, kTangentAttribute, kTangentAttribute);
  return fits(*gl_, "tangents", log);
}

GpuModel::Repeated GpuModel::repeated(const pan::MeshView& mesh, const Tangents& tangents) {
  const auto longer = [&]<class T>(std::span<const T> values) {
    std::vector<T> all(values.begin(), values.end());
    if (!all.empty())
      for (const std::uint32_t vertex : tangents.repeats) all.push_back(values[vertex]);
    return uploaded(std::span<const T>(all));
  };
  return {longer(mesh.positions), longer(mesh.normals), longer(mesh.texcoords), longer(mesh.colors),
          uploaded(std::span<const std::uint32_t>(tangents.indices))};
}

bool GpuModel::upload_decals(const pan::Model& model, std::span<const DrawItem> list,
                             DiagnosticLog& log) {
  decals_ = placed_decals(model, list);
  if (decals_.empty()) return true;
  decal_stride_ = rounded_up(sizeof(DecalBlock), integer(*gl_, GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT));
  std::vector<std::byte> blocks(decals_.size() * decal_stride_);
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < decals_.size(); ++i) {
    PlacedDecal& decal = decals_[i];
    DecalBlock block{};
    for (int row = 0; row < 3; ++row)
      for (int k = 0; k < 4; ++k)
        block.place[4 * row + k] =
            static_cast<float>(decal.place[static_cast<std::size_t>(row)][k]);
    for (int k = 0; k < 3; ++k) block.outwards[k] = static_cast<float>(decal.outwards[k]);
    std::memcpy(blocks.data() + i * decal_stride_, &block, sizeof block);
    decal_ranges_.push_back({indices.size() * sizeof(std::uint32_t), decal.indices.size(), 0});
    indices.insert(indices.end(), decal.indices.begin(), decal.indices.end());
    decal.indices = {};
  }
  decal_blocks_ = uploaded(std::span<const std::byte>(blocks));
  decal_indices_ = uploaded(std::span<const std::uint32_t>(indices));
  return fits(*gl_, "decals", log);
}

bool GpuModel::upload_triangle_normals(const pan::Model& model, DiagnosticLog& log) {
  if (triangle_normals_) return true;
  // parts begin where the context lets a buffer texture begin: a part of 2^k triangles is a
  // multiple of any power of two up to 4·2^k bytes
  const std::uint64_t alignment = integer(*gl_, GL_TEXTURE_BUFFER_OFFSET_ALIGNMENT);
  flat_triangles_ = kPartTriangles;
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
    bytes_ += normals.size() * sizeof(float);
  }
  return true;
}

void GpuModel::bind_vertices(const layout::Mesh& mesh, std::size_t mesh_index) const {
  const GladGLContext& gl = *gl_;
  const GLuint array = vertex_array_.id();
  const auto bind = [&](GLuint index, const GlBuffer& buffer, std::uint64_t first, GLsizei stride) {
    gl.VertexArrayVertexBuffer(array, index, buffer.id(),
                               static_cast<GLintptr>(first * static_cast<std::uint64_t>(stride)),
                               stride);
  };
  gl.BindVertexArray(array);
  // note: meshes without texcoords, colours or tangents leave them to shaders that do not read them
  if (const Repeated* own = own_vertices(mesh_index)) {
    bind(kPositionAttribute, own->positions, 0, sizeof(layout::Float3));
    bind(kNormalAttribute, own->normals, 0, sizeof(layout::Float3));
    bind(kTexcoordAttribute, own->texcoords, 0, sizeof(layout::Float2));
    bind(kColorAttribute, own->colors, 0, sizeof(layout::Float3));
  } else {
    bind(kPositionAttribute, positions_, mesh.first_vertex, sizeof(layout::Float3));
    bind(kNormalAttribute, normals_, mesh.first_vertex, sizeof(layout::Float3));
    bind(kTexcoordAttribute, texcoords_, mesh.first_texcoord, sizeof(layout::Float2));
    bind(kColorAttribute, colors_, mesh.first_color, sizeof(layout::Float3));
  }
  if (!tangents_at_.empty())
    gl.VertexArrayVertexBuffer(array, kTangentAttribute, tangents_.id(),
                               static_cast<GLintptr>(tangents_at_[mesh_index]), 4 * sizeof(float));
  const Repeated* own = own_vertices(mesh_index);
  gl.VertexArrayElementBuffer(array, own ? own->indices.id() : indices_.id());
}

const GpuModel::Repeated* GpuModel::own_vertices(std::size_t mesh_index) const {
  return repeated_.empty() || !repeated_[mesh_index] ? nullptr : &*repeated_[mesh_index];
}

void GpuModel::bind_one_material(std::uint32_t material) const {
  gl_->BindBufferRange(GL_UNIFORM_BUFFER, kMaterialBinding, padded_materials_.id(),
                       static_cast<GLintptr>(material * material_stride_),
                       sizeof(layout::Material));
}

void GpuModel::bind_items() const { gl_->BindTextureUnit(kItemsUnit, items_texture_.id()); }

void GpuModel::bind_materials() const {
  gl_->BindTextureUnit(kMaterialsUnit, materials_texture_.id());
  bind_items();
}

void GpuModel::bind_maps(std::size_t item) const {
  for (const Binding& binding : bindings_[item]) {
    gl_->BindTextureUnit(binding.unit, textures_.id(binding.texture));
    gl_->BindSampler(binding.unit, binding.sampler);
  }
}

void GpuModel::draw_range(const layout::Mesh& mesh, std::size_t mesh_index,
                          std::uint64_t first_triangle, std::uint64_t triangles,
                          std::size_t instances) const {
  const bool own = own_vertices(mesh_index) != nullptr;
  const std::uint64_t size = own ? sizeof(std::uint32_t) : mesh.index_size;
  const std::uint64_t offset = (own ? 0 : mesh.index_offset) + first_triangle * 3 * size;
  const auto count = static_cast<GLsizei>(3 * triangles);
  const GLenum type = size == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
  const void* first = reinterpret_cast<const void*>(offset);
  if (instances == 1)
    gl_->DrawElements(GL_TRIANGLES, count, type, first);
  else
    gl_->DrawElementsInstanced(GL_TRIANGLES, count, type, first, static_cast<GLsizei>(instances));
}

bool GpuModel::draw(const layout::Mesh& mesh, std::size_t mesh_index, std::size_t instances,
                    const Job& job, std::uint64_t first, std::uint64_t count) const {
  for (const std::uint64_t end = first + count; first < end; first += kPartTriangles) {
    if (job.cancelled()) return false;
    draw_range(mesh, mesh_index, first, std::min(kPartTriangles, end - first), instances);
  }
  return true;
}

bool GpuModel::draw_whole(const layout::Mesh& mesh, std::size_t mesh_index, std::size_t instances,
                          const Job& job) const {
  if (job.cancelled()) return false;
  draw_range(mesh, mesh_index, 0, mesh.triangle_count, instances);
  return true;
}

void GpuModel::draw_decal(std::size_t decal) const {
  const DecalRange& range = decal_ranges_[decal];
  gl_->VertexArrayElementBuffer(vertex_array_.id(), decal_indices_.id());
  gl_->BindBufferRange(GL_UNIFORM_BUFFER, kDecalBinding, decal_blocks_.id(),
                       static_cast<GLintptr>(decal * decal_stride_), sizeof(DecalBlock));
  gl_->BindTextureUnit(kDecalMapUnit, textures_.id(range.texture));
  gl_->BindSampler(kDecalMapUnit, decal_sampler_.id());
  gl_->DrawElements(GL_TRIANGLES, static_cast<GLsizei>(range.count), GL_UNSIGNED_INT,
                    reinterpret_cast<const void*>(range.first));
}

bool GpuModel::draw_flat(const layout::Mesh& mesh, std::size_t mesh_index, std::size_t instances,
                         const Job& job) const {
  gl_->BindTextureUnit(kTriangleNormalsUnit, triangle_normals_texture_.id());
  for (std::uint64_t first = 0; first < mesh.triangle_count; first += flat_triangles_) {
    if (job.cancelled()) return false;
    const std::uint64_t count = std::min(flat_triangles_, mesh.triangle_count - first);
    gl_->TextureBufferRange(
        triangle_normals_texture_.id(), GL_RGB32F, triangle_normals_.id(),
        static_cast<GLintptr>(triangle_normals_at_[mesh_index] + first * 3 * sizeof(float)),
        static_cast<GLsizeiptr>(count * 3 * sizeof(float)));
    draw_range(mesh, mesh_index, first, count, instances);
  }
  return true;
}

}  // namespace panwright::preview
