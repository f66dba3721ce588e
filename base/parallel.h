// Independent work on several threads.
#pragma once

#include <cstddef>
#include <functional>

namespace panwright {

// The threads that parallel_for uses: 0 means all cores. The result of a computation never
// depends on it.
void set_thread_count(std::size_t threads);
std::size_t thread_count();

// Calls body(i) for i in [0, count), in any order, on several threads; body must not throw.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

}  // namespace panwright
