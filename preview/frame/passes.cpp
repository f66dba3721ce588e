#include "preview/frame/passes.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include "light/light.h"
#include "preview/frame/block_stream.h"
#include "preview/frame/blocks.h"
#include "preview/frame/lights.h"

namespace panwright::preview {
namespace {

void copy_cells(const materials::Cells& cells, const float coat_return[3], DrawBlock& block) {
  for (int axis = 0; axis < 2; ++axis) {
    block.cell_count[axis] = static_cast<float>(cells.count[axis]);
    block.cell_gaps[axis] = static_cast<float>(cells.gap[axis]);
  }
  copy_floats(cells.gap_color, block.gap_color);
  copy_floats(cells.finger_color, block.finger_color);
  block.fingers = static_cast<float>(std::floor(cells.fingers + 0.5));
  block.finger_width = static_cast<float>(cells.finger_width);
  std::copy_n(coat_return, 3, block.coat_return);
}

// what the fragments of a tile share
ViewBlock view_block(const world::Camera& camera, const world::World& world, const Tile& tile,
                     unsigned samples) {
  const Mat3 axes = glm::mat3_cast(camera.world_from_camera);
  Vec3 view_ray = axes[2];
  Vec3 right(0);
  Vec3 down(0);
  if (camera.projection == world::Projection::perspective) {
    const Vec2 corner = (Vec2(tile.x, tile.y) - camera.principal) / camera.focal;
    view_ray = axes * Vec3(corner, 1);
    right = axes[0] / (camera.focal.x * samples);
    down = axes[1] / (camera.focal.y * samples);
  }
  ViewBlock block{};
  copy_floats(view_ray, block.ray);
  copy_floats(right, block.ray_right);
  copy_floats(down, block.ray_down);
  copy_floats(world.white(), block.white);
  block.told_irradiance = static_cast<float>(told_irradiance(world));
  block.first_sample[0] = tile.x * samples;
  block.first_sample[1] = tile.y * samples;
  return block;
}

// The parts a side in which the footprint of a sample is averaged over solar cells: what 4×4
// samples see at least. A box along u and v is exact where a pixel's sides lie along these, and up
// to twice as wide as the pixel elsewhere.
unsigned cell_parts(unsigned samples) { return samples < 4 ? (3 + samples) / samples : 1; }

bool has_shadows(const FrameScene& scene) { return scene.lights && scene.lights->shadows(); }
// whether samples have positions
bool has_places(const FrameScene& scene) { return scene.lights && scene.lights->placed(); }

Programs::Lit lit_by(const FrameScene& scene, bool added) {
  using enum Programs::Lit;
  if (added) return scene.lights->points() ? point_lamps : lamps;
  constexpr Programs::Lit kLit[2][4] = {
      {sun, sun_and_planets, sun_and_surfaces, all_but_lamps},
      {eclipsed, eclipsed_and_planets, eclipsed_and_surfaces, all_eclipsed}};
  return kLit[scene.lights->eclipsed()][2 * scene.lights->indirect() + scene.lights->planets()];
}

Mat4 rigid_inverse(const Mat4& matrix) {
  const Mat3 turn = glm::transpose(Mat3(matrix));
  Mat4 inverse(turn);
  inverse[3] = Vec4(-(turn * Vec3(matrix[3])), 1);
  return inverse;
}

// Sets the members of a block that place an item's samples. flat: shaded by its triangles' normals.
void place_samples(const Mat4& sample_from_mesh, const pan::layout::Mesh& mesh,
                   const DrawItem& item, bool flat, DrawBlock& block) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      block.sample_from_mesh[4 * row + column] = static_cast<float>(sample_from_mesh[column][row]);
  // 2^-20 of the size: what rounding to float leaves (2^-24) and no chord is as small as
  const auto side = [&](int k) { return mesh.bounds_max[k] - mesh.bounds_min[k]; };
  const bool own_shape = mesh.error <= 0x1p-20f * std::max({side(0), side(1), side(2)});
  if (own_shape && !flat) block.flags |= kOwnShape;
  // A chord is as deep below the smooth surface as others stand out of it; slivers are placed and
  // drawn into maps with errors of their own.
  block.normal_offset = flat ? 0.0f : static_cast<float>(std::max(2.0 * mesh.error, item.rounding));
}

bool is_flat(Pass pass) { return pass == Pass::flat_geometry; }
bool is_shaded(Pass pass) { return pass == Pass::geometry || pass == Pass::flat_geometry; }

// the smallest tile around both; one without pixels counts for nothing
Tile around(const Tile& a, const Tile& b) {
  if (a.width == 0 || a.height == 0) return b;
  if (b.width == 0 || b.height == 0) return a;
  const std::uint32_t x = std::min(a.x, b.x);
  const std::uint32_t y = std::min(a.y, b.y);
  return {x, y, std::max(a.x + a.width, b.x + b.width) - x,
          std::max(a.y + a.height, b.y + b.height) - y};
}

}  // namespace

void TileScene::find(const FrameScene& scene, const Tile& whole) {
  constexpr std::uint32_t kNone = ~0u;
  tile = {whole.x, whole.y, 0, 0};
  std::size_t blocks = 0;
  std::size_t count = 0;
  for (std::uint32_t v = 0; v < scene.visible.targets.size(); ++v) {
    const VisibleTarget& visible = scene.visible.targets[v];
    const std::span<const DrawItem> list = scene.state(v).items();
    TileTarget& target = count < targets.size() ? targets[count] : targets.emplace_back();
    target.visible = v;
    target.first_block = blocks;
    target.drawn.clear();
    target.classes.clear();
    const Families& brdf_models = scene.state(v).model().brdf_models;
    by_family_.assign(brdf_models.all.size(), {kNone, 0, false, false});
    for (std::uint32_t i = 0; i < visible.items.size(); ++i) {
      if (!may_touch(scene.camera, whole, 1.0, visible.boxes[i])) continue;
      const DrawItem& item = list[visible.items[i]];
      target.drawn.push_back(i);
      const std::uint32_t brdf_model = brdf_models.of_material[item.material];
      // note: of the model, not of the tile, so that all tiles and frames share their programs
      const bool cells = by_family_[brdf_model].cells || item.variant.cells;
      by_family_[brdf_model] = {brdf_model, item.material, brdf_models.materials[brdf_model] == 1,
                                cells};
    }
    target.part = touched_part(scene.camera, whole, visible.boxes, target.drawn);
    if (target.part.width == 0 || target.part.height == 0) continue;
    for (const TileTarget::ShadingClass& one : by_family_)
      if (one.brdf_model != kNone) target.classes.push_back(one);
    tile = around(tile, target.part);
    blocks += target.drawn.size();
    ++count;
  }
  targets.resize(count);
}

double triangles_on(const FrameScene& scene, const TileScene& tile) {
  double triangles = 0;
  for (const TileTarget& target : tile.targets) {
    const TargetState& state = scene.state(target.visible);
    for (const std::uint32_t k : target.drawn) {
      const DrawItem& item = state.items()[scene.visible.targets[target.visible].items[k]];
      triangles += state.model().model->meshes()[item.mesh].triangle_count;
    }
  }
  return triangles;
}

TileScene tile_scene(const FrameScene& scene, const Tile& tile) {
  TileScene out;
  out.find(scene, tile);
  return out;
}

Passes::Passes(Device::Impl& device)
    : device_(device),
      gl_(device.context->gl()),
      screen_(make_vertex_array(gl_)),
      no_pixels_(make_stream_buffer(gl_)),
      no_pixels_texture_(make_buffer_texture(gl_)),
      stream_(gl_),
      view_stride_(block_stride(gl_, sizeof(ViewBlock))),
      draw_stride_(block_stride(gl_, sizeof(DrawBlock))) {
  // Software contexts build a program again for a texture that is there and one that is not. No
  // size is a power of two: see ensure_render_target().
  constexpr std::uint32_t kNone[3] = {};
  gl_.NamedBufferData(no_pixels_.id(), sizeof kNone, kNone, GL_STREAM_DRAW);
  gl_.TextureBuffer(no_pixels_texture_.id(), GL_R32UI, no_pixels_.id());
}

GLuint Passes::program(const FrameScene& scene, const ModelResources::Impl& model, Variant variant,
                       Pass pass, bool instanced) {
  const bool places = has_places(scene);
  const LayerSet layers = model.layers_for(scene.specular_filter);
  variant.curved = variant.curved && scene.specular_filter;
  switch (pass) {
    case Pass::geometry:
      return device_.programs.geometry(variant, false, layers, places, instanced);
    case Pass::flat_geometry:
      return device_.programs.geometry(variant, true, layers, places, instanced);
    case Pass::ids:
      return device_.programs.ids(variant.cutout, instanced);
    case Pass::bare:
      return device_.programs.bare();
  }
  return 0;
}

bool Passes::prepare(const FrameScene& scene, Pass pass, DiagnosticLog& log) {
  const bool shadows = has_shadows(scene);
  for (std::size_t v = 0; v < scene.visible.targets.size(); ++v) {
    const TargetState& state = scene.state(v);
    ModelResources::Impl& model = state.resources->impl();
    if (is_flat(pass)) {
      const std::uint64_t before = model.gpu.bytes();
      const bool good = model.gpu.upload_triangle_normals(*model.model, log);
      device_.model_bytes += model.gpu.bytes() - before;
      if (!good) return false;
    }
    const std::span<const std::uint32_t> items = scene.visible.targets[v].items;
    const auto item_at = [&](std::size_t k) -> const DrawItem& { return state.items()[items[k]]; };
    const DrawItem* last = nullptr;
    for (std::size_t k = 0; k < items.size(); ++k) {
      const DrawItem& item = item_at(k);
      if (last && is_drawn_alike(*last, item)) continue;
      const bool same = last && item.variant == last->variant && item.material == last->material;
      last = &item;
      program(scene, model, item.variant, pass, false);
      // those of a tile may be fewer, and are drawn one by one then
      if (pass != Pass::bare && drawn_at_once(k, items.size(), item_at) > 1)
        program(scene, model, item.variant, pass, true);
      if (same) continue;
      if (is_shaded(pass)) {
        if (!model.gpu.decals().empty()) device_.programs.decal();
        const std::uint32_t brdf_model = model.brdf_models.of_material[item.material];
        device_.programs.classes();
        device_.programs.all_samplers();
        for (std::size_t light = 0; light < scene.lights->passes(); ++light)
          device_.programs.shading(
              model.brdf_models.all[brdf_model], model.layers_for(scene.specular_filter),
              model.brdf_models.materials[brdf_model] == 1, shadows, lit_by(scene, light > 0));
        if (shadows)
          for (const bool instanced : {false, true})
            device_.programs.shadow(item.variant.cutout, instanced);
      }
    }
  }
  return device_.programs_ready(log);
}

void Passes::upload(const FrameScene& scene, const TileScene& tile, unsigned samples, bool flat,
                    Told told) {
  // texels of imposters are samples of their pixels
  const unsigned parts = cell_parts(samples * static_cast<unsigned>(std::max(scene.pixel, 1.0)));
  ViewBlock shared = view_block(scene.camera, scene.world, tile.tile, samples);
  shared.cell_parts = static_cast<float>(parts);
  shared.flags =
      told == Told::relief || (told == Told::coverage && scene.texels > 0) ? kTellsRelief : 0;
  predicting_ = told == Told::cells;
  blocks_.clear();
  blocks_.resize(view_stride_);
  std::memcpy(blocks_.data(), &shared, sizeof shared);
  for (const DepthGroup& group : scene.visible.groups)
    for (const TileTarget& target : tile.targets) {
      if (!std::binary_search(group.targets.begin(), group.targets.end(), target.visible)) continue;
      const VisibleTarget& visible = scene.visible.targets[target.visible];
      const TargetState& state = scene.state(target.visible);
      const pan::Model& model = *state.model().model;
      const Mat3 rotation = glm::mat3_cast(scene.world[visible.target].pose().rotation);
      const Mat4 sample_from_model =
          has_places(scene) ? rigid_inverse(scene.lights->model_from_sample(target.visible))
                            : Mat4(1);
      const std::size_t first = view_stride_ + target.first_block * draw_stride_;
      blocks_.resize(std::max(blocks_.size(), first + target.drawn.size() * draw_stride_));
      for (std::size_t k = 0; k < target.drawn.size(); ++k) {
        const std::uint32_t index = visible.items[target.drawn[k]];
        const DrawItem& item = state.items()[index];
        DrawBlock block{};
        copy_floats(clip_from_mesh(scene.camera, tile.tile, group.depth,
                                   visible.boxes[target.drawn[k]].camera_from_mesh),
                    block.clip_from_mesh);
        copy_floats(rotation * item.model_normal_from_mesh, block.world_normal_from_mesh);
        block.id = visible.first_id + index + 1;
        copy_floats(item.diffuse, block.diffuse);
        copy_repeat(item, block);
        copy_cells(item.cells, model.materials()[item.material].coat_return, block);
        if (has_places(scene))
          place_samples(sample_from_model * item.model_from_mesh, model.meshes()[item.mesh], item,
                        flat, block);
        std::memcpy(blocks_.data() + first + k * draw_stride_, &block, sizeof block);
      }
    }
  // what is bound of the last blocks reaches beyond them
  const std::size_t at = stream_.upload(blocks_, kInstancesAtOnce * draw_stride_);
  gl_.BindBufferRange(GL_UNIFORM_BUFFER, kViewBinding, stream_.id(), static_cast<GLintptr>(at),
                      sizeof(ViewBlock));
  first_draw_ = at + view_stride_;
}

void Passes::bind_blocks(std::size_t first, std::size_t instances) const {
  const std::size_t blocks = instances == 1 ? 1 : kInstancesAtOnce;
  gl_.BindBufferRange(GL_UNIFORM_BUFFER, kDrawBinding, stream_.id(),
                      static_cast<GLintptr>(first_draw_ + first * draw_stride_),
                      static_cast<GLsizeiptr>(blocks * sizeof(DrawBlock)));
}

bool Passes::draw(const FrameScene& scene, const TileScene& tile, unsigned samples, Pass pass,
                  const RenderTarget& target, const Job& job,
                  const std::function<void(bool)>& clear, const PixelSet* asked) {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.id());
  gl_.Viewport(0, 0, static_cast<GLsizei>(tile.tile.width * samples),
               static_cast<GLsizei>(tile.tile.height * samples));
  gl_.Enable(GL_DEPTH_TEST);
  bool first = true;
  std::optional<ClearRegion> region;
  const auto within = [&]() {
    region.emplace(gl_, target, tile.tile.width * samples, tile.tile.height * samples);
  };
  if (clear) {
    // by groups below
  } else if (pass != Pass::bare) {
    constexpr GLuint kNothing[4] = {};
    within();
    gl_.ClearBufferuiv(GL_COLOR, 0, kNothing);
  } else {
    constexpr float kNothing[4] = {};
    within();
    gl_.ClearBufferfv(GL_COLOR, 0, kNothing);
  }
  region.reset();
  for (const DepthGroup& group : scene.visible.groups) {
    const auto belongs = [&](const TileTarget& one) {
      return std::binary_search(group.targets.begin(), group.targets.end(), one.visible);
    };
    if (std::none_of(tile.targets.begin(), tile.targets.end(), belongs)) continue;
    const float far_depth = 0;
    within();
    if (clear)
      clear(std::exchange(first, false));
    else
      gl_.ClearBufferfv(GL_DEPTH, 0, &far_depth);
    region.reset();
    for (const TileTarget& one : tile.targets)
      if (belongs(one) && !draw_items(scene, tile.tile, asked, one, pass, job)) return false;
    if (!is_shaded(pass)) continue;
    for (const TileTarget& one : tile.targets)
      if (belongs(one)) draw_decals(scene, one, target.colors[kNormalLayer]);
  }
  return !job.cancelled();
}

namespace {

// What the Sun's disc adds to the squared slope of a lobe.
float disc_width(const FrameScene& scene) {
  const light::Incidence sunlight = light::incidence(scene.world.sun(), scene.camera.position);
  return static_cast<float>(sunlight.alpha2);
}

}  // namespace

// Draws the parts of a large mesh, whose vertices are bound, that may touch the pixels.
bool Passes::draw_asked(const FrameScene& scene, const Tile& tile, const PixelSet& asked,
                        const TargetState& state, const PlacedBox& box, std::size_t mesh_index,
                        const Job& job) {
  constexpr std::uint32_t kThis[] = {0};
  const ModelResources::Impl& model = state.model();
  const pan::layout::Mesh& mesh = model.model->meshes()[mesh_index];
  std::uint64_t first = 0, count = 0;
  for (const MeshRun& run : runs_.find(state.resources, *model.model, mesh_index)) {
    const PlacedBox placed{box.camera_from_mesh, run.box.low, run.box.high};
    if (!asked.any(touched_part(scene.camera, tile, {&placed, 1}, kThis))) continue;
    if (first + count == run.first) {
      count += run.count;
      continue;
    }
    if (!model.gpu.draw(mesh, mesh_index, 1, job, first, count)) return false;
    first = run.first;
    count = run.count;
  }
  return model.gpu.draw(mesh, mesh_index, 1, job, first, count);
}

bool Passes::draw_items(const FrameScene& scene, const Tile& tile, const PixelSet* asked,
                        const TileTarget& target, Pass pass, const Job& job) {
  constexpr std::uint64_t kLargeMesh = 1 << 12;  // triangles
  const TargetState& state = scene.state(target.visible);
  const ModelResources::Impl& model = state.model();
  const VisibleTarget& visible = scene.visible.targets[target.visible];
  const auto item_at = [&](std::size_t k) -> const DrawItem& {
    return state.items()[visible.items[target.drawn[k]]];
  };
  const DrawItem* last = nullptr;
  bool were_instanced = false;
  std::size_t at_once = 1;
  for (std::size_t k = 0; k < target.drawn.size(); k += at_once) {
    at_once = pass == Pass::bare ? 1 : drawn_at_once(k, target.drawn.size(), item_at);
    const bool instanced = at_once > 1;
    const std::uint32_t index = visible.items[target.drawn[k]];
    const DrawItem& item = item_at(k);
    const pan::layout::Mesh& mesh = model.model->meshes()[item.mesh];
    const bool other_program =
        !last || item.variant != last->variant || instanced != were_instanced;
    if (other_program) gl_.UseProgram(program(scene, model, item.variant, pass, instanced));
    if (pass == Pass::geometry && scene.specular_filter && item.variant.curved &&
        (other_program || item.material != last->material))
      gl_.Uniform2f(kNarrowestLobeLocation, static_cast<float>(item.lobe), disc_width(scene));
    if (!last || item.sides != last->sides) cull(gl_, item.sides);
    // note: rows grow downwards in the window, which turns every triangle round once
    if (!last || item.mirrored != last->mirrored) gl_.FrontFace(item.mirrored ? GL_CCW : GL_CW);
    if (!last || item.texture != last->texture || item.material != last->material ||
        item.mesh != last->mesh)
      model.gpu.bind_maps(index);
    if (!last || item.mesh != last->mesh) model.gpu.bind_vertices(mesh, item.mesh);
    bind_blocks(target.first_block + k, at_once);
    const auto done = [&] {
      if (is_flat(pass)) return model.gpu.draw_flat(mesh, item.mesh, at_once, job);
      if (pass == Pass::ids) return model.gpu.draw_whole(mesh, item.mesh, at_once, job);
      if (asked && !instanced && mesh.triangle_count >= kLargeMesh)
        return draw_asked(scene, tile, *asked, state, visible.boxes[target.drawn[k]], item.mesh,
                          job);
      return model.gpu.draw(mesh, item.mesh, at_once, job, 0, mesh.triangle_count);
    };
    if (!done()) return false;
    last = &item;
    were_instanced = instanced;
  }
  return true;
}

// lays images over the colours of what is seen
void Passes::draw_decals(const FrameScene& scene, const TileTarget& target, const GlTexture& seen) {
  const TargetState& state = scene.state(target.visible);
  const ModelResources::Impl& model = state.model();
  if (model.gpu.decals().empty()) return;
  const VisibleTarget& visible = scene.visible.targets[target.visible];
  places_.assign(state.items().size(), ~0u);  // of an item in target.drawn
  for (std::uint32_t k = 0; k < target.drawn.size(); ++k)
    places_[visible.items[target.drawn[k]]] = k;
  gl_.UseProgram(device_.programs.decal());
  // whose the sample is, is read from a layer of the framebuffer: the barrier makes that sound
  gl_.BindTextureUnit(kLayerUnits[kNormalLayer], seen.id());
  gl_.TextureBarrier();
  // every program puts a vertex on the same spot, so what is seen has the very depth that is there
  gl_.DepthFunc(GL_EQUAL);
  gl_.DepthMask(GL_FALSE);
  for (GLuint layer = 0; layer < kLayers; ++layer) {
    const GLboolean albedo = layer == kAlbedoLayer;
    gl_.ColorMaski(layer, albedo, albedo, albedo, GL_FALSE);
  }
  gl_.Enablei(GL_BLEND, kAlbedoLayer);
  gl_.BlendFunci(kAlbedoLayer, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  const DrawItem* last = nullptr;
  for (std::size_t i = 0; i < model.gpu.decals().size(); ++i) {
    const std::uint32_t k = places_[model.gpu.decals()[i].item];
    if (k == ~0u) continue;
    const DrawItem& item = state.items()[model.gpu.decals()[i].item];
    if (&item != last) {
      cull(gl_, item.sides);
      gl_.FrontFace(item.mirrored ? GL_CCW : GL_CW);
      model.gpu.bind_vertices(model.model->meshes()[item.mesh], item.mesh);
      bind_blocks(target.first_block + k, 1);
    }
    model.gpu.draw_decal(i);
    last = &item;
  }
  gl_.Disablei(GL_BLEND, kAlbedoLayer);
  gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_.DepthMask(GL_TRUE);
  gl_.DepthFunc(GL_GREATER);
}

void Passes::scissor(const Tile& tile, const Tile& part, unsigned samples) const {
  const auto sample = [&](std::uint32_t pixels) { return static_cast<GLint>(pixels * samples); };
  gl_.Scissor(sample(part.x - tile.x), sample(part.y - tile.y), sample(part.width),
              sample(part.height));
}

// Adds one light to a target. Expects: its blocks and maps bound.
//
//   first_class  of classes.frag
//   added        to a light before it
void Passes::shade_target(const FrameScene& scene, const TileTarget& target, unsigned samples,
                          std::uint32_t a_row, GLuint first_class, bool added) {
  const ModelResources::Impl& model = scene.state(target.visible).model();
  model.gpu.bind_materials();
  for (const TileTarget::ShadingClass& one : target.classes) {
    if (one.one_material) model.gpu.bind_one_material(one.material);
    gl_.UseProgram(device_.programs.shading(
        model.brdf_models.all[one.brdf_model], model.layers_for(scene.specular_filter),
        one.one_material, has_shadows(scene), lit_by(scene, added)));
    gl_.Uniform4ui(kItemRangeLocation, scene.visible.targets[target.visible].first_id, 0, 0, 0);
    gl_.Uniform2ui(kSampleBlocksLocation, samples, a_row);
    gl_.Uniform1f(kScreenDepthLocation,
                  static_cast<float>(first_class + one.brdf_model + 1) * (1.0f / 1048576.0f));
    gl_.DrawArrays(GL_TRIANGLES, 0, 3);
    if (!predicting_ || !one.cells) continue;
    // a draw of its own: a loop in the program would cost every other draw a seventh of its time
    gl_.Uniform4ui(kItemRangeLocation, scene.visible.targets[target.visible].first_id, 0, 0, 1);
    gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  }
}

// Leaves all samplers as those of textures that are read by texels: see all_samplers.frag.
void Passes::settle_samplers() {
  std::array<GLint, 16> units;
  units.fill(static_cast<GLint>(kLayerUnits[kNormalLayer]));
  const GLuint program = device_.programs.all_samplers();
  gl_.UseProgram(program);
  gl_.Uniform1iv(gl_.GetUniformLocation(program, "textures"), units.size(), units.data());
  gl_.Scissor(0, 0, 0, 0);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
}

void Passes::shade(const FrameScene& scene, const TileScene& tile, unsigned samples,
                   const RenderTarget& g_buffer, const RenderTarget& color, const Blocks& blocks) {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, color.framebuffer.id());
  const bool apart = blocks.a_row > 0;
  const Tile window{0, 0, apart ? blocks.a_row : tile.tile.width,
                    apart ? blocks.rows : tile.tile.height};
  gl_.Viewport(0, 0, static_cast<GLsizei>(window.width * samples),
               static_cast<GLsizei>(window.height * samples));
  gl_.BindTextureUnit(kPixelPlacesUnit, apart ? blocks.pixels : no_pixels_texture_.id());
  gl_.Enable(GL_DEPTH_TEST);
  gl_.Disable(GL_CULL_FACE);
  for (unsigned layer = 0; layer < kLayers; ++layer)
    if (g_buffer.colors[layer])
      gl_.BindTextureUnit(kLayerUnits[layer], g_buffer.colors[layer].id());
  gl_.BindVertexArray(screen_.id());
  gl_.Enable(GL_SCISSOR_TEST);
  settle_samplers();
  // Where no class is asked for, the depth test leaves nothing to run. Nothing is cleared before:
  // the first target writes the whole window.
  GLuint first_class = 0;
  first_classes_.clear();
  gl_.DepthFunc(GL_ALWAYS);
  gl_.UseProgram(device_.programs.classes());
  for (const TileTarget& target : tile.targets) {
    const ModelResources::Impl& model = scene.state(target.visible).model();
    const bool first = first_classes_.empty();
    apart ? scissor(window, window, samples)
          : scissor(tile.tile, first ? tile.tile : target.part, samples);
    model.gpu.bind_items();
    gl_.Uniform2ui(kSampleBlocksLocation, samples, blocks.a_row);
    gl_.Uniform4ui(kItemRangeLocation, scene.visible.targets[target.visible].first_id,
                   static_cast<GLuint>(scene.state(target.visible).items().size()), first_class,
                   first);
    gl_.DrawArrays(GL_TRIANGLES, 0, 3);
    first_classes_.push_back(first_class);
    first_class += static_cast<GLuint>(model.brdf_models.all.size());
  }
  gl_.DepthFunc(GL_EQUAL);
  gl_.DepthMask(GL_FALSE);
  // every draw adds, the first to the black of the classes: software contexts build a program anew
  // without
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_ONE, GL_ONE);
  for (std::size_t light = 0; light < scene.lights->passes(); ++light) {
    for (std::size_t t = 0; t < tile.targets.size(); ++t) {
      const TileTarget& target = tile.targets[t];
      if (!scene.lights->lights(light, target.visible)) continue;
      apart ? scissor(window, window, samples) : scissor(tile.tile, target.part, samples);
      scene.lights->bind(gl_, light, target.visible);
      shade_target(scene, target, samples, blocks.a_row, first_classes_[t], light > 0);
    }
  }
  gl_.Disable(GL_BLEND);
  gl_.DepthFunc(GL_GREATER);
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_SCISSOR_TEST);
}

}  // namespace panwright::preview
