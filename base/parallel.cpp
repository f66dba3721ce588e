#include "base/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace panwright {

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body, const Job& job) {
  const auto work = [&] {
    // a single item needs no threads, and starting them costs milliseconds
    if (count <= 1 || tbb::this_task_arena::max_concurrency() == 1) {
      for (std::size_t i = 0; i < count; ++i) {
        job.poll();
        body(i);
      }
      return;
    }
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      if (!job.cancelled()) body(i);
    });
  };
  // note: a reference fits into std::function without memory of its own
  run_on_threads(job, std::ref(work));
  job.poll();
}

}  // namespace panwright
