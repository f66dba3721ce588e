// Setup and calls of both engines.
#include "workspace/drawer.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <deque>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/clock.h"
#include "base/text.h"
#include "preview/lens_renderer.h"
#include "preview/reference/ground_layer.h"
#include "sky/backdrop.h"
#include "sky/stars.h"
#include "transport/transport.h"
#include "workspace/internal/forward.h"
#include "workspace/internal/lamp_points.h"
#include "world/evaluation.h"
#include "world/lamps.h"

namespace panwright::workspace {

namespace {

constexpr unsigned kLeastSamples = 8;  // of the reference

// Whether terrain may shade targets.
bool has_targets_on_ground(const world::World& world) {
  return preview::has_ground(world) &&
         std::ranges::any_of(world.instances(), [](const world::Instance& target) {
           return target.visible() && !preview::has_ground(target);
         });
}

// Whether a world is for OpenGL: terrain alone needs none.
bool needs_opengl(const world::World& world) {
  return !preview::has_ground(world) ||
         std::ranges::any_of(world.instances(), [](const world::Instance& target) {
           return !target.model()->instances().empty();
         });
}

// What OpenGL would draw of terrain alone.
image::Image empty_image(const world::World& world, const world::Camera& camera,
                         bool ground_truth) {
  image::Image image;
  image.width = camera.width;
  image.height = camera.height;
  image.unit = world.sun().irradiance ? "W/(m^2 sr)" : "1/sr";
  image.radiance.resize(3 * image.pixels());
  image.coverage.resize(image.pixels());
  reset_ground_truth(image, ground_truth);
  return image;
}

}  // namespace

struct Drawer::Impl {
  bool is_gl() const { return options.engine == Engine::gl; }
  void set(const DrawOptions& given) {
    options = given;
    if (given.samples == 0) return;
    options.gl.samples = given.samples;
    options.reference.samples = std::max(given.samples * given.samples, kLeastSamples);
  }

  DrawOptions options;
  // of OpenGL; empty: the reference, or all worlds were of terrain
  std::optional<preview::Renderer> renderer;
  std::vector<std::shared_ptr<const preview::ModelResources>> models;  // of the last world
  bool open(const world::World& world, DiagnosticLog& log);
  bool take_from_renderer(DiagnosticLog& log, const Job& job);
  bool submit_at_once(const world::World& world, const world::Camera& camera, bool ground_truth,
                      DiagnosticLog& log, const Job& job);
  Result<image::Image> draw_now(const world::World& world, const world::Camera& camera,
                                const preview::RenderOptions& own, DiagnosticLog& log,
                                const Job& job);
  bool find_ground_light(const world::World& world, DiagnosticLog& log, const Job& job);
  bool shade_by_ground(const world::World& world, const world::Camera& camera, image::Image& image,
                       DiagnosticLog& log, const Job& job);

  preview::Reference reference;  // with OpenGL: ground truth of lenses with distortion
  preview::LensRenderer lens;
  struct Done {
    Drawn drawn;
    DiagnosticLog log;  // to be told with the image
  };
  std::deque<Done> done;  // and not collected; older than those of the renderer

  // Behind the images under way, none: black; and lamps in front.
  struct Behind {
    std::optional<sky::Sky> sky;
    bool bodies = false;  // not drawn yet
    bool before = false;  // they may stand before targets
    bool truth = false;   // wanted
    light::Stars stars;
    world::Camera camera;
    double psf_sigma = 0;
    std::vector<LampPoint> lamps;
    std::optional<world::World> world;  // with terrain or mirrors that are not drawn yet
    bool ground = false;
    preview::GroundOptions ground_options;
    std::shared_ptr<const std::vector<light::SurfelLight>> mirrored;  // none: no mirrors
    std::optional<LightBetween> between;
    std::optional<GroundLight> ground_light;
  };
  std::deque<Behind> behind;
  preview::GroundLayer ground;

  // Light between surfaces, of the last world that was drawn with it.
  struct Between {
    explicit Between(const std::filesystem::path& cache) {
      if (!cache.empty()) kept.emplace(cache / "work");
      transport.emplace(transport::TransportOptions{}, kept ? &*kept : nullptr);
    }
    std::optional<WorkCache> kept;
    std::optional<transport::Transport> transport;
    std::uint64_t lights = 0;  // its count, of `light`
    std::shared_ptr<const std::vector<light::SurfelLight>> light;
  };
  std::unique_ptr<Between> between;
  std::optional<LightBetween> told;        // of the last image that was begun
  std::optional<GroundLight> ground_told;  // the same
  bool find_light_between(const world::World& world, const world::Camera& camera,
                          DiagnosticLog& log, const Job& job);
  bool add_mirrored_change(const world::World& world, const world::Camera& camera,
                           transport::Transport::Change& change, DiagnosticLog& log,
                           const Job& job);

  world::Evaluation evaluation;
  bool may_stand_before(const sky::Sky& sky, const world::World& world, const Vec3& camera);
  void add_ground(const Behind& here, image::Image& image, DiagnosticLog& log, const Job& job);
  void add_sky(const Behind& here, image::Image& image, const Job& job);
  std::size_t in_flight() const { return done.size() + (renderer ? renderer->in_flight() : 0); }
  bool submit(const world::World& world, const world::Camera& camera, bool ground_truth,
              DiagnosticLog& log, const Job& job);
  Result<Drawn> collect(DiagnosticLog& log, const Job& job);
};

Result<image::Image> Drawer::Impl::draw_now(const world::World& world, const world::Camera& camera,
                                            const preview::RenderOptions& own, DiagnosticLog& log,
                                            const Job& job) {
  return camera.distortion != nullptr ? lens.render(*renderer, world, camera, own, log, job)
                                      : renderer->render(world, camera, own, log, job);
}

// Sets options.gl.ground_shine, and tells of it.
bool Drawer::Impl::find_ground_light(const world::World& world, DiagnosticLog& log,
                                     const Job& job) {
  const auto before = std::exchange(options.gl.ground_shine, nullptr);
  ground_told.reset();
  if (!has_targets_on_ground(world)) return true;
  const auto start = std::chrono::steady_clock::now();
  const bool good = run_job(job, log, [&] {
    options.gl.ground_shine = ground.shine(world, job);
    return true;
  });
  if (!good) return false;
  ground_told.emplace();
  if (options.gl.ground_shine != before) ground_told->seconds = seconds_since(start);
  const Vec3 sun = light::incidence(world.sun(), Vec3(0)).irradiance;
  for (std::size_t i = 0; i < world.size(); ++i) {
    // measured against the reference: sides are within 8 % at 1, and may be half as bright at 4
    constexpr double kClose = 1.5;
    const light::GroundShine& shine = (*options.gl.ground_shine)[i];
    Vec3 sum(0);
    for (const light::ShinePart& part : shine.parts) sum += part.flux * part.direction;
    const double share = glm::length(sum) / std::max(sun.x + sun.y + sun.z, 1e-300);
    ground_told->share = std::max(ground_told->share, share);
    if (share > 0.01 && shine.closeness > kClose)
      log.report_file(Code("W5021"), {},
                      fmt::format("all of {} is lit by the ground as its middle is, though ground "
                                  "is near: its sides may be a third as bright, or twice, with "
                                  "dark spots",
                                  in_quotes(world[i].name())),
                      "--engine reference --bounces 1 has this light");
  }
  return true;
}

// Terrain's shadow on targets: the Sun's part of their light is what an image without it lacks.
bool Drawer::Impl::shade_by_ground(const world::World& world, const world::Camera& camera,
                                   image::Image& image, DiagnosticLog& log, const Job& job) {
  std::vector<float> shares;
  const bool good = run_job(job, log, [&] {
    shares = ground.sun_shares(world, camera, true, image, job);
    return true;
  });
  if (!good || shares.empty()) return good;
  preview::RenderOptions own = options.gl;
  own.ground_truth = false;
  own.sunlight = false;
  own.indirect.reset();  // it is the Sun's, for the most part
  DiagnosticLog apart = log.apart();
  auto rest = draw_now(world, camera, own, apart, job);
  if (!rest) {
    forward(apart, {}, {}, log);
    return false;
  }
  preview::shade(shares, *rest, image);
  renderer->recycle(*std::move(rest));
  return true;
}

// Ends the images of the renderer: one that is drawn at once comes after them.
bool Drawer::Impl::take_from_renderer(DiagnosticLog& log, const Job& job) {
  while (renderer && renderer->in_flight() > 0) {
    DiagnosticLog apart = log.apart();
    auto image = renderer->collect(apart, job);
    if (!image) {
      forward(apart, {}, {}, log);
      done.clear();
      return false;
    }
    done.push_back({{*std::move(image), {}, renderer->sampling(), {}, {}}, std::move(apart)});
  }
  return true;
}

// Draws an image with distortion, or beside terrain, at once.
bool Drawer::Impl::submit_at_once(const world::World& world, const world::Camera& camera,
                                  bool ground_truth, DiagnosticLog& log, const Job& job) {
  if (const char* why = preview::LensRenderer::refused(camera); why && camera.distortion) {
    log.report_file(Code("E5003"), {}, why);
    return false;
  }
  if (!take_from_renderer(log, job)) return false;
  preview::RenderOptions own = options.gl;
  own.ground_truth = ground_truth;
  DiagnosticLog apart = log.apart();
  auto image = draw_now(world, camera, own, apart, job);
  const auto sampling = camera.distortion != nullptr ? lens.sampling() : renderer->sampling();
  if (!image ||
      (ground_truth && camera.distortion != nullptr &&
       !reference.add_ground_truth(world, camera, options.gl.flat, *image, apart, job)) ||
      (preview::has_ground(world) && !shade_by_ground(world, camera, *image, apart, job))) {
    forward(apart, {}, {}, log);
    if (job.cancelled()) done.clear();
    return false;
  }
  done.push_back({{*std::move(image), {}, sampling, {}, {}}, std::move(apart)});
  return true;
}

Drawer::Drawer(const DrawOptions& options) : impl_(std::make_unique<Impl>()) {
  impl_->set(options);
}
Drawer::Drawer(Drawer&&) noexcept = default;
Drawer& Drawer::operator=(Drawer&&) noexcept = default;
Drawer::~Drawer() = default;

bool Drawer::Impl::open(const world::World& world, DiagnosticLog& log) {
  if (!is_gl() || renderer || !needs_opengl(world)) return true;
  auto device = preview::Device::create(options.context, log);
  if (!device) return false;
  renderer.emplace(*std::move(device));
  return true;
}

bool Drawer::open(const world::World& world, DiagnosticLog& log) { return impl_->open(world, log); }

EngineInfo Drawer::info() const {
  if (!impl_->renderer) return {impl_->options.engine, {}, {}, false};
  const preview::Context& context = impl_->renderer->device()->context();
  return {Engine::gl, context.renderer(), context.version(), context.is_hardware()};
}

void Drawer::set_options(const DrawOptions& options) {
  assert(options.engine == impl_->options.engine && options.context == impl_->options.context);
  impl_->set(options);
}

bool Drawer::prepare(const world::World& world, DiagnosticLog& log, const Job& job) {
  if (!impl_->is_gl()) {
    return run_job(job, log, [&] {
      impl_->reference.prepare(world, job);
      return true;
    });
  }
  if (!impl_->open(world, log)) return false;
  if (!impl_->renderer) return true;
  std::vector<std::shared_ptr<const preview::ModelResources>> models;
  for (const world::Instance& target : world.instances()) {
    auto resources = impl_->renderer->device()->resources(target.model(), log, job);
    if (!resources) return false;
    models.push_back(*std::move(resources));
  }
  impl_->models = std::move(models);
  return true;
}

// Adds what mirrors show, of an image of a few thousand pixels.
bool Drawer::Impl::add_mirrored_change(const world::World& world, const world::Camera& camera,
                                       transport::Transport::Change& change, DiagnosticLog& log,
                                       const Job& job) {
  constexpr double kSide = 64;
  const double scale = std::min(1.0, kSide / std::max(camera.width, camera.height));
  world::Camera small = camera;
  const auto scaled = [&](std::uint32_t pixels) {
    return std::max(1u, static_cast<std::uint32_t>(std::lround(pixels * scale)));
  };
  small.width = scaled(camera.width);
  small.height = scaled(camera.height);
  small.focal *= scale;
  small.principal *= scale;
  image::Image shown;
  shown.width = small.width;
  shown.height = small.height;
  shown.radiance.assign(3 * shown.pixels(), 0);
  const preview::MirrorOptions mirrors{options.gl.flat, 0, between->transport->light()};
  if (!reference.add_mirrored(world, small, mirrors, shown, log, job)) return false;
  const bool parallel = camera.projection == world::Projection::orthographic;
  for (std::uint32_t y = 0; y < small.height; ++y)
    for (std::uint32_t x = 0; x < small.width; ++x) {
      const float* const rgb = &shown.radiance[3 * (std::size_t{y} * small.width + x)];
      const double light = (double(rgb[0]) + double(rgb[1]) + double(rgb[2])) / 3;
      if (!(light > 0)) continue;
      const double size =
          parallel ? world::pixel_area(small) : world::pixel_solid_angle(small, x, y);
      change.added += size * light;
      change.added_square += size * light * light;
    }
  return true;
}

// Sets options.gl.indirect, and tells of it.
bool Drawer::Impl::find_light_between(const world::World& world, const world::Camera& camera,
                                      DiagnosticLog& log, const Job& job) {
  options.gl.indirect.reset();
  options.gl.mirrors_apart = false;
  told.reset();
  if (options.indirect == Indirect::off) return true;
  if (!between) between = std::make_unique<Between>(options.cache);
  transport::Transport& transport = *between->transport;
  const auto start = std::chrono::steady_clock::now();
  const std::uint64_t lights = transport.counts().lights;
  const bool good = run_job(job, log, [&] {
    const auto& shine = options.gl.ground_shine;
    transport.update(world, world::placed_lamps(world, camera),
                     shine ? std::span(*shine) : std::span<const light::GroundShine>(), job);
    return true;
  });
  if (!good) return false;
  LightBetween& tell = told.emplace();
  transport::Transport::Change change = transport.change_seen(world, camera);
  const auto changes = [&] {
    tell.rms = change.rms();
    tell.flux = change.of_flux();
    return std::max(tell.rms, tell.flux) > options.gl.pixel_error;
  };
  const bool mirrors = preview::has_mirrors(world);
  tell.drawn = changes() || options.indirect == Indirect::on;
  if (!tell.drawn && mirrors) {
    if (!add_mirrored_change(world, camera, change, log, job)) return false;
    tell.drawn = changes();
  }
  if (transport.counts().lights != lights) tell.seconds = seconds_since(start);
  for (const light::SurfelLight& light : transport.light()) tell.surfels += light.irradiance.size();
  if (!tell.drawn) return true;
  if (!between->light || between->lights != transport.counts().lights) {
    const auto light = transport.light();
    between->light =
        std::make_shared<const std::vector<light::SurfelLight>>(light.begin(), light.end());
    between->lights = transport.counts().lights;
  }
  options.gl.indirect = between->light;
  options.gl.mirrors_apart = tell.mirrors = mirrors;
  return true;
}

bool Drawer::Impl::submit(const world::World& world, const world::Camera& camera, bool ground_truth,
                          DiagnosticLog& log, const Job& job) {
  if (is_gl()) {
    if (!find_ground_light(world, log, job) || !find_light_between(world, camera, log, job) ||
        !open(world, log))
      return false;
    if (!needs_opengl(world)) {
      if (!take_from_renderer(log, job)) return false;
      done.push_back(
          {{empty_image(world, camera, ground_truth), {}, preview::SamplingReport{}, {}, {}},
           log.apart()});
      return true;
    }
    if (camera.distortion != nullptr || has_targets_on_ground(world))
      return submit_at_once(world, camera, ground_truth, log, job);
    preview::RenderOptions own = options.gl;
    own.ground_truth = ground_truth;
    return renderer->submit(world, camera, own, log, job);
  }
  preview::ReferenceOptions own = options.reference;
  own.ground_truth = ground_truth;
  auto traced = reference.render(world, camera, own, log, job);
  if (!traced) {
    if (job.cancelled()) done.clear();
    return false;
  }
  traced->image.standard_error = std::move(traced->standard_error);
  const std::uint64_t rays = traced->camera_rays + traced->shadow_rays + traced->bounce_rays;
  done.push_back(
      {{std::move(traced->image),
        Measured{traced->flux, traced->flux_error, traced->samples, rays, traced->seconds},
        {},
        {},
        {}},
       log.apart()});
  return true;
}

Result<Drawn> Drawer::Impl::collect(DiagnosticLog& log, const Job& job) {
  if (done.empty()) {
    auto image = renderer->collect(log, job);
    if (!image) return failed;
    return Drawn{*std::move(image), {}, renderer->sampling(), {}, {}};
  }
  Done oldest = std::move(done.front());
  done.pop_front();
  forward(oldest.log, {}, {}, log);
  return std::move(oldest.drawn);
}

// Whether a body may be nearer to the camera than a part of a target.
bool Drawer::Impl::may_stand_before(const sky::Sky& sky, const world::World& world,
                                    const Vec3& camera) {
  evaluation.update(world);
  double farthest = 0;
  for (std::size_t i = 0; i < world.size(); ++i) {
    const auto& bounds = evaluation[i].bounds;
    if (!bounds) continue;
    const double size = glm::length(glm::max(glm::abs(bounds->low), glm::abs(bounds->high)));
    farthest = std::max(farthest, size + glm::length(world[i].pose().translation - camera));
  }
  return sky::may_hide(sky, camera, farthest);
}

void Drawer::Impl::add_ground(const Behind& here, image::Image& image, DiagnosticLog& log,
                              const Job& job) {
  preview::GroundOptions ground_options = here.ground_options;
  ground_options.truth = here.truth || here.before;
  ground.add(*here.world, here.camera, ground_options, image, job);
  ground.report_damaged(log);
  if (std::ranges::all_of(image.coverage, [](float share) { return share == 0; }))
    log.report_file(Code("W5006"), {}, "nothing is in view: no target and no terrain");
}

void Drawer::Impl::add_sky(const Behind& here, image::Image& image, const Job& job) {
  if (here.bodies && here.before)
    sky::add_around(*here.sky, here.camera, here.psf_sigma, image, job);
  else if (here.bodies)
    sky::add_behind(sky::backdrop(*here.sky, here.camera, here.psf_sigma, job, &image.coverage),
                    image);
  if ((here.before || here.ground) && !here.truth) {
    image.depth.clear();
    image.range.clear();
    image.normal.clear();
    image.target_id.clear();
    image.node_id.clear();
    image.material_id.clear();
  }
  if (here.stars.catalogue)
    sky::add_stars(*here.sky, here.stars, here.camera, here.psf_sigma, image);
}

bool Drawer::submit(const world::World& world, const world::Camera& camera, bool ground_truth,
                    DiagnosticLog& log, const Job& job) {
  constexpr double kReach = 6;  // of a PSF, in sigma
  Impl::Behind next{{}, false, false, ground_truth, world.stars(), camera, 0, {}, {}, false, {},
                    {}, {},    {}};
  next.psf_sigma =
      impl_->is_gl() ? impl_->options.gl.psf_sigma : impl_->options.reference.psf_sigma;
  // the reference has bodies of its own
  next.bodies = world.has_sky() && impl_->is_gl();
  if (next.bodies || next.stars.catalogue) next.sky.emplace(world);
  if (impl_->is_gl() && preview::has_ground(world)) {
    next.world = world;
    next.ground = true;
    const preview::RenderOptions& gl = impl_->options.gl;
    if (gl.samples > 0 && !gl.adaptive) next.ground_options.samples = gl.samples;
    next.ground_options.psf_sigma = next.psf_sigma;
    next.ground_options.flat = impl_->options.gl.flat;
  }
  // depths decide which bodies of the sky stand in front
  next.before = next.bodies && impl_->may_stand_before(*next.sky, world, camera.position);
  const bool good =
      run_job(job, log,
              [&] {
                next.lamps =
                    lamp_points(world, camera, kReach * next.psf_sigma, impl_->reference, job);
                return true;
              }) &&
      impl_->submit(world, camera,
                    ground_truth || next.before || (next.ground && needs_opengl(world)), log, job);
  std::deque<Impl::Behind>& behind = impl_->behind;
  next.between = impl_->told;
  next.ground_light = impl_->ground_told;
  if (impl_->options.gl.mirrors_apart) {
    next.world = world;
    next.mirrored = impl_->options.gl.indirect;
  }
  if (good) behind.push_back(std::move(next));
  while (behind.size() > impl_->in_flight()) behind.pop_front();
  return good;
}

Result<Drawn> Drawer::collect(DiagnosticLog& log, const Job& job) {
  std::deque<Impl::Behind>& behind = impl_->behind;
  DiagnosticLog apart = log.apart();
  auto drawn = impl_->collect(apart, job);
  // an image without targets may have terrain
  const bool fills = drawn && behind.front().ground;
  forward(apart, {}, {}, log, fills ? std::optional(Code("W5006")) : std::nullopt);
  if (drawn) drawn->between = behind.front().between;
  if (drawn) drawn->ground_light = behind.front().ground_light;
  if (drawn && (behind.front().sky || behind.front().world || !behind.front().lamps.empty())) {
    const Impl::Behind& here = behind.front();
    const preview::MirrorOptions mirrors{
        impl_->options.gl.flat, here.psf_sigma,
        here.mirrored ? std::span(*here.mirrored) : std::span<const light::SurfelLight>()};
    const bool good =
        (!here.mirrored || impl_->reference.add_mirrored(*here.world, here.camera, mirrors,
                                                         drawn->image, log, job)) &&
        run_job(job, log, [&] {
          if (here.ground) impl_->add_ground(here, drawn->image, log, job);
          const double side = here.ground_options.samples;
          if (here.ground) drawn->ground_rays = side * side;
          impl_->add_sky(here, drawn->image, job);
          for (const LampPoint& lamp : here.lamps)
            sky::add_point(lamp.pixel, lamp.irradiance, here.camera, here.psf_sigma, drawn->image);
          return true;
        });
    if (!good) drawn = failed;
  }
  while (behind.size() > impl_->in_flight()) behind.pop_front();
  return drawn;
}

std::size_t Drawer::in_flight() const { return impl_->in_flight(); }

void Drawer::recycle(image::Image image) {
  if (impl_->renderer) impl_->renderer->recycle(std::move(image));
}

Result<Drawn> Drawer::draw(const world::World& world, const world::Camera& camera,
                           bool ground_truth, DiagnosticLog& log, const Job& job) {
  if (!submit(world, camera, ground_truth, log, job)) return failed;
  return collect(log, job);
}

}  // namespace panwright::workspace
