// State of a device and of its models. Private to preview.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <vector>

#include "preview/device.h"
#include "preview/gl/programs.h"
#include "preview/model/draw_list.h"
#include "preview/model/gpu_model.h"

namespace panwright::preview {

struct ModelResources::Impl {
  Impl(std::shared_ptr<Device> device_in, world::ModelPtr model_in)
      : device(std::move(device_in)), model(std::move(model_in)) {}
  ~Impl();

  std::shared_ptr<Device> device;
  world::ModelPtr model;
  std::vector<DrawItem> list;  // of the model at rest
  Families brdf_models;        // shading classes
  LayerSet layers = 0;         // needed by its items
  LayerSet filter_layers = 0;  // and with RenderOptions::specular_filter
  LayerSet layers_for(bool filter) const { return filter ? filter_layers : layers; }
  GpuModel gpu;
  std::uint64_t triangles = 0;
};

struct Device::Impl {
  explicit Impl(std::unique_ptr<Context> context_in)
      : context(std::move(context_in)),
        programs(context->gl()),
        read_through_buffers(context->is_hardware()) {}
  ~Impl() { context->make_current(); }  // the members delete their objects

  // Makes the context current. Fails: E5001, for ever after the context was lost.
  bool ready(DiagnosticLog& log);
  // Returns true if no error occurred since the last call. Fails: E5001 when the context is lost,
  // E5003.
  bool went_well(DiagnosticLog& log);
  // Waits for the requested programs. Fails: E5001 when the driver refuses a shader.
  bool programs_ready(DiagnosticLog& log);

  std::unique_ptr<Context> context;
  Programs programs;
  std::map<const pan::Model*, std::weak_ptr<const ModelResources>> models;
  std::uint64_t models_uploaded = 0;
  std::uint64_t model_bytes = 0;
  bool lost = false;
  // True: pixels are copied through buffers (read_back.h). Tests set it before they draw.
  bool read_through_buffers = false;
};

}  // namespace panwright::preview
