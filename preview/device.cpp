#include "preview/device.h"

#include <fmt/core.h>

#include <cassert>

#include "preview/model/device_impl.h"

namespace panwright::preview {
namespace {

// the layers that an item needs
LayerSet layers_of(const Variant& variant) {
  LayerSet set = 1u << kNormalLayer;
  if (variant.textured || variant.colored || variant.albedo_map) set |= 1u << kAlbedoLayer;
  if (variant.normal_map || variant.roughness_map || variant.cells)
    set |= 1u << kAlbedoLayer | 1u << kRoughnessLayer;
  if (variant.brushed || variant.normal_map || variant.curved)
    set |= 1u << kAlbedoLayer | 1u << kRoughnessLayer | 1u << kTangentLayer;
  if (variant.reflectance_map) set |= 1u << kReflectanceLayer;
  return set;
}

}  // namespace

ModelResources::Impl::~Impl() {
  if (device) device->context().make_current();  // the members delete their objects
}

ModelResources::ModelResources(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ModelResources::~ModelResources() = default;
const world::ModelPtr& ModelResources::model() const { return impl_->model; }
std::uint64_t ModelResources::triangles() const { return impl_->triangles; }
std::uint64_t ModelResources::bytes() const { return impl_->gpu.bytes(); }

Device::Device(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Device::~Device() = default;

Result<std::shared_ptr<Device>> Device::create(ContextKind kind, DiagnosticLog& log) {
  auto context = Context::create(kind, log);
  if (!context) return failed;
  return create(std::move(*context));
}

std::shared_ptr<Device> Device::create(std::unique_ptr<Context> context) {
  assert(context);
  return std::shared_ptr<Device>(new Device(std::make_unique<Impl>(std::move(context))));
}

Context& Device::context() const { return *impl_->context; }

Device::Counts Device::counts() const {
  const ContextCounts context = impl_->context->counts();
  return {impl_->models_uploaded, impl_->model_bytes, impl_->programs.built(), context.allocations,
          context.uploaded_bytes};
}

bool Device::Impl::ready(DiagnosticLog& log) {
  if (lost) {
    log.report_file(Code("E5001"), {}, "the OpenGL context was lost; a new device takes its place");
    return false;
  }
  if (context->make_current()) return true;
  log.report_file(Code("E5001"), {}, "the OpenGL context cannot be made current");
  return false;
}

bool Device::Impl::programs_ready(DiagnosticLog& log) {
  std::string problem;
  if (programs.settle(&problem)) return true;
  log.report_file(Code("E5001"), {},
                  fmt::format("{} refuses a shader: {}", context->renderer(), problem));
  return false;
}

bool Device::Impl::went_well(DiagnosticLog& log) {
  const GladGLContext& gl = context->gl();
  if (gl.GetGraphicsResetStatus && gl.GetGraphicsResetStatus() != GL_NO_ERROR) {
    lost = true;
    log.report_file(Code("E5001"), {}, "the OpenGL context was lost while it drew");
    return false;
  }
  const GLenum error = gl.GetError();
  if (error == GL_NO_ERROR) return true;
  // a lost context may report errors for ever
  for (int i = 0; i < 16 && gl.GetError() != GL_NO_ERROR; ++i) {
  }
  log.report_file(Code("E5003"), {},
                  fmt::format("the context failed while it drew, with OpenGL error 0x{:04x}",
                              static_cast<unsigned>(error)));
  return false;
}

std::shared_ptr<const ModelResources> Device::find(const world::ModelPtr& model) const {
  const auto found = impl_->models.find(model.get());
  return found == impl_->models.end() ? nullptr : found->second.lock();
}

Result<std::shared_ptr<const ModelResources>> Device::resources(const world::ModelPtr& model,
                                                                DiagnosticLog& log,
                                                                const Job& job) {
  assert(model && model->checked());
  if (auto found = find(model)) return found;
  if (!impl_->ready(log)) return failed;
  std::erase_if(impl_->models, [](const auto& entry) { return entry.second.expired(); });
  if (job.cancelled()) {
    report_cancelled(log);
    return failed;
  }
  auto impl = std::make_unique<ModelResources::Impl>(shared_from_this(), model);
  impl->list = draw_list(*model);
  for (const DrawItem& item : impl->list) {
    impl->triangles += model->meshes()[item.mesh].triangle_count;
    impl->filter_layers |= layers_of(item.variant);
    Variant points = item.variant;
    points.curved = false;
    impl->layers |= layers_of(points);
  }
  impl->brdf_models = families_of(*model);
  bool good = false;
  try {
    good = impl->gpu.upload(*impl_->context, *model, impl->list, impl->brdf_models, log, job);
  } catch (const Cancelled&) {
    report_cancelled(log);
  }
  impl_->model_bytes += impl->gpu.bytes();
  if (!good || !impl_->went_well(log)) return failed;
  ++impl_->models_uploaded;
  if (!impl->gpu.decals().empty())
    for (LayerSet* set : {&impl->layers, &impl->filter_layers}) *set |= 1u << kAlbedoLayer;
  auto shared = std::make_shared<const ModelResources>(std::move(impl));
  impl_->models[model.get()] = shared;
  return shared;
}

}  // namespace panwright::preview
