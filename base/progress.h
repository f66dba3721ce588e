// Progress on a terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace panwright {

// Shows "label  42 % (3 s left)" on standard error, on a terminal only, once a second has passed,
// and wipes it at the end. Silent otherwise. Not thread-safe.
class Progress {
 public:
  Progress(std::string label, std::size_t total);
  ~Progress();
  void advance(std::size_t steps = 1);

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  std::size_t total_;
  std::size_t done_ = 0;
  Clock::time_point start_ = Clock::now();
  Clock::time_point shown_ = start_;
  bool visible_ = false;
  bool terminal_;
};

}  // namespace panwright
