// The shared state of a Job. Private to base.
#pragma once

#include <tbb/task_arena.h>

#include <atomic>
#include <memory>
#include <mutex>

#include "base/job.h"

namespace panwright {

// Keeps an arena for the next job with as many threads: TBB gives back the memory of one that ends
// late or never.
struct KeepArena {
  void operator()(tbb::task_arena* arena) const;
};

struct Job::State {
  std::shared_ptr<std::atomic<bool>> stop;  // shared with jobs that are cancelled together
  std::size_t threads = 0;                  // 0: all cores
  ProgressListener listener;                // called under the mutex
  std::mutex mutex;
  std::size_t depth = 0;  // phases under way
  std::once_flag arena_made;
  std::unique_ptr<tbb::task_arena, KeepArena> arena;  // with threads alone
};

}  // namespace panwright
