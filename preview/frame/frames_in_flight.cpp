#include "preview/frame/frames_in_flight.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "preview/frame/samples.h"

namespace panwright::preview {
namespace {

// of a framebuffer that images of several shapes share
constexpr std::uint64_t kMostSamples = 1ull << 23;

constexpr PixelFormat kRadianceFormat{GL_RGBA32F, GL_RGBA, GL_FLOAT, 4 * sizeof(float)};
constexpr PixelFormat kIdFormat{GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, sizeof(TriangleId)};
static_assert(sizeof(TriangleId) == 8);

void add_weighted(std::span<const float> values, float weight, std::vector<float>& sum) {
  sum.resize(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) sum[i] += weight * values[i];
}
void mix_in(std::span<const float> sum, float weight, std::span<float> values) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = weight * values[i] + sum[i];
}

}  // namespace

void reset(image::Image& image, const world::Camera& camera, bool ground_truth) {
  image.width = camera.width;
  image.height = camera.height;
  image.metadata.clear();
  image.standard_error.clear();
  image.radiance.resize(3 * image.pixels());
  image.coverage.resize(image.pixels());
  reset_ground_truth(image, ground_truth);
}

bool ensure_target(const GladGLContext& gl, RenderTarget& target, std::span<const GLenum> formats,
                   std::uint32_t width, std::uint32_t height, DiagnosticLog& log) {
  return ensure_render_target(gl, target, formats, true, width, height, kMostSamples, log);
}

bool report_failure(Device::Impl& device, ReadBack::Wait why, DiagnosticLog& log) {
  if (why == ReadBack::Wait::cancelled)
    report_cancelled(log);
  else if (device.went_well(log))
    log.report_file(Code("E5003"), {}, "the context failed while it drew");
  return false;
}

void FrameUnderWay::finish() {
  if (psf_sigma > 0 &&
      std::any_of(image.coverage.begin(), image.coverage.end(), [](float a) { return a > 0; }))
    convolve(psf_sigma, image);
  add_patches(patches, image);
  patches.clear();
}

void FrameUnderWay::add_to_others(double share) {
  add_weighted(image.radiance, static_cast<float>(share), other_radiance);
  add_weighted(image.coverage, static_cast<float>(share), other_coverage);
}

image::Image FrameUnderWay::take(DiagnosticLog& log) {
  finish();
  image::Image taken = std::exchange(image, {});
  if (!other_radiance.empty()) {
    mix_in(other_radiance, static_cast<float>(weight), taken.radiance);
    mix_in(other_coverage, static_cast<float>(weight), taken.coverage);
  }
  if (std::all_of(taken.coverage.begin(), taken.coverage.end(), [](float a) { return a == 0; }))
    log.report_file(Code("W5006"), {}, why_empty);
  else
    for (const std::string& name : thin)
      log.report_file(Code("W5006"), {},
                      fmt::format("'{}' is thinner than the sample spacing (--samples) and may be "
                                  "missing; --imposters always shows it",
                                  name));
  return taken;
}

FramesInFlight::FramesInFlight(Device::Impl& device)
    : device_(device),
      radiance_{{device.context->gl(), kRadianceFormat, device.read_through_buffers}, {}},
      ids_{{device.context->gl(), kIdFormat, device.read_through_buffers}, {}} {
  spare_.reserve(kMost);
}

FrameUnderWay& FramesInFlight::next() {
  FrameUnderWay& frame = frames_[(first_ + used_) % kMost];
  if (!spare_.empty() && frame.image.radiance.empty()) {
    frame.image = std::move(spare_.back());
    spare_.pop_back();
  }
  return frame;
}

void FramesInFlight::remove_oldest() {
  first_ = (first_ + 1) % kMost;
  --used_;
}

RenderTarget* FramesInFlight::target(TileKind kind, std::uint32_t width, std::uint32_t height,
                                     DiagnosticLog& log, const Job& job) {
  if (job.cancelled()) {
    report_cancelled(log);
    return nullptr;
  }
  ReadBack& pixels = ring(kind).pixels;
  if (pixels.full() && !take_tile(kind, log, job)) return nullptr;
  RenderTarget& target = pixels.target();
  const GLenum formats[] = {pixels.format().internal};
  return ensure_target(device_.context->gl(), target, formats, width, height, log) ? &target
                                                                                   : nullptr;
}

bool FramesInFlight::submit(TileKind kind, FrameUnderWay& frame, const Tile& whole,
                            const Tile& tile, DiagnosticLog& log) {
  Ring& tiles = ring(kind);
  tiles.tiles[tiles.pixels.next()] = {&frame, whole, tile};
  const bool good = tiles.pixels.submit(tile.width, tile.height);
  if (good) ++frame.tiles;
  // before more is drawn: a lost context takes nothing
  return device_.went_well(log) && (good || report_failure(device_, ReadBack::Wait::failed, log));
}

// the mean of the samples of a tile, or what its triangles say
void FramesInFlight::use_tile(TileKind kind, const TileUnderWay& tile, const void* pixels) {
  FrameUnderWay& frame = *tile.frame;
  const std::size_t count = std::size_t{tile.tile.width} * tile.tile.height;
  if (kind == TileKind::ids) {
    fill_ground_truth(frame.camera, frame.flat, frame.targets, tile.tile,
                      {static_cast<const TriangleId*>(pixels), count}, frame.image);
    return;
  }
  store_pixels({static_cast<const float*>(pixels), 4 * count}, tile.tile, frame.image);
  clear_around(tile.whole, tile.tile, frame.image);
}

// Waits for the oldest tile of a kind and puts it into its image.
bool FramesInFlight::take_tile(TileKind kind, DiagnosticLog& log, const Job& job) {
  Ring& tiles = ring(kind);
  const TileUnderWay& tile = tiles.tiles[tiles.pixels.oldest()];
  const auto use = [&](const void* pixels) { use_tile(kind, tile, pixels); };
  const auto result = tiles.pixels.take(job, std::ref(use));
  if (result != ReadBack::Wait::done) return report_failure(device_, result, log);
  --tile.frame->tiles;
  return true;
}

bool FramesInFlight::take_all(const FrameUnderWay& frame, DiagnosticLog& log, const Job& job) {
  // both kinds in the order in which they were submitted
  while (frame.tiles > 0) {
    const bool first =
        !radiance_.pixels.empty() && radiance_.tiles[radiance_.pixels.oldest()].frame == &frame;
    const bool radiance = first || ids_.pixels.empty();
    if (!take_tile(radiance ? TileKind::radiance : TileKind::ids, log, job)) return false;
  }
  return true;
}

void FramesInFlight::abandon(FrameUnderWay& frame) {
  for (Ring* tiles : {&radiance_, &ids_})
    while (!tiles->pixels.empty() && tiles->tiles[tiles->pixels.newest()].frame == &frame)
      tiles->pixels.drop_newest();
  frame.tiles = 0;
}

void FramesInFlight::drop() {
  const bool current = used_ > 0 && device_.context->make_current();
  for (Ring* tiles : {&radiance_, &ids_}) tiles->pixels.drop(current);
  for (FrameUnderWay& frame : frames_) frame.tiles = 0;
  used_ = 0;
}

void FramesInFlight::recycle(image::Image image) {
  if (spare_.size() < kMost) spare_.push_back(std::move(image));
}

}  // namespace panwright::preview
