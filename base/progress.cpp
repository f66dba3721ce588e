#include "base/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace panwright {

using namespace std::chrono_literals;

Progress::Progress(std::string label, std::size_t total)
    : label_(std::move(label)), total_(total), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (visible_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::advance(std::size_t steps) {
  done_ += steps;
  if (!terminal_ || total_ == 0) return;
  const auto now = Clock::now();
  if (now - start_ < 1s || now - shown_ < 200ms) return;
  shown_ = now;
  visible_ = true;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const double fraction = static_cast<double>(done_) / static_cast<double>(total_);
  fmt::print(stderr, "\r\x1b[K{} {:3.0f} % ({:.0f} s left)", label_, 100 * fraction,
             seconds * (1 / fraction - 1));
  std::fflush(stderr);
}

}  // namespace panwright
