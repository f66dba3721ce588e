#include "base/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#if defined(__SANITIZE_THREAD__)
#include <atomic>
#include <thread>
#include <vector>
#endif

namespace panwright {
namespace {

#if defined(__SANITIZE_THREAD__)
// ThreadSanitizer does not see what orders the tasks of TBB, whose library is not built for it:
// threads of the standard library do the same work there.
void call_for_each(std::size_t count, const std::function<void(std::size_t)>& body) {
  thread_local bool inside = false;
  const int threads = inside ? 1 : tbb::this_task_arena::max_concurrency();
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    inside = true;
    for (std::size_t i = next++; i < count; i = next++) body(i);
    inside = false;
  };
  if (threads == 1) {
    for (std::size_t i = 0; i < count; ++i) body(i);
    return;
  }
  std::vector<std::thread> others;
  for (int i = 1; i < threads; ++i) others.emplace_back(work);
  work();
  for (std::thread& thread : others) thread.join();
}
#else
void call_for_each(std::size_t count, const std::function<void(std::size_t)>& body) {
  tbb::parallel_for(std::size_t{0}, count, body);
}
#endif

}  // namespace

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
    call_for_each(count, [&](std::size_t i) {
      if (!job.cancelled()) body(i);
    });
  };
  // note: a reference fits into std::function without memory of its own
  run_on_threads(job, std::ref(work));
  job.poll();
}

}  // namespace panwright
