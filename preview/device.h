// Context with the shared state of its renderers: shader programs, and models on the GPU.
#pragma once

#include <cstdint>
#include <memory>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "preview/context.h"
#include "world/world.h"

namespace panwright::preview {

// Model on the GPU: vertices, textures, materials. It never changes, holds the model, and is freed
// with its last owner. Renderers own those of the last drawn world; other owners keep a model
// between worlds.
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

// OpenGL context with its programs and uploaded models. Any number of renderers may share it. A
// device with its renderers belongs to one thread at a time: before another thread takes over, call
// context().release() on the first.
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

  // Returns a model on the GPU, found by the identity of the pan::Model, else uploaded.
  //
  // Expects: model is not null and checked().
  // Fails: E0001; E5001 when the context is lost; E5003 when a texture or the whole is too large
  // for the context, which stays unchanged. Cost: that of a look-up, or one upload of the model.
  Result<std::shared_ptr<const ModelResources>> resources(const world::ModelPtr& model,
                                                          DiagnosticLog& log, const Job& job = {});
  // The same without an upload; null: not uploaded.
  std::shared_ptr<const ModelResources> find(const world::ModelPtr& model) const;

  // Counts of work so far.
  struct Counts {
    std::uint64_t models = 0;       // uploaded
    std::uint64_t model_bytes = 0;  // of them
    std::uint64_t programs = 0;     // built
    // of the context, for any purpose: see ContextCounts
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
