// Tiles of an image: drawn, read back and put into the image.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "preview/frame/renderer_impl.h"

namespace panwright::preview {

namespace {

constexpr GLenum kRadianceFormats[] = {GL_RGBA32F};

constexpr GLenum kIdFormats[] = {GL_RG32UI};

std::array<GLenum, kLayers> layer_formats(LayerSet layers, bool shadows) {
  std::array<GLenum, kLayers> formats{};
  if (shadows) layers |= 1u << kPositionLayer;
  for (unsigned layer = 0; layer < kLayers; ++layer)
    if (has(layers, Layer{layer}))
      formats[layer] = kLayerHasIntegers[layer] ? GL_RGBA32UI : GL_RGBA32F;
  return formats;
}

}  // namespace

bool Renderer::Impl::is_cancelled(DiagnosticLog& log) const {
  if (job.cancelled()) report_cancelled(log);
  return job.cancelled();
}

bool Renderer::Impl::fail(ReadBack::Wait why, DiagnosticLog& log) {
  if (why == ReadBack::Wait::cancelled)
    report_cancelled(log);
  else if (shared.went_well(log))
    log.report_file(Code::E5003, {}, "the context failed while it drew");
  return false;
}

// the mean of the samples of a tile, or what its triangles say
void Renderer::Impl::use_tile(const Ring& ring, const TileUnderWay& tile, const void* pixels) {
  Frame& frame = frames[tile.frame];
  if (&ring == &*ids) {
    fill_ground_truth(
        frame.camera, frame.flat, frame.targets, tile.tile,
        {static_cast<const TriangleId*>(pixels), std::size_t{tile.tile.width} * tile.tile.height},
        frame.image);
    return;
  }
  const std::size_t count = std::size_t{4} * tile.tile.width * tile.tile.height;
  store_pixels({static_cast<const float*>(pixels), count}, tile.tile, frame.image);
  clear_around(tile.whole, tile.tile, frame.image);
}

// Waits for the oldest tile of a kind and puts it into its image.
bool Renderer::Impl::take_tile(Ring& ring, DiagnosticLog& log) {
  const TileUnderWay& tile = ring.tiles[ring.pixels.oldest()];
  const auto use = [&](const void* pixels) { use_tile(ring, tile, pixels); };
  const auto result = ring.pixels.take(job, std::ref(use));
  if (result != ReadBack::Wait::done) return fail(result, log);
  --frames[tile.frame].tiles;
  return true;
}

bool Renderer::Impl::make_room(Ring& ring, DiagnosticLog& log) {
  return !ring.pixels.full() || take_tile(ring, log);
}

bool Renderer::Impl::submit_tile(Ring& ring, const TileUnderWay& tile, DiagnosticLog& log) {
  ring.tiles[ring.pixels.next()] = tile;
  const bool good = ring.pixels.submit(tile.tile.width, tile.tile.height);
  if (good) ++frames[tile.frame].tiles;
  // before more is drawn: a lost context takes nothing
  return shared.went_well(log) && (good || fail(ReadBack::Wait::failed, log));
}

bool Renderer::Impl::submit_radiance(FrameScene scene, const RenderOptions& options,
                                     std::size_t frame, DiagnosticLog& log) {
  const image::Image& image = frames[frame].image;
  if (scene.visible.targets.empty()) {
    const Tile whole{0, 0, image.width, image.height};
    clear_around(whole, {}, frames[frame].image);
    return true;
  }
  // where samples go by their errors, errors are to be seen
  scene.specular_filter = options.specular_filter && options.samples > 0 && !options.adaptive;
  const Pass pass = options.flat ? Pass::flat_geometry : Pass::geometry;
  const std::uint32_t side = std::min(options.tile_side, shared.context->limits().framebuffer_side);
  // note: 0 samples never come as far as the tiles below
  const std::uint32_t tile_side = std::max(1u, side / std::max(1u, options.samples));
  const std::uint32_t width = std::min(tile_side, image.width) * options.samples;
  const std::uint32_t height = std::min(tile_side, image.height) * options.samples;
  LayerSet layers = 0;
  for (std::size_t v = 0; v < scene.visible.targets.size(); ++v)
    layers |= scene.state(v).model().layers_for(scene.specular_filter);
  lights.begin_scene(scene, options);
  scene.lights = &lights;
  const auto formats = layer_formats(layers, lights.shadows());
  const bool adaptive = options.samples == 0 || (options.adaptive && options.samples > 1);
  if (!adaptive && (!ensure_target(g_buffer, formats, true, width, height, log) ||
                    (options.samples > 1 &&
                     !ensure_target(color_target, kRadianceFormats, true, width, height, log))))
    return false;
  if (!passes->prepare(scene, pass, log) ||
      !lights.update(shared, scene, frames[frame].report, log, job))
    return false;
  if (adaptive) return sampled(scene, options, formats, frame, log);
  for (Tiles whole(image.width, image.height, tile_side); whole; whole.next()) {
    on_tile.find(scene, *whole);
    const Tile& tile = on_tile.tile;
    if (tile.width == 0 || tile.height == 0) {
      clear_around(*whole, {}, frames[frame].image);
      continue;
    }
    if (is_cancelled(log) || !make_room(*radiance, log)) return false;
    RenderTarget& pixels = radiance->pixels.target();
    if (!ensure_target(pixels, kRadianceFormats, true, std::min(tile_side, image.width),
                       std::min(tile_side, image.height), log))
      return false;
    passes->upload(scene, on_tile, options.samples, options.flat);
    if (!passes->draw(scene, on_tile, options.samples, pass, g_buffer, job))
      return fail(ReadBack::Wait::cancelled, log);
    if (!shared.read_through_buffers) {
      // shading waits for the geometry there; here a job that is cancelled is heard
      const auto drawn = wait_until_drawn(gl, job);
      if (drawn != ReadBack::Wait::done) return fail(drawn, log);
    }
    passes->shade(scene, on_tile, options.samples, g_buffer,
                  options.samples > 1 ? color_target : pixels);
    if (options.samples > 1 &&
        !sampling->resolve(pixels, tile.width, tile.height, options.samples, false, log))
      return false;
    if (!submit_tile(*radiance, {frame, *whole, tile}, log)) {
      lights.forget();  // what failed may have been one of them
      return false;
    }
  }
  return true;
}

// An image whose samples stand where they change it: it is whole at once.
bool Renderer::Impl::sampled(const FrameScene& scene, const RenderOptions& options,
                             std::span<const GLenum> formats, std::size_t frame,
                             DiagnosticLog& log) {
  image::Image& image = frames[frame].image;
  clear_around({0, 0, image.width, image.height}, {}, image);
  if (!sampling->render(scene, options, formats, image, job, log)) return false;
  const SamplingReport sampled_report = sampling->report();
  frames[frame].report.samples += sampled_report.samples;
  frames[frame].report.rmse = sampled_report.rmse;
  frames[frame].report.flux = sampled_report.flux;
  frames[frame].report.limited = sampled_report.limited;
  if (shared.went_well(log)) return true;
  lights.forget();  // what failed may have been one of them
  return false;
}

bool Renderer::Impl::submit_truth(const FrameScene& scene, const RenderOptions& options,
                                  std::size_t frame, DiagnosticLog& log) {
  const image::Image& image = frames[frame].image;
  std::vector<GroundTruthTarget>& targets = frames[frame].targets;
  targets.resize(scene.visible.targets.size());
  if (targets.empty()) return true;
  const std::uint32_t side = std::min(options.tile_side, shared.context->limits().framebuffer_side);
  const std::uint32_t width = std::min(side, image.width);
  const std::uint32_t height = std::min(side, image.height);
  if (!passes->prepare(scene, Pass::ids, log)) return false;
  for (std::size_t v = 0; v < targets.size(); ++v) {
    const VisibleTarget& visible = scene.visible.targets[v];
    set_truth_target(targets[v], scene.state(v).model().model, scene.state(v).placed, visible,
                     scene.world[visible.target].pose());
  }
  for (Tiles whole(image.width, image.height, side); whole; whole.next()) {
    on_tile.find(scene, *whole);
    const Tile& tile = on_tile.tile;
    if (tile.width == 0 || tile.height == 0) continue;
    if (is_cancelled(log) || !make_room(*ids, log)) return false;
    RenderTarget& target = ids->pixels.target();
    if (!ensure_target(target, kIdFormats, true, width, height, log)) return false;
    passes->upload(scene, on_tile, 1, options.flat);
    if (!passes->draw(scene, on_tile, 1, Pass::ids, target, job))
      return fail(ReadBack::Wait::cancelled, log);
    if (!submit_tile(*ids, {frame, *whole, tile}, log)) return false;
  }
  return true;
}

// All tiles of a frame that are under way, and those before them.
bool Renderer::Impl::take_all(std::size_t index, DiagnosticLog& log) {
  // both kinds in the order in which they were submitted
  while (frames[index].tiles > 0) {
    const auto has = [&](const Ring& ring) {
      return !ring.pixels.empty() && ring.tiles[ring.pixels.oldest()].frame == index;
    };
    if (!take_tile(has(*radiance) || ids->pixels.empty() ? *radiance : *ids, log)) return false;
  }
  return true;
}

// Forgets the newest frame.
void Renderer::Impl::abandon(std::size_t frame) {
  for (std::optional<Ring>* ring : {&radiance, &ids})
    while (*ring && !(*ring)->pixels.empty() &&
           (*ring)->tiles[(*ring)->pixels.newest()].frame == frame)
      (*ring)->pixels.drop_newest();
  frames[frame].tiles = 0;
}

}  // namespace panwright::preview
