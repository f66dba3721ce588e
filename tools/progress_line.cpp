#include "tools/progress_line.h"

#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <optional>
#include <thread>

#include "base/clock.h"

namespace panwright::tools {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPatience = 2s;  // before anything is shown
constexpr auto kTick = 200ms;

// The line on standard error, which there is one of.
std::mutex g_mutex;
bool g_visible = false;

void wipe_locked() {
  if (g_visible) (void)std::fputs("\r\x1b[K", stderr);
  g_visible = false;
}

void show_line(const std::string& text) {
  const std::lock_guard lock(g_mutex);
  (void)std::fputs(("\r\x1b[K" + text).c_str(), stderr);
  std::fflush(stderr);
  g_visible = true;
}

// "350", "1.2k", "3.4M".
std::string short_number(double number) {
  for (const auto& [size, unit] : {std::pair(1e9, "G"), std::pair(1e6, "M"), std::pair(1e3, "k")})
    if (number >= 10 * size || (number >= size && unit[0] != 'k'))
      return fmt::format("{:.3g}{}", number / size, unit);
  return number < 100 ? fmt::format("{:.2g}", number) : fmt::format("{:.0f}", number);
}

std::string duration_words(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", seconds);
  if (seconds < 5400) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

}  // namespace

void wipe_progress() {
  const std::lock_guard lock(g_mutex);
  wipe_locked();
}

std::string progress_words(const Progress& progress, double seconds) {
  const double done = static_cast<double>(progress.done);
  const double total = static_cast<double>(progress.total);
  if (progress.total <= 1 || progress.done == 0 || !(seconds > 0))
    return fmt::format("{}: {}", progress.phase, duration_words(seconds));
  const double share = progress.work > 0 ? std::min(progress.work, 1.0) : done / total;
  return fmt::format("{} {:3.0f} %, {} of {}, {}/s, {} left", progress.phase, 100 * share,
                     short_number(done), short_number(total), short_number(done / seconds),
                     duration_words(seconds * (1 / share - 1)));
}

// What is told by threads that work, and shown by one of its own, so that a step that tells nothing
// is seen to be alive.
class ProgressLine::Ticker {
 public:
  explicit Ticker(std::string what) : what_(std::move(what)), thread_([this] { tick(); }) {}

  ~Ticker() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    wake_.notify_all();
    thread_.join();
    wipe_progress();
  }

  // Of nested phases the outermost one that has parts counts.
  void take(const Progress& progress) {
    if (progress.total <= 1) return;
    const std::lock_guard lock(mutex_);
    if (!phase_ && !progress.finished) {
      name_ = progress.phase;
      phase_ = progress;
      phase_start_ = Clock::now();
    } else if (phase_ && progress.phase == name_ && progress.depth == phase_->depth) {
      if (progress.finished)
        phase_.reset();
      else
        phase_ = progress;
    }
    if (phase_) phase_->phase = name_;
  }

 private:
  void tick() {
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, kTick, [this] { return ended_; })) {
      if (Clock::now() - start_ < kPatience) continue;
      if (phase_)
        show_line(progress_words(*phase_, seconds_since(phase_start_)));
      else
        show_line(progress_words({what_, 0, 0, 0, false}, seconds_since(start_)));
    }
  }

  const std::string what_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ended_ = false;
  const Clock::time_point start_ = Clock::now();
  std::string name_;               // of the phase
  std::optional<Progress> phase_;  // none: nobody tells
  Clock::time_point phase_start_;
  std::thread thread_;  // the last one: it uses all of them
};

ProgressLine::ProgressLine(std::string what) {
  if (isatty(STDERR_FILENO) == 1) ticker_ = std::make_unique<Ticker>(std::move(what));
}

ProgressLine::~ProgressLine() = default;

void ProgressLine::show(const Progress& progress) {
  if (ticker_) ticker_->take(progress);
}

void ProgressLine::end() { ticker_.reset(); }

}  // namespace panwright::tools
