#include "python/worker.h"

#include <utility>

namespace panwright::python {

void Batch::add(std::shared_ptr<Picture> picture) {
  const std::lock_guard lock(mutex_);
  pictures_.push_back(std::move(picture));
  changed_.notify_all();
}

void Batch::end() {
  const std::lock_guard lock(mutex_);
  ended_ = true;
  changed_.notify_all();
}

bool Batch::next(std::shared_ptr<Picture>& picture) {
  constexpr auto kPause = std::chrono::milliseconds(50);
  std::unique_lock lock(mutex_);
  if (!changed_.wait_for(lock, kPause, [&] { return ended_ || !pictures_.empty(); })) return false;
  picture = nullptr;
  if (pictures_.empty()) return true;
  picture = std::move(pictures_.front());
  pictures_.pop_front();
  return true;
}

Worker::Worker(world::World world, workspace::RecordSource source, preview::ContextKind context)
    : world_(std::move(world)), source_(std::move(source)), context_(context) {
  thread_ = std::thread([this] { serve(); });
}

Worker::~Worker() { close(); }

void Worker::begin(std::shared_ptr<Batch> batch) {
  const std::lock_guard lock(mutex_);
  waiting_.push_back(std::move(batch));
  changed_.notify_all();
}

void Worker::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    if (current_) current_->job.cancel();
    for (const auto& batch : waiting_) batch->job.cancel();
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

workspace::EngineInfo Worker::info() const {
  const std::lock_guard lock(mutex_);
  return info_;
}

// note: the runner, whose contexts are current on this thread, lives and ends here
void Worker::serve() {
  workspace::Runner runner;
  workspace::FrameMaker maker(world_);
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      current_ = nullptr;
      changed_.wait(lock, [&] { return closed_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      current_ = std::move(waiting_.front());
      waiting_.pop_front();
    }
    Batch& batch = *current_;
    try {
      draw(batch, runner, maker);
    } catch (...) {
      report_exception(batch.log);
    }
    batch.end();
  }
}

void Worker::draw(Batch& batch, workspace::Runner& runner, workspace::FrameMaker& maker) {
  DiagnosticLog& log = batch.log;
  std::vector<workspace::Frame> frames;
  for (const workspace::View& view : batch.views) {
    auto frame =
        workspace::check(view, log) ? maker.frame(view, log) : Result<workspace::Frame>(failed);
    if (frame) frames.push_back(*std::move(frame));
  }
  if (log.has_errors()) return;
  workspace::RunOptions options;
  options.context = context_;
  options.source = source_;
  options.listener.ready = [&](const workspace::EngineInfo& info) {
    const std::lock_guard lock(mutex_);
    info_ = info;
  };
  options.listener.kept = [&](workspace::Kept& kept) {
    const workspace::Frame& frame = frames[kept.what.frame];
    const workspace::View& view = batch.views[kept.what.frame];
    auto picture = std::make_shared<Picture>();
    picture->camera = frame.camera();
    picture->name = view.settings.name ? *view.settings.name : view.labels ? view.labels->name : "";
    picture->number = view.labels ? view.labels->number : batch.first + kept.what.frame;
    picture->time = view.labels ? view.labels->time : 0;
    picture->what = std::move(kept.what);
    picture->product = std::get<workspace::ImageProduct>(std::move(kept.product));
    picture->labels = std::move(kept.labels);
    batch.add(std::move(picture));
  };
  (void)runner.run(world_, frames, options, log, batch.job);
}

}  // namespace panwright::python
