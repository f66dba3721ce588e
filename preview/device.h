// A context with what all renderers on it share: shader programs, and models on the GPU.
#pragma once

#include <cstdint>
#include <memory>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "preview/context.h"
#include "world/world.h"

namespace panwright::preview {

// A model on the GPU: vertices, textures, materials. It never changes, holds the model, and is
// taken off the GPU with its last owner. Renderers hold those of the world they drew last; whoever
// wants a model to stay between worlds holds it too.
class ModelResources {
 public:
  struct Impl;
  explicit ModelResources(std::unique_ptr<Impl> impl);
  ~ModelResources();
  ModelResources(const ModelResources&) = delete;
  ModelResources& operator=(const ModelResources&) = delete;

  const world::ModelPtr& model() const;
  std::uint64_t triangles() const;  // instances counted
  std::uint64_t bytes() const;      // uploaded so far

  Impl& impl() const { return *impl_; }  // for this library

 private:
  std::unique_ptr<Impl> impl_;
};

// One OpenGL context, the programs built on it and the models uploaded to it. Any number of
// renderers may share it. A device with its renderers belongs to one thread at a time: before
// another thread takes over, context().release() on the first.
class Device : public std::enable_shared_from_this<Device> {
 public:
  // Fails: E5001; E5007 in a build without OpenGL.
  static Result<std::shared_ptr<Device>> create(ContextKind kind, DiagnosticLog& log);
  // Expects: not null.
  static std::shared_ptr<Device> create(std::unique_ptr<Context> context);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  Context& context() const;

  // A model on the GPU, found by the identity of the pan::Model, else uploaded.
  //
  // Expects: model is not null and checked().
  // Fails: E0001; E5001 when the context is lost; E5003 when a texture or the whole is too large
  // for the context, which then holds what it held before. Cost: that of a look-up, or one upload
  // of the model.
  Result<std::shared_ptr<const ModelResources>> resources(const world::ModelPtr& model,
                                                          DiagnosticLog& log, const Job& job = {});
  // The same without an upload; null: it is not there.
  std::shared_ptr<const ModelResources> find(const world::ModelPtr& model) const;

  // What was done so far.
  struct Counts {
    std::uint64_t models = 0;       // uploaded
    std::uint64_t model_bytes = 0;  // of them
    std::uint64_t programs = 0;     // built
    // of the context, whatever for: see ContextCounts
    std::uint64_t allocations = 0;
    std::uint64_t uploaded_bytes = 0;
  };
  Counts counts() const;

  struct Impl;
  Impl& impl() const { return *impl_; }  // for this library

 private:
  explicit Device(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::preview
