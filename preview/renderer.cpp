#include "preview/renderer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "preview/frame/frames_in_flight.h"
#include "preview/frame/imposter_sampler.h"
#include "preview/frame/outline.h"
#include "preview/frame/samplers.h"
#include "preview/frame/scene_state.h"

namespace panwright::preview {
namespace {

// the largest side of an image, as the largest framebuffers of common contexts
constexpr std::uint32_t kMaxSide = 16384;

// N of N×N samples, at most
constexpr unsigned kMostSamplesASide = 64;

[[maybe_unused]] bool is_shadow_side(unsigned texels) {
  return texels == 0 || (texels >= 16 && texels <= kMaxSide);
}

[[maybe_unused]] bool is_sound(const world::Camera& camera, const RenderOptions& options) {
  const auto unit = [](const Quat& q) { return std::fabs(glm::dot(q, q) - 1) < 1e-6; };
  return camera.width > 0 && camera.height > 0 && camera.focal.x > 0 && camera.focal.y > 0 &&
         std::isfinite(camera.focal.x + camera.focal.y) && is_finite(camera.position) &&
         std::isfinite(camera.principal.x + camera.principal.y) && unit(camera.world_from_camera) &&
         options.samples <= kMostSamplesASide && options.tile_side >= options.samples &&
         options.flux_error > 0 && options.psf_sigma >= 0 && options.psf_sigma <= 64 &&
         (options.samples > 0 || (options.pixel_error > 0 && options.tile_side >= 64)) &&
         options.sun_points >= 2 && options.sun_points <= kMostSunPoints &&
         is_shadow_side(options.shadow_side.value_or(0));
}

void set_state(const GladGLContext& gl) {
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

bool fits(const world::Camera& camera, const RenderOptions& options, DiagnosticLog& log) {
  if (camera.width > kMaxSide || camera.height > kMaxSide) {
    log.report_file(Code("E5003"), {},
                    fmt::format("an image of {} by {} pixels, expected at most {} a side",
                                camera.width, camera.height, kMaxSide));
    return false;
  }
  const std::uint64_t bytes =
      std::uint64_t{camera.width} * camera.height * (options.ground_truth ? 48 : 16);
  if (bytes <= options.max_bytes) return true;
  log.report_file(
      Code("E5003"), {},
      fmt::format("an image of {} by {} pixels takes {:.4g} GB of memory; the limit is {:.4g} GB",
                  camera.width, camera.height, static_cast<double>(bytes) / 1e9,
                  static_cast<double>(options.max_bytes) / 1e9),
      "--max-image-memory allows more");
  return false;
}

// Texels that a side of an imposter may have.
std::uint32_t most_texels(const Context& context) {
  constexpr std::uint32_t kMost = 2048;  // less the border; all fit into one framebuffer
  return std::min(kMost, context.limits().framebuffer_side);
}

// Of two images that are parts of one.
SamplingReport sum_of(const SamplingReport& a, const SamplingReport& b) {
  return {a.samples + b.samples,
          std::max(a.rmse, b.rmse),
          std::max(a.flux, b.flux),
          a.limited || b.limited,
          std::max(a.shadow_edge, b.shadow_edge),
          std::max(a.penumbra, b.penumbra),
          std::max(a.sun_points, b.sun_points),
          std::max(a.sun_error, b.sun_error),
          b.imposters,
          0,
          0,
          std::max(a.lamps, b.lamps),
          std::max(a.lamps_without_shadow, b.lamps_without_shadow),
          std::max(a.lamps_left_out, b.lamps_left_out),
          std::max(a.lamps_soft, b.lamps_soft),
          std::max(a.lamp_penumbra, b.lamp_penumbra),
          std::max(a.lamps_hard, b.lamps_hard)};
}

}  // namespace

struct Renderer::Impl {
  explicit Impl(std::shared_ptr<Device> device_in)
      : device(std::move(device_in)), shared(device->impl()), frames(shared) {}
  ~Impl() { shared.context->make_current(); }  // the members delete their objects

  bool submit(const world::World& world, const world::Camera& camera, const RenderOptions& options,
              DiagnosticLog& log, const Job& job);
  bool draw(const world::World& world, const world::Camera& camera, const RenderOptions& options,
            const LevelState& levels, FrameUnderWay& frame, DiagnosticLog& log, const Job& job);
  std::vector<std::string> thin_targets(const world::World& world, const world::Camera& camera,
                                        const RenderOptions& options, const VisibleSet& visible);

  std::shared_ptr<Device> device;
  Device::Impl& shared;
  SceneState scene;
  FramesInFlight frames;
  std::optional<Samplers> samplers;  // made when the context is first current
  ImposterSampler imposters;
  Outline outline;
  SamplingReport report;  // of the image collected last
};

Renderer::Renderer(std::shared_ptr<Device> device)
    : impl_(std::make_unique<Impl>(std::move(device))) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

const std::shared_ptr<Device>& Renderer::device() const { return impl_->device; }

SamplingReport Renderer::sampling() const { return impl_->report; }

Renderer::Counts Renderer::counts() const {
  return {impl_->scene.targets().placed(),
          impl_->samplers ? impl_->samplers->lights().maps_drawn() : 0};
}

bool Renderer::Impl::submit(const world::World& world, const world::Camera& camera,
                            const RenderOptions& options, DiagnosticLog& log, const Job& job) {
  if (!fits(camera, options, log) || !shared.ready(log)) return false;
  const std::uint64_t programs = shared.programs.built();
  const double program_seconds = shared.programs.seconds();
  if (!samplers) samplers.emplace(shared);
  set_state(shared.context->gl());
  if (!scene.update(world, camera, options, *device, log, job)) return false;
  samplers->begin_image(world, camera, options);
  FrameUnderWay& frame = frames.next();
  frame.other_radiance.clear();
  frame.other_coverage.clear();
  SamplingReport total;
  RenderOptions part = options;
  part.ground_truth = false;
  for (const LevelState& levels : scene.levels().first(scene.levels().size() - 1)) {
    if (!draw(world, camera, part, levels, frame, log, job)) return false;
    if (!frames.take_all(frame, log, job)) {
      frames.abandon(frame);
      return false;
    }
    frame.finish();
    frame.add_to_others(levels.weight);
    total = sum_of(total, frame.report);
  }
  if (!draw(world, camera, options, scene.levels().back(), frame, log, job)) return false;
  frame.weight = scene.levels().back().weight;
  frame.report = sum_of(total, frame.report);
  frame.report.programs = shared.programs.built() - programs;
  frame.report.program_seconds = shared.programs.seconds() - program_seconds;
  frames.add_next();
  return true;
}

// Submits the image of one choice of levels.
bool Renderer::Impl::draw(const world::World& world, const world::Camera& camera,
                          const RenderOptions& options, const LevelState& levels,
                          FrameUnderWay& frame, DiagnosticLog& log, const Job& job) {
  scene.show_all();
  const VisibleSet* visible = scene.find_all(world, camera, levels, log);
  if (!visible) return false;
  frame.patches.clear();
  frame.psf_sigma = options.psf_sigma;
  frame.tiles = 0;
  frame.report = {};
  frame.why_empty = scene.why_empty(world);
  bool some_imposters = false;
  if ((options.imposters == Imposters::always || options.samples == 0 || options.imposter_pixels) &&
      !imposters.draw_all(
          {world, camera, options, levels, scene, *samplers, frames, frame, log, job},
          most_texels(*shared.context), some_imposters))
    return false;
  reset(frame.image, camera, options.ground_truth);
  frame.image.unit = world.sun().irradiance ? "W/(m^2 sr)" : "1/sr";
  frame.camera = camera;
  frame.flat = options.flat;
  const VisibleSet* rest = some_imposters ? scene.find_shown(world, camera, levels, log) : visible;
  if (!rest) return false;
  // sampling counts the others
  if ((!options.adaptive || options.samples < 2) && !rest->targets.empty())
    frame.report.samples += static_cast<double>(options.samples) * options.samples;
  frame.thin = thin_targets(world, camera, options, *rest);
  if (samplers->radiance({world, camera, scene.targets(), *rest}, options, frames, frame, log,
                         job) &&
      (!options.ground_truth || samplers->truth({world, camera, scene.targets(), *visible}, options,
                                                frames, frame, log, job)))
    return true;
  frames.abandon(frame);
  return false;
}

// Names of targets that samples may miss.
std::vector<std::string> Renderer::Impl::thin_targets(const world::World& world,
                                                      const world::Camera& camera,
                                                      const RenderOptions& options,
                                                      const VisibleSet& visible) {
  const unsigned finest = options.samples > 0 ? options.samples : kMostSamplesASide;
  std::vector<std::string> names;
  for (const VisibleTarget& target : visible.targets) {
    outline.find(camera, target.boxes);
    if (outline.width() * finest < 1) names.push_back(world[target.target].name());
  }
  return names;
}

bool Renderer::submit(const world::World& world, const world::Camera& camera,
                      const RenderOptions& options, DiagnosticLog& log, const Job& job) {
  assert(is_sound(camera, options) && in_flight() < kMostInFlight);
  if (impl_->submit(world, camera, options, log, job)) return true;
  if (impl_->shared.lost || job.cancelled()) impl_->frames.drop();
  return false;
}

Result<image::Image> Renderer::collect(DiagnosticLog& log, const Job& job) {
  assert(in_flight() > 0);
  Impl& impl = *impl_;
  if (!impl.shared.ready(log)) {
    if (impl.shared.lost) impl.frames.drop();
    return failed;
  }
  FrameUnderWay& frame = impl.frames.oldest();
  if (!impl.frames.take_all(frame, log, job) || !impl.shared.went_well(log)) {
    impl.frames.drop();
    return failed;
  }
  impl.frames.remove_oldest();
  impl.report = frame.report;
  return frame.take(log);
}

Result<image::Image> Renderer::render(const world::World& world, const world::Camera& camera,
                                      const RenderOptions& options, DiagnosticLog& log,
                                      const Job& job) {
  assert(in_flight() == 0);
  if (!submit(world, camera, options, log, job)) return failed;
  return collect(log, job);
}

std::size_t Renderer::in_flight() const { return impl_->frames.size(); }

void Renderer::drop() { impl_->frames.drop(); }

void Renderer::recycle(image::Image image) { impl_->frames.recycle(std::move(image)); }

double Renderer::seconds_of_bare_draw(const world::World& world, const world::Camera& camera) {
  Impl& impl = *impl_;
  DiagnosticLog log;
  if (!impl.shared.ready(log)) return 0;
  if (!impl.samplers) impl.samplers.emplace(impl.shared);
  set_state(impl.shared.context->gl());
  if (!impl.scene.update(world, camera, {}, *impl.device, log, {})) return 0;
  const VisibleSet* visible = impl.scene.find_all(world, camera, impl.scene.levels().back(), log);
  if (!visible) return 0;
  return impl.samplers->seconds_of_bare_draw({world, camera, impl.scene.targets(), *visible}, log);
}

}  // namespace panwright::preview
