// Progress of a job on a terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

#include "base/job.h"

namespace panwright::tools {

// Shows the outermost phase that has parts as "rendering  42 % (3 s left)" on standard error, on a
// terminal only, once a second has passed, and wipes it at the end. Silent otherwise.
class ProgressLine {
 public:
  ProgressLine();
  void operator()(const Progress& progress);

 private:
  using Clock = std::chrono::steady_clock;
  void wipe();
  bool terminal_;
  bool visible_ = false;
  std::string phase_;  // that is shown; empty: none
  std::size_t depth_ = 0;
  Clock::time_point start_;
  Clock::time_point shown_;
};

}  // namespace panwright::tools
