// Times of steps. Private to workspace.
#pragma once

#include <chrono>
#include <string>
#include <utility>

#include "base/clock.h"
#include "workspace/open.h"

namespace panwright::workspace {

// Scope that adds its duration as a step to a report, if there is one.
class Stopwatch {
 public:
  Stopwatch(OpenReport* report, std::string name)
      : report_(report), name_(std::move(name)), start_(Clock::now()) {}
  ~Stopwatch() {
    if (report_ == nullptr) return;
    const double seconds = seconds_since(start_);
    report_->steps.push_back({std::move(name_), seconds});
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  OpenReport* report_;
  std::string name_;
  Clock::time_point start_;
};

}  // namespace panwright::workspace
