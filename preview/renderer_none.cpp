// The build without OpenGL: there is no context, so no device, and nothing here is ever rendered.
#include "preview/renderer.h"

namespace panwright::preview {

struct ModelResources::Impl {
  world::ModelPtr model;
};
struct Device::Impl {
  std::unique_ptr<Context> context;  // another library's: Context::create fails
};
struct Renderer::Impl {
  std::shared_ptr<Device> device;
};

ModelResources::ModelResources(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ModelResources::~ModelResources() = default;
const world::ModelPtr& ModelResources::model() const { return impl_->model; }
std::uint64_t ModelResources::triangles() const { return 0; }
std::uint64_t ModelResources::bytes() const { return 0; }

Device::Device(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Device::~Device() = default;
Result<std::shared_ptr<Device>> Device::create(ContextKind kind, DiagnosticLog& log) {
  static_cast<void>(Context::create(kind, log));  // says why
  return failed;
}
std::shared_ptr<Device> Device::create(std::unique_ptr<Context> context) {
  return std::shared_ptr<Device>(new Device(std::make_unique<Impl>(Impl{std::move(context)})));
}
Context& Device::context() const { return *impl_->context; }
Result<std::shared_ptr<const ModelResources>> Device::resources(const world::ModelPtr&,
                                                                DiagnosticLog& log, const Job&) {
  log.report_file(Code("E5007"), {}, "this program was built without OpenGL");
  return failed;
}
std::shared_ptr<const ModelResources> Device::find(const world::ModelPtr&) const { return nullptr; }
Device::Counts Device::counts() const { return {}; }

Renderer::Renderer(std::shared_ptr<Device> device)
    : impl_(std::make_unique<Impl>(Impl{std::move(device)})) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;
const std::shared_ptr<Device>& Renderer::device() const { return impl_->device; }
SamplingReport Renderer::sampling() const { return {}; }
Renderer::Counts Renderer::counts() const { return {}; }

Result<image::Image> Renderer::render(const world::World&, const world::Camera&,
                                      const RenderOptions&, DiagnosticLog& log, const Job&) {
  log.report_file(Code("E5007"), {}, "this program was built without OpenGL");
  return failed;
}

bool Renderer::submit(const world::World&, const world::Camera&, const RenderOptions&,
                      DiagnosticLog& log, const Job&) {
  log.report_file(Code("E5007"), {}, "this program was built without OpenGL");
  return false;
}
Result<image::Image> Renderer::collect(DiagnosticLog&, const Job&) { return failed; }
std::size_t Renderer::in_flight() const { return 0; }
void Renderer::drop() {}
void Renderer::recycle(image::Image) {}

double Renderer::seconds_of_bare_draw(const world::World&, const world::Camera&) { return 0; }

}  // namespace panwright::preview
