#include "preview/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/parallel.h"
#include "base/text.h"
#include "materials/brdf.h"
#include "preview/internal/blocks.h"
#include "preview/internal/draw_list.h"
#include "preview/internal/gpu_model.h"
#include "preview/internal/programs.h"
#include "preview/internal/samples.h"
#include "preview/internal/shadow.h"

namespace panwright::preview {
namespace {

// the largest side of an image, as the largest framebuffers of common contexts
constexpr std::uint32_t kMaxSide = 16384;

[[maybe_unused]] bool is_sound(const View& view, const RenderOptions& options) {
  const world::Camera& camera = view.camera;
  const auto unit = [](const Quat& q) { return std::fabs(glm::dot(q, q) - 1) < 1e-6; };
  return camera.width > 0 && camera.height > 0 && camera.focal.x > 0 && camera.focal.y > 0 &&
         std::isfinite(camera.focal.x + camera.focal.y) && is_finite(camera.position) &&
         std::isfinite(camera.principal.x + camera.principal.y) && unit(camera.world_from_camera) &&
         unit(view.world_from_model.rotation) && is_finite(view.world_from_model.translation) &&
         is_finite(view.to_sun) && glm::length(view.to_sun) > 0 && options.samples >= 1 &&
         options.samples <= 64 && options.tile_side >= options.samples &&
         (options.shadow_side == 0 ||
          (options.shadow_side >= 16 && options.shadow_side <= kMaxSide));
}

void copy_cells(const materials::Cells& cells, const float coat_return[3], DrawBlock& block) {
  for (int axis = 0; axis < 2; ++axis) {
    block.cells[axis] = static_cast<float>(cells.count[axis]);
    block.cells[axis + 2] = static_cast<float>(cells.gap[axis]);
  }
  copy_floats(cells.gap_color, block.gap_colour);
  copy_floats(cells.finger_color, block.finger_colour);
  block.gap_colour[3] = static_cast<float>(std::floor(cells.fingers + 0.5));
  block.finger_colour[3] = static_cast<float>(cells.finger_width);
  std::copy_n(coat_return, 3, block.lift + 1);
}

// what the fragments of a tile share
ViewBlock view_block(const View& view, const Tile& tile, unsigned samples) {
  const world::Camera& camera = view.camera;
  const Mat3 axes = glm::mat3_cast(camera.world_from_camera);
  Vec3 sight = axes[2];
  Vec3 right(0);
  Vec3 down(0);
  if (camera.projection == world::Projection::perspective) {
    const Vec2 corner = (Vec2(tile.x, tile.y) - camera.principal) / camera.focal;
    sight = axes * Vec3(corner, 1);
    right = axes[0] / (camera.focal.x * samples);
    down = axes[1] / (camera.focal.y * samples);
  }
  ViewBlock block{};
  copy_floats(sight, block.sight);
  copy_floats(right, block.sight_right);
  copy_floats(down, block.sight_down);
  copy_floats(glm::normalize(view.to_sun), block.to_sun);
  block.to_sun[3] =
      static_cast<float>(materials::kSunAlpha2 / (view.sun_distance * view.sun_distance));
  copy_floats(view.sun_irradiance.value_or(Vec3(1)), block.irradiance);
  return block;
}

// the layers that an instance needs
LayerSet layers_of(const Variant& variant) {
  LayerSet set = 1u << kSeenLayer;
  if (variant.textured || variant.coloured || variant.albedo_map) set |= 1u << kPaintLayer;
  if (variant.normal_map || variant.roughness_map || variant.cells)
    set |= 1u << kPaintLayer | 1u << kRoughLayer;
  if (variant.brushed) set |= 1u << kPaintLayer | 1u << kRoughLayer | 1u << kTangentLayer;
  if (variant.reflectance_map) set |= 1u << kReflectanceLayer;
  return set;
}

constexpr GLenum kRadianceFormats[] = {GL_RGBA32F};

std::array<GLenum, kLayers> layer_formats(LayerSet layers, bool shadows) {
  std::array<GLenum, kLayers> formats{};
  for (unsigned layer = 0; layer < kSunLayer; ++layer)
    formats[layer] = has(layers, Layer{layer}) ? GL_RGBA32F : GL_NONE;
  formats[kSunLayer] = shadows ? GL_RGBA32UI : GL_NONE;
  return formats;
}

}  // namespace

struct Renderer::Impl {
  Impl(Context& context_in, const pan::Model& model_in)
      : context(context_in),
        model(model_in),
        gl(context_in.gl()),
        programs(context_in.gl(), model_in) {}
  ~Impl() { context.make_current(); }  // the members delete their objects

  // What a pass over the triangles draws.
  enum class Pass { geometry, flat_geometry, ids, bare };

  // The items of one tile.
  struct TileItems {
    std::vector<std::uint32_t> drawn;     // into the scenery, ascending
    std::vector<std::uint32_t> variants;  // of shading, ascending
    bool one_material = true;
  };

  void set_state() const;
  bool ensure_target(Target& target, std::span<const GLenum> formats, bool depth,
                     std::uint32_t width, std::uint32_t height, DiagnosticLog& log);
  bool prepare(Pass pass, const Scenery& scenery, DiagnosticLog& log);
  TileItems items_on(const View& view, const Scenery& scenery, const Tile& tile) const;
  void upload_blocks(const View& view, const Scenery& scenery, const TileItems& items,
                     const Tile& tile, unsigned samples, bool flat);
  void draw(const Scenery& scenery, const TileItems& items, const Tile& tile, unsigned samples,
            Pass pass, const Target& target);
  void draw_decals(const Scenery& scenery, const TileItems& items);
  void shade(const Scenery& scenery, const TileItems& items, const Tile& tile, unsigned samples);
  GLuint program(const Variant& variant, Pass pass, std::string* problem);
  bool render_radiance(const View& view, const Scenery& scenery, const RenderOptions& options,
                       Image& image, DiagnosticLog& log);
  bool render_truth(const View& view, const Scenery& scenery, const RenderOptions& options,
                    Image& image, DiagnosticLog& log);
  bool drawn_well(DiagnosticLog& log) const;

  Context& context;
  const pan::Model& model;
  const GladGLContext& gl;
  std::vector<DrawItem> list;
  GpuModel gpu;
  Programs programs;
  LayerSet layers = 0;   // of seen_target
  bool shadows = false;  // of this view
  ShadowMap shadow_map;
  Target seen_target;    // what Layer names
  Target color_target;   // radiance
  Target id_target;      // triangles
  Target bare_target;    // of seconds_of_bare_draw
  GlVertexArray screen;  // no vertices
  std::vector<float> sample_buffer;
  GlBuffer view_buffer;
  GlBuffer draw_buffer;
  std::size_t draw_stride = 0;  // bytes
  std::uint64_t triangles = 0;
};

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

std::uint64_t Renderer::triangles() const { return impl_->triangles; }

Result<Renderer> Renderer::create(Context& context, const pan::Model& model, DiagnosticLog& log) {
  assert(model.checked());
  if (!context.make_current()) {
    log.report_file(Code::E5001, {}, "the OpenGL context cannot be made current");
    return failed;
  }
  auto impl = std::make_unique<Impl>(context, model);
  impl->list = draw_list(model);
  for (const DrawItem& item : impl->list) {
    impl->triangles += model.meshes()[item.mesh].triangle_count;
    impl->layers |= layers_of(item.variant);
  }
  impl->screen = make_vertex_array(impl->gl);
  if (!impl->gpu.upload(context, model, impl->list, log)) return failed;
  if (!impl->gpu.decals().empty()) impl->layers |= 1u << kPaintLayer;
  impl->draw_stride = block_stride(impl->gl, sizeof(DrawBlock));
  impl->view_buffer = make_stream_buffer(impl->gl);
  impl->draw_buffer = make_stream_buffer(impl->gl);
  return Renderer(std::move(impl));
}

void Renderer::Impl::set_state() const {
  gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  gl.DepthFunc(GL_GREATER);
  gl.DepthMask(GL_TRUE);
  gl.DepthRangef(0, 1);
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  gl.CullFace(GL_BACK);
  for (const GLenum off : {GL_BLEND, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_FRAMEBUFFER_SRGB,
                           GL_DEPTH_CLAMP, GL_MULTISAMPLE, GL_POLYGON_OFFSET_FILL, GL_DITHER,
                           GL_PRIMITIVE_RESTART, GL_RASTERIZER_DISCARD})
    gl.Disable(off);
}

bool Renderer::Impl::ensure_target(Target& target, std::span<const GLenum> formats, bool depth,
                                   std::uint32_t width, std::uint32_t height, DiagnosticLog& log) {
  const auto w = static_cast<GLsizei>(width);
  const auto h = static_cast<GLsizei>(height);
  bool enough = target.width >= w && target.height >= h;
  for (std::size_t i = 0; i < formats.size(); ++i)
    enough = enough && (formats[i] == GL_NONE || target.colors[i]);
  if (enough) return true;
  const GLsizei wider = std::max(w, target.width);
  const GLsizei higher = std::max(h, target.height);
  target = {};  // first, so that memory need not hold both
  target = make_target(gl, formats, depth, wider, higher);
  if (target.width != 0 && gl.GetError() == GL_NO_ERROR) return true;
  target = {};
  log.report_file(Code::E5003, {},
                  fmt::format("the context has no memory for a framebuffer of {} by {} samples",
                              wider, higher));
  return false;
}

GLuint Renderer::Impl::program(const Variant& variant, Pass pass, std::string* problem) {
  switch (pass) {
    case Pass::geometry:
      return programs.geometry(variant, false, layers, shadows, problem);
    case Pass::flat_geometry:
      return programs.geometry(variant, true, layers, shadows, problem);
    case Pass::ids:
      return programs.ids(variant.cutout, problem);
    case Pass::bare:
      return programs.bare(problem);
  }
  return 0;
}

// every program that a pass needs is built before its first draw
bool Renderer::Impl::prepare(Pass pass, const Scenery& scenery, DiagnosticLog& log) {
  if (pass == Pass::flat_geometry && !gpu.upload_triangle_normals(model, log)) return false;
  const bool shaded = pass == Pass::geometry || pass == Pass::flat_geometry;
  const DrawItem* last = nullptr;
  for (const std::uint32_t index : scenery.items) {
    const DrawItem& item = list[index];
    if (last && item.variant == last->variant) continue;
    last = &item;
    std::string problem;
    bool good = program(item.variant, pass, &problem) != 0;
    if (shaded && !gpu.decals().empty()) good = good && programs.decal(&problem) != 0;
    for (const bool one : {false, true})
      good = good &&
             (!shaded || programs.shading(item.variant.shading, layers, one, shadows, &problem));
    if (good) continue;
    log.report_file(Code::E5001, {},
                    fmt::format("{} refuses a shader: {}", context.renderer(), problem));
    return false;
  }
  return true;
}

Renderer::Impl::TileItems Renderer::Impl::items_on(const View& view, const Scenery& scenery,
                                                   const Tile& tile) const {
  TileItems items;
  std::array<bool, materials::kMostVariants> has{};
  for (std::uint32_t i = 0; i < scenery.items.size(); ++i) {
    if (!may_touch(view.camera, tile, 1.0, scenery.boxes[i])) continue;
    const DrawItem& item = list[scenery.items[i]];
    if (!items.drawn.empty())
      items.one_material =
          items.one_material && item.material == list[scenery.items[items.drawn.front()]].material;
    items.drawn.push_back(i);
    has[item.variant.shading] = true;
  }
  for (std::uint32_t variant = 0; variant < has.size(); ++variant)
    if (has[variant]) items.variants.push_back(variant);
  return items;
}

// one upload for all instances of a tile
void Renderer::Impl::upload_blocks(const View& view, const Scenery& scenery, const TileItems& items,
                                   const Tile& tile, unsigned samples, bool flat) {
  const ViewBlock shared = view_block(view, tile, samples);
  gl.NamedBufferData(view_buffer.id(), sizeof shared, &shared, GL_STREAM_DRAW);
  gl.BindBufferBase(GL_UNIFORM_BUFFER, kViewBinding, view_buffer.id());
  std::vector<std::byte> blocks(items.drawn.size() * draw_stride);
  const Mat3 rotation = glm::mat3_cast(view.world_from_model.rotation);
  for (std::size_t k = 0; k < items.drawn.size(); ++k) {
    const std::uint32_t index = scenery.items[items.drawn[k]];
    DrawBlock block{};
    copy_floats(clip_from_mesh(view.camera, tile, scenery.depth,
                               scenery.boxes[items.drawn[k]].camera_from_mesh),
                block.clip_from_mesh);
    copy_floats(rotation * list[index].model_normal_from_mesh, block.world_normal_from_mesh);
    block.id[0] = index + 1;
    block.id[1] = tile.x * samples;
    block.id[2] = tile.y * samples;
    copy_floats(list[index].diffuse, block.diffuse);
    copy_repeat(list[index], block);
    copy_cells(list[index].cells, model.materials()[list[index].material].coat_return, block);
    if (shadows)
      place_before_sun(shadow_map.frame(), model.meshes()[list[index].mesh], list[index], flat,
                       block);
    std::memcpy(blocks.data() + k * draw_stride, &block, sizeof block);
  }
  if (!blocks.empty())
    gl.NamedBufferData(draw_buffer.id(), static_cast<GLsizeiptr>(blocks.size()), blocks.data(),
                       GL_STREAM_DRAW);
}

void Renderer::Impl::draw(const Scenery& scenery, const TileItems& items, const Tile& tile,
                          unsigned samples, Pass pass, const Target& target) {
  gl.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.id());
  gl.Viewport(0, 0, static_cast<GLsizei>(tile.width * samples),
              static_cast<GLsizei>(tile.height * samples));
  gl.Enable(GL_DEPTH_TEST);
  const float far_depth = 0;
  gl.ClearBufferfv(GL_DEPTH, 0, &far_depth);
  if (pass == Pass::ids) {
    constexpr GLuint kNothing[4] = {};
    gl.ClearBufferuiv(GL_COLOR, 0, kNothing);
  } else {
    constexpr float kNothing[4] = {};
    gl.ClearBufferfv(GL_COLOR, 0, kNothing);
  }
  const DrawItem* last = nullptr;
  for (std::size_t k = 0; k < items.drawn.size(); ++k) {
    const DrawItem& item = list[scenery.items[items.drawn[k]]];
    const pan::layout::Mesh& mesh = model.meshes()[item.mesh];
    if (!last || item.variant != last->variant) gl.UseProgram(program(item.variant, pass, nullptr));
    if (!last || item.closed != last->closed)
      item.closed ? gl.Enable(GL_CULL_FACE) : gl.Disable(GL_CULL_FACE);
    // note: rows grow downwards in the window, which turns every triangle round once
    if (!last || item.mirrored != last->mirrored) gl.FrontFace(item.mirrored ? GL_CCW : GL_CW);
    if (!last || item.texture != last->texture || item.material != last->material)
      gpu.bind_maps(scenery.items[items.drawn[k]]);
    if (!last || item.mesh != last->mesh) gpu.bind_vertices(mesh, item.mesh);
    gl.BindBufferRange(GL_UNIFORM_BUFFER, kDrawBinding, draw_buffer.id(),
                       static_cast<GLintptr>(k * draw_stride), sizeof(DrawBlock));
    pass == Pass::flat_geometry ? gpu.draw_flat(mesh, item.mesh) : gpu.draw(mesh, item.mesh);
    last = &item;
  }
}

// lays pictures over the colours of what is seen
void Renderer::Impl::draw_decals(const Scenery& scenery, const TileItems& items) {
  if (gpu.decals().empty()) return;
  std::vector<std::uint32_t> place(list.size(), ~0u);  // of an item in items.drawn
  for (std::uint32_t k = 0; k < items.drawn.size(); ++k) place[scenery.items[items.drawn[k]]] = k;
  gl.UseProgram(programs.decal(nullptr));
  // every program puts a vertex on the same spot, so what is seen has the very depth that is there
  gl.DepthFunc(GL_EQUAL);
  gl.DepthMask(GL_FALSE);
  for (GLuint layer = 0; layer <= kSunLayer; ++layer) {
    const GLboolean paint = layer == kPaintLayer;
    gl.ColorMaski(layer, paint, paint, paint, GL_FALSE);
  }
  gl.Enablei(GL_BLEND, kPaintLayer);
  gl.BlendFunci(kPaintLayer, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  const DrawItem* last = nullptr;
  for (std::size_t i = 0; i < gpu.decals().size(); ++i) {
    const std::uint32_t k = place[gpu.decals()[i].item];
    if (k == ~0u) continue;
    const DrawItem& item = list[gpu.decals()[i].item];
    if (&item != last) {
      item.closed ? gl.Enable(GL_CULL_FACE) : gl.Disable(GL_CULL_FACE);
      gl.FrontFace(item.mirrored ? GL_CCW : GL_CW);
      gpu.bind_vertices(model.meshes()[item.mesh], item.mesh);
      gl.BindBufferRange(GL_UNIFORM_BUFFER, kDrawBinding, draw_buffer.id(),
                         static_cast<GLintptr>(k * draw_stride), sizeof(DrawBlock));
    }
    gpu.draw_decal(i);
    last = &item;
  }
  gl.Disablei(GL_BLEND, kPaintLayer);
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl.DepthMask(GL_TRUE);
  gl.DepthFunc(GL_GREATER);
}

// turns what is seen into radiance, one pair of laws after the other
void Renderer::Impl::shade(const Scenery& scenery, const TileItems& items, const Tile& tile,
                           unsigned samples) {
  gl.BindFramebuffer(GL_FRAMEBUFFER, color_target.framebuffer.id());
  gl.Viewport(0, 0, static_cast<GLsizei>(tile.width * samples),
              static_cast<GLsizei>(tile.height * samples));
  gl.Disable(GL_DEPTH_TEST);
  gl.Disable(GL_CULL_FACE);
  constexpr float kNothing[4] = {};
  gl.ClearBufferfv(GL_COLOR, 0, kNothing);
  gl.BindTextureUnit(kSeenUnit, seen_target.colors[kSeenLayer].id());
  constexpr std::pair<Layer, GLuint> kUnits[] = {{kPaintLayer, kPaintUnit},
                                                 {kRoughLayer, kRoughUnit},
                                                 {kTangentLayer, kTangentUnit},
                                                 {kReflectanceLayer, kReflectanceUnit}};
  for (const auto& [layer, unit] : kUnits)
    if (has(layers, layer)) gl.BindTextureUnit(unit, seen_target.colors[layer].id());
  if (shadows) {
    gl.BindTextureUnit(kSunUnit, seen_target.colors[kSunLayer].id());
    shadow_map.bind(gl);
  }
  if (items.one_material)
    gpu.bind_one_material(list[scenery.items[items.drawn.front()]].material);
  else
    gpu.bind_materials();
  gl.BindVertexArray(screen.id());
  for (const std::uint32_t variant : items.variants) {
    gl.UseProgram(programs.shading(variant, layers, items.one_material, shadows, nullptr));
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
  }
}

bool Renderer::Impl::drawn_well(DiagnosticLog& log) const {
  const GLenum error = gl.GetError();
  if (error == GL_NO_ERROR) return true;
  log.report_file(Code::E5003, {},
                  fmt::format("the context failed while it drew, with OpenGL error 0x{:04x}",
                              static_cast<unsigned>(error)));
  return false;
}

bool Renderer::Impl::render_radiance(const View& view, const Scenery& scenery,
                                     const RenderOptions& options, Image& image,
                                     DiagnosticLog& log) {
  const Pass pass = options.flat ? Pass::flat_geometry : Pass::geometry;
  const std::uint32_t side = std::min(options.tile_side, context.limits().framebuffer_side);
  const std::uint32_t tile_side = std::max(1u, side / options.samples);
  const std::uint32_t width = std::min(tile_side, image.width) * options.samples;
  const std::uint32_t height = std::min(tile_side, image.height) * options.samples;
  shadows = options.shadow_side > 0 && !scenery.items.empty();
  const auto formats = layer_formats(layers, shadows);
  if (!ensure_target(seen_target, formats, true, width, height, log) ||
      !ensure_target(color_target, kRadianceFormats, false, width, height, log) ||
      !prepare(pass, scenery, log))
    return false;
  const Vec3 to_sun = glm::conjugate(view.world_from_model.rotation) * glm::normalize(view.to_sun);
  if (shadows && !shadow_map.draw(context, model, list, gpu, programs, glm::normalize(to_sun),
                                  options.shadow_side, log))
    return false;
  // kept between views: fresh memory costs as much as a tenth of a draw
  sample_buffer.resize(std::max(sample_buffer.size(), std::size_t{4} * width * height));
  for (const Tile& whole : tiles(image.width, image.height, tile_side)) {
    const TileItems items = items_on(view, scenery, whole);
    const Tile tile = touched_part(view.camera, whole, scenery.boxes, items.drawn);
    if (tile.width == 0 || tile.height == 0) continue;  // the image begins as background
    upload_blocks(view, scenery, items, tile, options.samples, options.flat);
    draw(scenery, items, tile, options.samples, pass, seen_target);
    draw_decals(scenery, items);
    shade(scenery, items, tile, options.samples);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl.ReadPixels(0, 0, static_cast<GLsizei>(tile.width * options.samples),
                  static_cast<GLsizei>(tile.height * options.samples), GL_RGBA, GL_FLOAT,
                  sample_buffer.data());
    average_samples(sample_buffer, tile, options.samples, image);
  }
  return drawn_well(log);
}

bool Renderer::Impl::render_truth(const View& view, const Scenery& scenery,
                                  const RenderOptions& options, Image& image, DiagnosticLog& log) {
  const std::uint32_t side = std::min(options.tile_side, context.limits().framebuffer_side);
  const std::uint32_t width = std::min(side, image.width);
  const std::uint32_t height = std::min(side, image.height);
  constexpr GLenum kFormats[] = {GL_RG32UI};
  if (!ensure_target(id_target, kFormats, true, width, height, log) ||
      !prepare(Pass::ids, scenery, log))
    return false;
  std::vector<TriangleId> ids(std::size_t{width} * height);
  const std::vector<Placement> placements = preview::placements(view, scenery, list);
  static_assert(sizeof(TriangleId) == 8);
  for (const Tile& whole : tiles(image.width, image.height, side)) {
    const TileItems items = items_on(view, scenery, whole);
    const Tile tile = touched_part(view.camera, whole, scenery.boxes, items.drawn);
    if (tile.width == 0 || tile.height == 0) continue;
    upload_blocks(view, scenery, items, tile, 1, options.flat);
    draw(scenery, items, tile, 1, Pass::ids, id_target);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl.ReadPixels(0, 0, static_cast<GLsizei>(tile.width), static_cast<GLsizei>(tile.height),
                  GL_RG_INTEGER, GL_UNSIGNED_INT, ids.data());
    if (!drawn_well(log)) return false;  // before ids are used as indices
    fill_truth(model, view, options.flat, list, placements, tile, ids, image);
  }
  return true;
}

Result<Image> Renderer::render(const View& view, const RenderOptions& options, DiagnosticLog& log) {
  assert(is_sound(view, options));
  const world::Camera& camera = view.camera;
  if (camera.width > kMaxSide || camera.height > kMaxSide) {
    log.report_file(Code::E5003, {},
                    fmt::format("an image of {} by {} pixels; a side may have {}", camera.width,
                                camera.height, kMaxSide));
    return failed;
  }
  Image image;
  image.width = camera.width;
  image.height = camera.height;
  image.unit = view.sun_irradiance ? "W/(m^2 sr)" : "1/sr";
  const std::uint64_t bytes = image.pixels() * (options.truth ? 44 : 16);
  if (bytes > options.max_bytes) {
    log.report_file(
        Code::E5003, {},
        fmt::format("an image of {} by {} pixels takes {:.4g} MiB; the limit is {:.4g} MiB",
                    camera.width, camera.height, static_cast<double>(bytes) / 0x1p20,
                    static_cast<double>(options.max_bytes) / 0x1p20));
    return failed;
  }
  if (!impl_->context.make_current()) {
    log.report_file(Code::E5001, {}, "the OpenGL context cannot be made current");
    return failed;
  }
  image.radiance.resize(3 * image.pixels());
  image.coverage.resize(image.pixels());
  impl_->set_state();
  const Scenery scenery = preview::scenery(view, impl_->list);
  if (!impl_->render_radiance(view, scenery, options, image, log)) return failed;
  if (options.truth) {
    image.depth.resize(image.pixels(), INFINITY);
    image.range.resize(image.pixels(), INFINITY);
    image.normal.resize(3 * image.pixels());
    image.node_id.resize(image.pixels());
    image.material_id.resize(image.pixels());
    if (!impl_->render_truth(view, scenery, options, image, log)) return failed;
  }
  if (std::all_of(image.coverage.begin(), image.coverage.end(), [](float a) { return a == 0; }))
    log.report_file(Code::W5006, {},
                    scenery.items.empty()
                        ? "nothing is in view: no part of the model lies inside the image"
                        : "nothing is in view: what lies inside the image fell between the "
                          "samples (--samples takes more), or the camera is inside a closed mesh, "
                          "which shows its outside only");
  return image;
}

double Renderer::seconds_of_bare_draw(const View& view) {
  Impl& impl = *impl_;
  DiagnosticLog log;
  impl.context.make_current();
  impl.set_state();
  const Scenery scenery = preview::scenery(view, impl.list);
  const Tile whole{0, 0, view.camera.width, view.camera.height};
  constexpr GLenum kFormats[] = {GL_RGBA32F};
  if (!impl.ensure_target(impl.bare_target, kFormats, true, whole.width, whole.height, log) ||
      !impl.prepare(Impl::Pass::bare, scenery, log))
    return 0;
  impl.gl.Finish();
  const auto start = std::chrono::steady_clock::now();
  const Impl::TileItems items = impl.items_on(view, scenery, whole);
  impl.upload_blocks(view, scenery, items, whole, 1, false);
  impl.draw(scenery, items, whole, 1, Impl::Pass::bare, impl.bare_target);
  impl.gl.Finish();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace panwright::preview
