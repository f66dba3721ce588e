#include "tools/progress_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "tools/print.h"

namespace panwright::tools {

using namespace std::chrono_literals;

ProgressLine::ProgressLine() : terminal_(isatty(STDERR_FILENO) == 1) {}

void ProgressLine::wipe() {
  if (visible_) print(stderr, "\r\x1b[K");
  visible_ = false;
}

void ProgressLine::operator()(const Progress& progress) {
  if (!terminal_ || progress.total <= 1) return;
  if (phase_.empty() && !progress.finished) {
    phase_ = progress.phase;
    depth_ = progress.depth;
    start_ = shown_ = Clock::now();
  }
  if (progress.phase != phase_ || progress.depth != depth_) return;
  if (progress.finished) {
    wipe();
    phase_.clear();
    return;
  }
  const auto now = Clock::now();
  if (progress.done == 0 || now - start_ < 1s || now - shown_ < 200ms) return;
  shown_ = now;
  visible_ = true;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const double fraction = static_cast<double>(progress.done) / static_cast<double>(progress.total);
  print(stderr, "\r\x1b[K{} {:3.0f} % ({:.0f} s left)", phase_, 100 * fraction,
        seconds * (1 / fraction - 1));
  std::fflush(stderr);
}

}  // namespace panwright::tools
