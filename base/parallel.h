// Independent work on several threads.
#pragma once

#include <cstddef>
#include <functional>

#include "base/job.h"

namespace panwright {

// Calls body(i) for i in [0, count), in any order, on the threads of the job; without one, of the
// caller's job (run_on_threads), else on all cores. Results never depend on their number.
//
//   body  throws nothing but Cancelled
//   job   asked before each call; throws Cancelled once cancelled, when no body runs any more
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body,
                  const Job& job = {});

}  // namespace panwright
