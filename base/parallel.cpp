#include "base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <memory>

namespace panwright {

namespace {
std::size_t g_threads = 0;
std::unique_ptr<tbb::global_control> g_limit;
}  // namespace

void set_thread_count(std::size_t threads) {
  g_threads = threads;
  g_limit.reset();
  if (threads > 0)
    g_limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                    threads);
}

std::size_t thread_count() {
  return g_threads > 0 ? g_threads : static_cast<std::size_t>(tbb::info::default_concurrency());
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  // a single item needs no threads, and starting them costs milliseconds
  if (count <= 1 || g_threads == 1) {
    for (std::size_t i = 0; i < count; ++i) body(i);
    return;
  }
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { body(i); });
}

}  // namespace panwright
