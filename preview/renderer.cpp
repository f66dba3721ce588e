#include "preview/renderer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "base/clock.h"
#include "preview/frame/outline.h"
#include "preview/frame/renderer_impl.h"

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

// of a framebuffer that images of several shapes share
constexpr std::uint64_t kMostSamples = 1ull << 23;

void add_weighted(std::span<const float> values, float weight, std::span<float> sum) {
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
  const std::size_t pixels = ground_truth ? image.pixels() : 0;
  image.depth.assign(pixels, INFINITY);
  image.range.assign(pixels, INFINITY);
  image.normal.assign(3 * pixels, 0);
  image.target_id.assign(pixels, 0);
  image.node_id.assign(pixels, 0);
  image.material_id.assign(pixels, 0);
}

Renderer::Renderer(std::shared_ptr<Device> device)
    : impl_(std::make_unique<Impl>(std::move(device))) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

const std::shared_ptr<Device>& Renderer::device() const { return impl_->device; }

SamplingReport Renderer::sampling() const { return impl_->report; }

Renderer::Counts Renderer::counts() const {
  return {impl_->states.placed(), impl_->lights.maps_drawn()};
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
  return ensure_render_target(gl, target, formats, depth, width, height, kMostSamples, log);
}

void Renderer::Impl::make_passes() {
  if (passes) return;
  passes = std::make_unique<Passes>(shared);
  sampling = std::make_unique<Sampling>(shared, *passes, g_buffer, color_target);
  constexpr PixelFormat kRadiance{GL_RGBA32F, GL_RGBA, GL_FLOAT, 4 * sizeof(float)};
  constexpr PixelFormat kIds{GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, sizeof(TriangleId)};
  static_assert(sizeof(TriangleId) == 8);
  radiance.emplace(gl, kRadiance, shared.read_through_buffers);
  ids.emplace(gl, kIds, shared.read_through_buffers);
}

// The targets, and the levels of detail that they are shown at.
bool Renderer::Impl::update(const world::World& world, const world::Camera& camera,
                            const RenderOptions& options, DiagnosticLog& log) {
  if (!states.update(world, *device, log, job)) return false;
  leveled.clear();
  for (std::size_t i = 0; i < world.size(); ++i)
    leveled.push_back(
        {&world[i].pose(), states[i].bounds ? &*states[i].bounds : nullptr, states[i].steps.get()});
  world::Camera coarser = camera;
  coarser.focal /= options.level_pixels;
  level_choices = level_states.find(
      coarser, leveled, options.levels ? options.level_pixel : std::optional<double>(0));
  hidden.assign(world.size(), 0);
  return true;
}

const VisibleSet* Renderer::Impl::look(const world::World& world, const world::Camera& camera,
                                       const LevelState& levels, VisibleSetFinder& finder,
                                       DiagnosticLog& log) {
  shapes.clear();
  std::uint64_t items = 0;
  for (std::size_t i = 0; i < world.size(); ++i) {
    states.set_pixel(i, levels.pixels[i]);
    const TargetState& state = states[i];
    const auto count = static_cast<std::uint32_t>(world[i].model()->instances().size() +
                                                  world[i].model()->levels().size());
    const bool shown = state.bounds && !hidden[i];
    shapes.push_back({&world[i].pose(), shown ? &*state.bounds : nullptr, state.items(), count});
    items += count;
  }
  if (items > kMostItems) {
    log.report_file(Code::E5003, {},
                    fmt::format("the targets of the world have {} instances in all; one image "
                                "takes {}",
                                items, kMostItems));
    return nullptr;
  }
  return &finder.find(camera, shapes);
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
      std::uint64_t{camera.width} * camera.height * (options.ground_truth ? 48 : 16);
  if (bytes <= options.max_bytes) return true;
  log.report_file(
      Code::E5003, {},
      fmt::format("an image of {} by {} pixels takes {:.4g} GB of memory; the limit is {:.4g} GB",
                  camera.width, camera.height, static_cast<double>(bytes) / 1e9,
                  static_cast<double>(options.max_bytes) / 1e9),
      "--max-image-memory allows more");
  return false;
}

const char* Renderer::Impl::why_empty(const world::World& world, const VisibleSet& visible) const {
  if (world.empty()) return "nothing is in view: the world has no targets";
  bool any = false;
  for (std::size_t i = 0; i < world.size(); ++i) any = any || states[i].bounds;
  if (!any) return "nothing is in view: no target is visible";
  if (!visible.targets.empty())
    return "nothing is in view: targets are thinner than the sample spacing (--samples), or the "
           "camera is inside a closed mesh, visible from outside only";
  return world.size() > 1 ? "nothing is in view: no part of a target lies inside the image"
                          : "nothing is in view: no part of the model lies inside the image";
}

void Renderer::Impl::drop() {
  const bool current = used_frames > 0 && shared.context->make_current();
  for (std::optional<Ring>* ring : {&radiance, &ids})
    if (*ring) (*ring)->pixels.drop(current);
  for (Frame& frame : frames) frame.tiles = 0;
  used_frames = 0;
}

// Of two images that are parts of one.
static SamplingReport sum_of(const SamplingReport& a, const SamplingReport& b) {
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
          0};
}

bool Renderer::Impl::submit(const world::World& world, const world::Camera& camera,
                            const RenderOptions& options, DiagnosticLog& log) {
  if (!fits(world, camera, options, log) || !shared.ready(log)) return false;
  const std::uint64_t programs = shared.programs.built();
  const double program_seconds = shared.programs.seconds();
  make_passes();
  set_state();
  if (!update(world, camera, options, log)) return false;
  lights.begin_image(world.sun(), options);
  SamplingReport total;
  sum_radiance.clear();
  sum_coverage.clear();
  for (std::size_t i = 0; i + 1 < level_choices.size(); ++i) {
    RenderOptions part = options;
    part.ground_truth = false;
    if (!submit_state(world, camera, part, level_choices[i], log)) return false;
    const std::size_t index = (first_frame + used_frames - 1) % kFrames;
    if (!take_all(index, log)) return false;
    Frame& frame = frames[index];
    --used_frames;
    finish(frame);
    const auto weight = static_cast<float>(level_choices[i].weight);
    sum_radiance.resize(frame.image.radiance.size());
    sum_coverage.resize(frame.image.coverage.size());
    add_weighted(frame.image.radiance, weight, sum_radiance);
    add_weighted(frame.image.coverage, weight, sum_coverage);
    total = sum_of(total, frame.report);
  }
  if (!submit_state(world, camera, options, level_choices.back(), log)) return false;
  Frame& frame = frames[(first_frame + used_frames - 1) % kFrames];
  frame.weight = level_choices.back().weight;
  frame.other_radiance.swap(sum_radiance);
  frame.other_coverage.swap(sum_coverage);
  frame.report = sum_of(total, frame.report);
  frame.report.programs = shared.programs.built() - programs;
  frame.report.program_seconds = shared.programs.seconds() - program_seconds;
  return true;
}

bool Renderer::Impl::submit_state(const world::World& world, const world::Camera& camera,
                                  const RenderOptions& options, const LevelState& levels,
                                  DiagnosticLog& log) {
  std::fill(hidden.begin(), hidden.end(), std::uint8_t{0});
  const VisibleSet* visible = look(world, camera, levels, visible_sets, log);
  if (!visible) return false;
  const std::size_t index = (first_frame + used_frames) % kFrames;
  Frame& frame = frames[index];
  frame.weight = 1;
  frame.other_radiance.clear();
  frame.other_coverage.clear();
  frame.patches.clear();
  frame.psf_sigma = options.psf_sigma;
  frame.tiles = 0;
  frame.report = {};
  frame.why_empty = why_empty(world, *visible);
  if (!spare.empty() && frame.image.radiance.empty()) {
    frame.image = std::move(spare.back());
    spare.pop_back();
  }
  std::span<Imposter> imposters;
  if (options.imposters == Imposters::always || options.samples == 0 || options.imposter_pixels)
    imposters = imposter_finder.find(camera, *visible, options, most_texels());
  if (!imposters.empty() && !draw_imposters(world, camera, options, levels, imposters, index, log))
    return false;
  if (!options.adaptive || options.samples < 2)  // sampling counts the others
    frame.report.samples += static_cast<double>(options.samples) * options.samples;
  reset(frame.image, camera, options.ground_truth);
  frame.image.unit = world.sun().irradiance ? "W/(m^2 sr)" : "1/sr";
  frame.camera = camera;
  frame.flat = options.flat;
  const VisibleSet* rest =
      imposters.empty() ? visible : look(world, camera, levels, drawn_sets, log);
  frame.thin.clear();
  const unsigned finest = options.samples > 0 ? options.samples : kMostSamplesASide;
  if (rest)
    for (const VisibleTarget& target : rest->targets) {
      outline.find(camera, target.boxes);
      if (outline.width() * finest < 1) frame.thin.push_back(world[target.target].name());
    }
  if (rest && submit_radiance({world, camera, states, *rest}, options, index, log) &&
      (!options.ground_truth ||
       submit_truth({world, camera, states, *visible}, options, index, log))) {
    ++used_frames;
    return true;
  }
  abandon(index);
  return false;
}

bool Renderer::submit(const world::World& world, const world::Camera& camera,
                      const RenderOptions& options, DiagnosticLog& log, const Job& job) {
  assert(is_sound(camera, options) && in_flight() < kMostInFlight);
  impl_->job = job;
  if (impl_->submit(world, camera, options, log)) return true;
  if (impl_->shared.lost || job.cancelled()) impl_->drop();
  return false;
}

Result<image::Image> Renderer::collect(DiagnosticLog& log, const Job& job) {
  assert(in_flight() > 0);
  Impl& impl = *impl_;
  impl.job = job;
  Impl::Frame& frame = impl.frames[impl.first_frame];
  if (!impl.shared.ready(log)) {
    if (impl.shared.lost) impl.drop();
    return failed;
  }
  if (!impl.take_all(impl.first_frame, log) || !impl.shared.went_well(log)) {
    impl.drop();
    return failed;
  }
  impl.first_frame = (impl.first_frame + 1) % Impl::kFrames;
  --impl.used_frames;
  impl.report = frame.report;
  impl.finish(frame);
  image::Image image = std::move(frame.image);
  frame.image = {};
  if (!frame.other_radiance.empty()) {
    const auto weight = static_cast<float>(frame.weight);
    mix_in(frame.other_radiance, weight, image.radiance);
    mix_in(frame.other_coverage, weight, image.coverage);
  }
  if (std::all_of(image.coverage.begin(), image.coverage.end(), [](float a) { return a == 0; }))
    log.report_file(Code::W5006, {}, frame.why_empty);
  else
    for (const std::string& name : frame.thin)
      log.report_file(Code::W5006, {},
                      fmt::format("'{}' is thinner than the sample spacing (--samples) and may be "
                                  "missing; --imposters always shows it",
                                  name));
  return image;
}

Result<image::Image> Renderer::render(const world::World& world, const world::Camera& camera,
                                      const RenderOptions& options, DiagnosticLog& log,
                                      const Job& job) {
  assert(in_flight() == 0);
  if (!submit(world, camera, options, log, job)) return failed;
  return collect(log, job);
}

std::size_t Renderer::in_flight() const { return impl_->used_frames; }

void Renderer::drop() { impl_->drop(); }

void Renderer::recycle(image::Image image) {
  if (impl_->spare.size() < kMostInFlight) impl_->spare.push_back(std::move(image));
}

double Renderer::seconds_of_bare_draw(const world::World& world, const world::Camera& camera) {
  Impl& impl = *impl_;
  DiagnosticLog log;
  if (!impl.shared.ready(log)) return 0;
  impl.job = {};
  impl.make_passes();
  impl.set_state();
  if (!impl.update(world, camera, {}, log)) return 0;
  const VisibleSet* visible =
      impl.look(world, camera, impl.level_choices.back(), impl.visible_sets, log);
  const Tile whole{0, 0, camera.width, camera.height};
  constexpr GLenum kFormats[] = {GL_RGBA32F};
  if (!visible ||
      !impl.ensure_target(impl.bare_target, kFormats, true, whole.width, whole.height, log))
    return 0;
  const FrameScene scene{world, camera, impl.states, *visible};
  if (!impl.passes->prepare(scene, Pass::bare, log)) return 0;
  impl.gl.Finish();
  const auto start = std::chrono::steady_clock::now();
  TileScene tile;
  tile.find(scene, whole);
  tile.tile = whole;
  impl.passes->upload(scene, tile, 1, false);
  impl.passes->draw(scene, tile, 1, Pass::bare, impl.bare_target, {});
  impl.gl.Finish();
  return seconds_since(start);
}

}  // namespace panwright::preview
