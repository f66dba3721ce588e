// Thread that owns an OpenGL context, and images on the way from it.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "python/picture.h"
#include "workspace/frame.h"
#include "workspace/run.h"
#include "workspace/views.h"
#include "world/world.h"

namespace panwright::python {

// Views that are drawn together, and their images.
class Batch {
 public:
  Batch(std::vector<workspace::View> all, std::uint64_t number, std::size_t threads)
      : views(std::move(all)), first(number), job({threads, {}}) {}

  // For the worker.
  void add(std::shared_ptr<Picture> picture);
  void end();

  // Waits a moment for the next image. Returns false while there is none.
  //
  //   image  null after the last one
  bool next(std::shared_ptr<Picture>& image);

  const std::vector<workspace::View> views;
  const std::uint64_t first;  // number of the first view
  const Job job;
  DiagnosticLog log;  // the worker's until the end

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<Picture>> pictures_;
  bool ended_ = false;
};

// Draws batches of one world, in order, on one thread.
class Worker {
 public:
  Worker(world::World world, workspace::RecordSource source, preview::ContextKind context);
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  const world::World& world() const { return world_; }
  // Begins a batch.
  void begin(std::shared_ptr<Batch> batch);
  // Cancels what is under way, and ends the thread.
  void close();
  bool closed() const { return closed_; }
  workspace::EngineInfo info() const;

 private:
  void serve();
  void draw(Batch& batch, workspace::Runner& runner, workspace::FrameMaker& maker);

  const world::World world_;
  const workspace::RecordSource source_;
  const preview::ContextKind context_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<Batch>> waiting_;
  std::shared_ptr<Batch> current_;
  workspace::EngineInfo info_;
  bool closed_ = false;
  std::thread thread_;
};

}  // namespace panwright::python
