// One model in a world of its own, drawn view by view.
#pragma once

#include <memory>
#include <utility>

#include "preview/renderer.h"
#include "tests/support/view.h"

namespace panwright::support {

// Wraps a model owned elsewhere as a world's model.
inline world::ModelPtr borrowed(const pan::Model& model) {
  return world::ModelPtr(world::ModelPtr(), &model);
}

class ModelRenderer {
 public:
  // Expects: model.checked(); it outlives this.
  ModelRenderer(std::shared_ptr<preview::Device> device, const pan::Model& model)
      : renderer_(std::move(device)), world_(preview::world_of(borrowed(model), {})) {}

  Result<image::Image> render(const preview::View& view, const preview::RenderOptions& options,
                              DiagnosticLog& log) {
    preview::set_view(world_, view);
    return renderer_.render(world_, view.camera, options, log);
  }
  double seconds_of_bare_draw(const preview::View& view) {
    preview::set_view(world_, view);
    return renderer_.seconds_of_bare_draw(world_, view.camera);
  }
  preview::Renderer& renderer() { return renderer_; }

 private:
  preview::Renderer renderer_;
  world::World world_;
};

}  // namespace panwright::support
