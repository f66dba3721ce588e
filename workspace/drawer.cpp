// The one file that knows how the engines are set up and called.
#include "workspace/drawer.h"

#include <algorithm>
#include <utility>

#include "preview/view.h"

namespace panwright::workspace {

namespace {

// note: OpenGL holds one model for now
preview::View view_of(const world::World& world, const world::Camera& camera) {
  const world::Sun& sun = world.sun();
  return {camera, world[0].pose(), sun.direction, sun.irradiance, sun.distance};
}

constexpr unsigned kLeastSamples = 8;  // of the reference

}  // namespace

struct Drawer::Impl {
  DrawOptions options;
  std::unique_ptr<preview::Context> context;  // null: the reference
  world::ModelPtr model;                      // that the engine holds
  std::optional<preview::Renderer> renderer;
  preview::Reference reference;
};

Drawer::Drawer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Drawer::Drawer(Drawer&&) noexcept = default;
Drawer& Drawer::operator=(Drawer&&) noexcept = default;
Drawer::~Drawer() = default;

Result<Drawer> Drawer::create(const DrawOptions& options, DiagnosticLog& log) {
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  if (options.samples > 0) {
    impl->options.gl.samples = options.samples;
    impl->options.reference.samples = std::max(options.samples * options.samples, kLeastSamples);
  }
  if (options.engine == Engine::gl) {
    auto context = preview::Context::create(options.context, log);
    if (!context) return failed;
    impl->context = *std::move(context);
  }
  return Drawer(std::move(impl));
}

EngineInfo Drawer::info() const {
  if (impl_->context == nullptr) return {Engine::reference, {}, {}, false};
  return {Engine::gl, impl_->context->renderer(), impl_->context->version(),
          impl_->context->is_hardware()};
}

bool Drawer::prepare(const world::World& world, DiagnosticLog& log) {
  if (impl_->context == nullptr) {
    impl_->reference.prepare(world);
    return true;
  }
  const world::ModelPtr& model = world[0].model();
  if (impl_->model == model) return true;
  impl_->renderer.reset();
  impl_->model = nullptr;
  auto renderer = preview::Renderer::create(*impl_->context, *model, log);
  if (!renderer) return false;
  impl_->renderer.emplace(*std::move(renderer));
  impl_->model = model;
  return true;
}

Result<Drawn> Drawer::draw(const world::World& world, const world::Camera& camera, bool truth,
                           DiagnosticLog& log, const Job& job) {
  if (!prepare(world, log)) return failed;
  if (impl_->renderer) {
    preview::RenderOptions options = impl_->options.gl;
    options.truth = truth;
    auto image = impl_->renderer->render(view_of(world, camera), options, log);
    if (!image) return failed;
    return Drawn{*std::move(image), {}};
  }
  preview::ReferenceOptions options = impl_->options.reference;
  options.truth = truth;
  auto traced = impl_->reference.render(world, camera, options, log, job);
  if (!traced) return failed;
  traced->image.standard_error = std::move(traced->standard_error);
  const std::uint64_t rays = traced->camera_rays + traced->shadow_rays + traced->bounce_rays;
  return Drawn{std::move(traced->image),
               Measured{traced->flux, traced->flux_error, traced->samples, rays, traced->seconds}};
}

}  // namespace panwright::workspace
