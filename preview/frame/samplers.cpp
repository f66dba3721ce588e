#include "preview/frame/samplers.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <vector>

#include "base/clock.h"
#include "preview/frame/samples.h"

namespace panwright::preview {

namespace {

constexpr GLenum kSampleFormats[] = {GL_RGBA32F};

// What is in view of no more pixels than this, along a side, has its errors stated with a given N.
constexpr std::uint32_t kStatedPixels = 128;

std::array<GLenum, kLayers> layer_formats(LayerSet layers, bool places) {
  std::array<GLenum, kLayers> formats{};
  if (places) layers |= 1u << kPositionLayer;
  for (unsigned layer = 0; layer < kLayers; ++layer)
    if (has(layers, Layer{layer}))
      formats[layer] = kLayerHasIntegers[layer] ? GL_RGBA32UI : GL_RGBA32F;
  return formats;
}

}  // namespace

Samplers::Samplers(Device::Impl& device)
    : device_(device),
      gl_(device.context->gl()),
      passes_(device),
      sampling_(device, passes_, g_buffer_, color_) {}

void Samplers::begin_image(const world::World& world, const world::Camera& camera,
                           const RenderOptions& options) {
  lights_.begin_image(world, camera, options);
}

Samplers::TileSize Samplers::tile_size(const RenderOptions& options, unsigned samples,
                                       const image::Image& image) const {
  const std::uint32_t most =
      std::min(options.tile_side, device_.context->limits().framebuffer_side);
  const std::uint32_t side = std::max(1u, most / std::max(1u, samples));
  return {side, std::min(side, image.width), std::min(side, image.height)};
}

bool Samplers::radiance(FrameScene scene, const RenderOptions& options, FramesInFlight& frames,
                        FrameUnderWay& frame, DiagnosticLog& log, const Job& job) {
  if (scene.visible.targets.empty()) {
    clear_around({0, 0, frame.image.width, frame.image.height}, {}, frame.image);
    return true;
  }
  // where samples go by their errors, errors are to be seen
  scene.specular_filter = options.specular_filter && options.samples > 0 && !options.adaptive;
  const Pass pass = options.flat ? Pass::flat_geometry : Pass::geometry;
  const TileSize size = tile_size(options, options.samples, frame.image);
  const std::uint32_t width = size.width * options.samples;
  const std::uint32_t height = size.height * options.samples;
  LayerSet layers = 0;
  for (std::size_t v = 0; v < scene.visible.targets.size(); ++v)
    layers |= scene.state(v).model().layers_for(scene.specular_filter);
  lights_.begin_scene(scene, options);
  scene.lights = &lights_;
  const auto formats = layer_formats(layers, lights_.placed());
  const bool by_errors = options.samples == 0 || (options.adaptive && options.samples > 1);
  if (!by_errors &&
      (!ensure_target(gl_, g_buffer_, formats, width, height, log) ||
       (options.samples > 1 && !ensure_target(gl_, color_, kSampleFormats, width, height, log))))
    return false;
  if (!passes_.prepare(scene, pass, log) || !lights_.update(device_, scene, frame.report, log, job))
    return false;
  if (by_errors) return adaptive(scene, options, formats, frame, log, job);
  return in_full(scene, options, pass, size, frames, frame, log, job);
}

// N×N samples in every pixel.
bool Samplers::in_full(const FrameScene& scene, const RenderOptions& options, Pass pass,
                       const TileSize& size, FramesInFlight& frames, FrameUnderWay& frame,
                       DiagnosticLog& log, const Job& job) {
  const unsigned samples = options.samples;
  // of an image's small targets; of odd N there are no four grids
  on_tile_.find(scene, {0, 0, frame.image.width, frame.image.height});
  const bool states = scene.texels == 0 && samples > 0 && samples % 2 == 0 &&
                      std::max(on_tile_.tile.width, on_tile_.tile.height) <= kStatedPixels;
  Sampling::Sums sums;
  for (Tiles whole(frame.image.width, frame.image.height, size.side); whole; whole.next()) {
    on_tile_.find(scene, *whole);
    const Tile& tile = on_tile_.tile;
    if (tile.width == 0 || tile.height == 0) {
      clear_around(*whole, {}, frame.image);
      continue;
    }
    RenderTarget* pixels = frames.target(TileKind::radiance, size.width, size.height, log, job);
    if (!pixels) return false;
    passes_.upload(scene, on_tile_, samples, options.flat);
    if (!passes_.draw(scene, on_tile_, samples, pass, g_buffer_, job))
      return report_failure(device_, ReadBack::Wait::cancelled, log);
    if (!device_.read_through_buffers) {
      // shading waits for the geometry there; here a job that is cancelled is heard
      const auto drawn = wait_until_drawn(gl_, job);
      if (drawn != ReadBack::Wait::done) return report_failure(device_, drawn, log);
    }
    passes_.shade(scene, on_tile_, samples, g_buffer_, samples > 1 ? color_ : *pixels);
    if (states && !sampling_.add_errors(tile.width, tile.height, samples, sums, log)) return false;
    if (samples > 1 && !sampling_.resolve(*pixels, tile.width, tile.height, samples, false, log))
      return false;
    if (!frames.submit(TileKind::radiance, frame, *whole, tile, log)) {
      lights_.forget();  // what failed may have been one of them
      return false;
    }
  }
  if (states) sums.state(frame.report);
  return true;
}

// An image whose samples stand where they change it: it is whole at once.
bool Samplers::adaptive(const FrameScene& scene, const RenderOptions& options,
                        std::span<const GLenum> formats, FrameUnderWay& frame, DiagnosticLog& log,
                        const Job& job) {
  image::Image& image = frame.image;
  clear_around({0, 0, image.width, image.height}, {}, image);
  if (!sampling_.render(scene, options, formats, image, job, log)) return false;
  const SamplingReport& sampled = sampling_.report();
  frame.report.samples += sampled.samples;
  frame.report.rmse = sampled.rmse;
  frame.report.flux = sampled.flux;
  frame.report.limited = sampled.limited;
  if (device_.went_well(log)) return true;
  lights_.forget();  // what failed may have been one of them
  return false;
}

bool Samplers::truth(const FrameScene& scene, const RenderOptions& options, FramesInFlight& frames,
                     FrameUnderWay& frame, DiagnosticLog& log, const Job& job) {
  std::vector<GroundTruthTarget>& targets = frame.targets;
  targets.resize(scene.visible.targets.size());
  if (targets.empty()) return true;
  const TileSize size = tile_size(options, 1, frame.image);
  if (!passes_.prepare(scene, Pass::ids, log)) return false;
  for (std::size_t v = 0; v < targets.size(); ++v) {
    const VisibleTarget& visible = scene.visible.targets[v];
    set_truth_target(targets[v], scene.state(v).model().model, scene.state(v).placed, visible,
                     scene.world[visible.target].pose());
  }
  for (Tiles whole(frame.image.width, frame.image.height, size.side); whole; whole.next()) {
    on_tile_.find(scene, *whole);
    const Tile& tile = on_tile_.tile;
    if (tile.width == 0 || tile.height == 0) continue;
    RenderTarget* target = frames.target(TileKind::ids, size.width, size.height, log, job);
    if (!target) return false;
    passes_.upload(scene, on_tile_, 1, options.flat);
    if (!passes_.draw(scene, on_tile_, 1, Pass::ids, *target, job))
      return report_failure(device_, ReadBack::Wait::cancelled, log);
    if (!frames.submit(TileKind::ids, frame, *whole, tile, log)) return false;
  }
  return true;
}

double Samplers::seconds_of_bare_draw(const FrameScene& scene, DiagnosticLog& log) {
  const Tile whole{0, 0, scene.camera.width, scene.camera.height};
  if (!ensure_target(gl_, bare_, kSampleFormats, whole.width, whole.height, log) ||
      !passes_.prepare(scene, Pass::bare, log))
    return 0;
  gl_.Finish();
  const auto start = std::chrono::steady_clock::now();
  on_tile_.find(scene, whole);
  on_tile_.tile = whole;
  passes_.upload(scene, on_tile_, 1, false);
  passes_.draw(scene, on_tile_, 1, Pass::bare, bare_, {});
  gl_.Finish();
  return seconds_since(start);
}

}  // namespace panwright::preview
