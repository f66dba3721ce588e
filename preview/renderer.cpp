#include "preview/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>

#include "preview/internal/passes.h"
#include "preview/internal/samples.h"
#include "preview/internal/truth.h"

namespace panwright::preview {
namespace {

// the largest side of an image, as the largest framebuffers of common contexts
constexpr std::uint32_t kMaxSide = 16384;

// items are told apart by floats, which count exactly to 2^24
constexpr std::uint64_t kMostItems = (1u << 24) - 1;

[[maybe_unused]] bool is_sound(const world::Camera& camera, const RenderOptions& options) {
  const auto unit = [](const Quat& q) { return std::fabs(glm::dot(q, q) - 1) < 1e-6; };
  return camera.width > 0 && camera.height > 0 && camera.focal.x > 0 && camera.focal.y > 0 &&
         std::isfinite(camera.focal.x + camera.focal.y) && is_finite(camera.position) &&
         std::isfinite(camera.principal.x + camera.principal.y) && unit(camera.world_from_camera) &&
         options.samples >= 1 && options.samples <= 64 && options.tile_side >= options.samples &&
         (options.shadow_side == 0 ||
          (options.shadow_side >= 16 && options.shadow_side <= kMaxSide));
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
  explicit Impl(std::shared_ptr<Device> device_in)
      : device(std::move(device_in)), shared(device->impl()), gl(shared.context->gl()) {}
  ~Impl() { shared.context->make_current(); }  // the members delete their objects

  void set_state() const;
  bool ensure_target(RenderTarget& target, std::span<const GLenum> formats, bool depth,
                     std::uint32_t width, std::uint32_t height, DiagnosticLog& log);
  bool fits(const world::World& world, const world::Camera& camera, const RenderOptions& options,
            DiagnosticLog& log) const;
  Result<VisibleSet> look(const world::World& world, const world::Camera& camera,
                          DiagnosticLog& log);
  bool render_radiance(FrameScene scene, const RenderOptions& options, Image& image,
                       DiagnosticLog& log);
  bool is_cancelled(DiagnosticLog& log) const;  // reports E0001 then
  bool render_truth(const FrameScene& scene, const RenderOptions& options, Image& image,
                    DiagnosticLog& log);

  std::shared_ptr<Device> device;
  Device::Impl& shared;
  const GladGLContext& gl;
  TargetStates states;
  ShadowMaps shadow_maps;
  std::unique_ptr<Passes> passes;  // made when the context is current first
  RenderTarget seen_target;        // what Layer names
  RenderTarget color_target;       // radiance
  RenderTarget id_target;          // triangles
  RenderTarget bare_target;        // of seconds_of_bare_draw
  std::vector<float> sample_buffer;
  Job job;  // of the image under way
};

bool Renderer::Impl::is_cancelled(DiagnosticLog& log) const {
  if (job.cancelled()) report_cancelled(log);
  return job.cancelled();
}

Renderer::Renderer(std::shared_ptr<Device> device)
    : impl_(std::make_unique<Impl>(std::move(device))) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

const std::shared_ptr<Device>& Renderer::device() const { return impl_->device; }

Renderer::Counts Renderer::counts() const {
  return {impl_->states.placed(), impl_->shadow_maps.drawn()};
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

bool Renderer::Impl::ensure_target(RenderTarget& target, std::span<const GLenum> formats,
                                   bool depth, std::uint32_t width, std::uint32_t height,
                                   DiagnosticLog& log) {
  const auto w = static_cast<GLsizei>(width);
  const auto h = static_cast<GLsizei>(height);
  bool enough = target.width >= w && target.height >= h;
  std::vector<GLenum> all(formats.begin(), formats.end());
  for (std::size_t i = 0; i < formats.size(); ++i) {
    enough = enough && (formats[i] == GL_NONE || target.colors[i]);
    // what another world needed stays, or two in turn would make it anew each time
    if (all[i] == GL_NONE && target.width != 0) all[i] = target.formats[i];
  }
  if (enough) return true;
  const GLsizei wider = std::max(w, target.width);
  const GLsizei higher = std::max(h, target.height);
  target = {};  // first, so that memory need not hold both
  target = make_render_target(gl, all, depth, wider, higher);
  if (target.width != 0 && gl.GetError() == GL_NO_ERROR) return true;
  target = {};
  log.report_file(Code::E5003, {},
                  fmt::format("the context has no memory for a framebuffer of {} by {} samples",
                              wider, higher));
  return false;
}

Result<VisibleSet> Renderer::Impl::look(const world::World& world, const world::Camera& camera,
                                        DiagnosticLog& log) {
  if (!states.update(world, *device, log)) return failed;
  std::vector<TargetShape> shapes;
  std::uint64_t items = 0;
  for (std::size_t i = 0; i < world.size(); ++i) {
    const TargetState& state = states[i];
    const auto count = static_cast<std::uint32_t>(world[i].model()->instances().size());
    shapes.push_back(
        {&world[i].pose(), state.bounds ? &*state.bounds : nullptr, state.items, count});
    items += count;
  }
  if (items > kMostItems) {
    log.report_file(Code::E5003, {},
                    fmt::format("the targets of the world have {} instances in all; one image "
                                "takes {}",
                                items, kMostItems));
    return failed;
  }
  return visible_set(camera, shapes);
}

bool Renderer::Impl::render_radiance(FrameScene scene, const RenderOptions& options, Image& image,
                                     DiagnosticLog& log) {
  if (scene.visible.targets.empty()) return true;  // the image begins as background
  const Pass pass = options.flat ? Pass::flat_geometry : Pass::geometry;
  const std::uint32_t side = std::min(options.tile_side, shared.context->limits().framebuffer_side);
  const std::uint32_t tile_side = std::max(1u, side / options.samples);
  const std::uint32_t width = std::min(tile_side, image.width) * options.samples;
  const std::uint32_t height = std::min(tile_side, image.height) * options.samples;
  LayerSet layers = 0;
  std::vector<std::uint32_t> seen;
  for (std::size_t v = 0; v < scene.visible.targets.size(); ++v) {
    layers |= scene.state(v).model().layers;
    seen.push_back(scene.visible.targets[v].target);
  }
  const bool shadows = options.shadow_side > 0;
  const auto formats = layer_formats(layers, shadows);
  if (!ensure_target(seen_target, formats, true, width, height, log) ||
      !ensure_target(color_target, kRadianceFormats, true, width, height, log))
    return false;
  if (shadows) scene.shadows = &shadow_maps;
  if (!passes->prepare(scene, pass, log)) return false;
  if (shadows && !shadow_maps.update(shared, scene.world, scene.states, seen, options.shadow_side,
                                     options.max_shadow_bytes, log))
    return false;
  // kept between views: fresh memory costs as much as a tenth of a draw
  sample_buffer.resize(std::max(sample_buffer.size(), std::size_t{4} * width * height));
  for (const Tile& whole : tiles(image.width, image.height, tile_side)) {
    const TileScene on_tile = tile_scene(scene, whole);
    const Tile& tile = on_tile.tile;
    if (tile.width == 0 || tile.height == 0) continue;
    if (is_cancelled(log)) return false;
    passes->upload(scene, on_tile, options.samples, options.flat);
    passes->draw(scene, on_tile, options.samples, pass, seen_target);
    passes->shade(scene, on_tile, options.samples, seen_target, color_target);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl.ReadPixels(0, 0, static_cast<GLsizei>(tile.width * options.samples),
                  static_cast<GLsizei>(tile.height * options.samples), GL_RGBA, GL_FLOAT,
                  sample_buffer.data());
    average_samples(sample_buffer, tile, options.samples, image);
  }
  if (shared.went_well(log)) return true;
  shadow_maps.forget();  // what failed may have been one of them
  return false;
}

bool Renderer::Impl::render_truth(const FrameScene& scene, const RenderOptions& options,
                                  Image& image, DiagnosticLog& log) {
  if (scene.visible.targets.empty()) return true;
  const std::uint32_t side = std::min(options.tile_side, shared.context->limits().framebuffer_side);
  const std::uint32_t width = std::min(side, image.width);
  const std::uint32_t height = std::min(side, image.height);
  constexpr GLenum kFormats[] = {GL_RG32UI};
  if (!ensure_target(id_target, kFormats, true, width, height, log) ||
      !passes->prepare(scene, Pass::ids, log))
    return false;
  std::vector<TriangleId> ids(std::size_t{width} * height);
  static_assert(sizeof(TriangleId) == 8);
  std::vector<TruthTarget> targets;
  for (std::size_t v = 0; v < scene.visible.targets.size(); ++v) {
    const VisibleTarget& visible = scene.visible.targets[v];
    targets.push_back(truth_target(*scene.state(v).model().model, scene.state(v).items, visible,
                                   scene.world[visible.target].pose()));
  }
  for (const Tile& whole : tiles(image.width, image.height, side)) {
    const TileScene on_tile = tile_scene(scene, whole);
    const Tile& tile = on_tile.tile;
    if (tile.width == 0 || tile.height == 0) continue;
    if (is_cancelled(log)) return false;
    passes->upload(scene, on_tile, 1, options.flat);
    passes->draw(scene, on_tile, 1, Pass::ids, id_target);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl.ReadPixels(0, 0, static_cast<GLsizei>(tile.width), static_cast<GLsizei>(tile.height),
                  GL_RG_INTEGER, GL_UNSIGNED_INT, ids.data());
    if (!shared.went_well(log)) return false;  // before ids are used as indices
    fill_truth(scene.camera, options.flat, targets, tile, ids, image);
  }
  return true;
}

bool Renderer::Impl::fits(const world::World& world, const world::Camera& camera,
                          const RenderOptions& options, DiagnosticLog& log) const {
  (void)world;
  if (camera.width > kMaxSide || camera.height > kMaxSide) {
    log.report_file(Code::E5003, {},
                    fmt::format("an image of {} by {} pixels, expected at most {} a side",
                                camera.width, camera.height, kMaxSide));
    return false;
  }
  const std::uint64_t bytes =
      std::uint64_t{camera.width} * camera.height * (options.truth ? 48 : 16);
  if (bytes <= options.max_bytes) return true;
  log.report_file(
      Code::E5003, {},
      fmt::format("an image of {} by {} pixels takes {:.4g} MiB; the limit is {:.4g} MiB",
                  camera.width, camera.height, static_cast<double>(bytes) / 0x1p20,
                  static_cast<double>(options.max_bytes) / 0x1p20));
  return false;
}

Result<Image> Renderer::render(const world::World& world, const world::Camera& camera,
                               const RenderOptions& options, DiagnosticLog& log, const Job& job) {
  assert(is_sound(camera, options));
  Impl& impl = *impl_;
  impl.job = job;
  if (!impl.fits(world, camera, options, log) || !impl.shared.ready(log)) return failed;
  if (!impl.passes) impl.passes = std::make_unique<Passes>(impl.shared);
  impl.set_state();
  auto visible = impl.look(world, camera, log);
  if (!visible) return failed;
  Image image;
  image.width = camera.width;
  image.height = camera.height;
  image.unit = world.sun().irradiance ? "W/(m^2 sr)" : "1/sr";
  image.radiance.resize(3 * image.pixels());
  image.coverage.resize(image.pixels());
  const FrameScene scene{world, camera, impl.states, *visible};
  if (!impl.render_radiance(scene, options, image, log)) return failed;
  if (options.truth) {
    image.depth.resize(image.pixels(), INFINITY);
    image.range.resize(image.pixels(), INFINITY);
    image.normal.resize(3 * image.pixels());
    image.target_id.resize(image.pixels());
    image.node_id.resize(image.pixels());
    image.material_id.resize(image.pixels());
    if (!impl.render_truth(scene, options, image, log)) return failed;
  }
  if (std::any_of(image.coverage.begin(), image.coverage.end(), [](float a) { return a != 0; }))
    return image;
  const char* why =
      "nothing is in view: what lies inside the image fell between the samples (--samples takes "
      "more), or the camera is inside a closed mesh, which shows its outside only";
  if (visible->targets.empty())
    why = "nothing is in view: no part of the model lies inside the image";
  if (world.size() > 1 && visible->targets.empty())
    why = "nothing is in view: no part of a target lies inside the image";
  bool any = false;
  for (std::size_t i = 0; i < world.size(); ++i) any = any || impl.states[i].bounds;
  if (world.empty())
    why = "nothing is in view: the world has no targets";
  else if (!any)
    why = "nothing is in view: nothing of the targets is visible";
  log.report_file(Code::W5006, {}, why);
  return image;
}

double Renderer::seconds_of_bare_draw(const world::World& world, const world::Camera& camera) {
  Impl& impl = *impl_;
  DiagnosticLog log;
  if (!impl.shared.ready(log)) return 0;
  if (!impl.passes) impl.passes = std::make_unique<Passes>(impl.shared);
  impl.set_state();
  const auto visible = impl.look(world, camera, log);
  const Tile whole{0, 0, camera.width, camera.height};
  constexpr GLenum kFormats[] = {GL_RGBA32F};
  if (!visible ||
      !impl.ensure_target(impl.bare_target, kFormats, true, whole.width, whole.height, log))
    return 0;
  const FrameScene scene{world, camera, impl.states, *visible};
  if (!impl.passes->prepare(scene, Pass::bare, log)) return 0;
  impl.gl.Finish();
  const auto start = std::chrono::steady_clock::now();
  TileScene tile = tile_scene(scene, whole);
  tile.tile = whole;
  impl.passes->upload(scene, tile, 1, false);
  impl.passes->draw(scene, tile, 1, Pass::bare, impl.bare_target);
  impl.gl.Finish();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace panwright::preview
