#include "base/job.h"

#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cassert>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

#include "base/internal/job_state.h"

namespace panwright {

static_assert(std::atomic<bool>::is_always_lock_free, "signal handlers set it");

namespace {

// Arenas of jobs that have ended: as many as there were jobs at the same time.
struct Arenas {
  std::mutex mutex;
  std::vector<std::unique_ptr<tbb::task_arena>> kept;
};

// never destroyed: jobs may end after it
Arenas& arenas() {
  static Arenas& all = *new Arenas;
  return all;
}

tbb::task_arena* kept_arena(int threads) {
  Arenas& all = arenas();
  const std::lock_guard lock(all.mutex);
  for (auto& each : all.kept) {
    if (each->max_concurrency() != threads) continue;
    std::swap(each, all.kept.back());
    tbb::task_arena* const arena = all.kept.back().release();
    all.kept.pop_back();
    return arena;
  }
  return new tbb::task_arena(threads);
}

}  // namespace

void KeepArena::operator()(tbb::task_arena* arena) const {
  std::unique_ptr<tbb::task_arena> ended(arena);
  Arenas& all = arenas();
  const std::lock_guard lock(all.mutex);
  try {
    all.kept.push_back(std::move(ended));
  } catch (const std::bad_alloc&) {
    // it goes
  }
}

Job::Job(JobOptions options) : state_(std::make_shared<State>()) {
  state_->stop = std::make_shared<std::atomic<bool>>(false);
  state_->threads = options.threads;
  state_->listener = std::move(options.progress);
}

Job Job::with(JobOptions options) const {
  Job out(std::move(options));
  if (state_) out.state_->stop = state_->stop;
  return out;
}

void Job::cancel() const noexcept {
  assert(state_);
  if (state_) state_->stop->store(true, std::memory_order_relaxed);
}

bool Job::cancelled() const noexcept {
  return state_ && state_->stop->load(std::memory_order_relaxed);
}

std::size_t Job::threads() const {
  return state_ && state_->threads > 0 ? state_->threads
                                       : static_cast<std::size_t>(tbb::info::default_concurrency());
}

Phase::Phase(const Job& job, std::string_view name, std::uint64_t total)
    : state_(total > 0 && job.state() && job.state()->listener ? job.state() : nullptr),
      name_(name),
      total_(total) {
  if (!state_) return;
  const std::lock_guard lock(state_->mutex);
  depth_ = state_->depth++;
  tell(0, false);
}

Phase::~Phase() {
  if (!state_) return;
  const std::lock_guard lock(state_->mutex);
  --state_->depth;
  tell(done_, true);
}

void Phase::advance(std::uint64_t steps, double work) {
  if (!state_) return;
  const std::lock_guard lock(state_->mutex);
  done_ = steps < total_ - done_ ? done_ + steps : total_;
  work_ = work;
  tell(done_, false);
}

void Phase::tell(std::uint64_t done, bool finished) {
  state_->listener({name_, done, total_, depth_, finished, work_});
}

void run_on_threads(const Job& job, const std::function<void()>& work) {
  if (!job.state() || job.state()->threads == 0) return work();
  Job::State& state = *job.state();
  std::call_once(state.arena_made,
                 [&] { state.arena.reset(kept_arena(static_cast<int>(state.threads))); });
  state.arena->execute(work);
}

void report_cancelled(DiagnosticLog& log) {
  if (!log.contains(Code("E0001")))
    log.report(Code("E0001"), {}, "cancelled before the work was complete");
}

}  // namespace panwright
