#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <ctime>

#include "bench/bench.h"

extern char** environ;

namespace panwright::bench {

namespace {

// linear between the two values around a place in sorted order
double quantile(const std::vector<double>& sorted, double place) {
  const double at = place * static_cast<double>(sorted.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const std::size_t high = std::min(low + 1, sorted.size() - 1);
  return sorted[low] + (at - static_cast<double>(low)) * (sorted[high] - sorted[low]);
}

bool of_processor = false;

double now() {
  if (!of_processor)
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

void use_processor_time() { of_processor = true; }
bool uses_processor_time() { return of_processor; }

std::vector<Timing> interleaved(const std::vector<Variant>& variants, int runs) {
  std::vector<std::vector<double>> seconds(variants.size());
  for (const Variant& variant : variants) variant.work();
  for (int run = 0; run < runs; ++run) {
    for (std::size_t i = 0; i < variants.size(); ++i) {
      if (variants[i].before) variants[i].before();
      const double start = now();
      variants[i].work();
      seconds[i].push_back(now() - start);
    }
  }
  std::vector<Timing> timings;
  for (std::vector<double>& list : seconds) {
    std::sort(list.begin(), list.end());
    timings.push_back({quantile(list, 0.5), quantile(list, 0.25), quantile(list, 0.75), runs});
  }
  return timings;
}

Timing timed(const std::function<void()>& work, int runs) {
  return interleaved({{"", work}}, runs).front();
}

void set_rate(Row& row, const Timing& timing, double amount) {
  row.speed = amount / timing.median;
  row.spread = 0.5 * (amount / timing.lower_quartile - amount / timing.upper_quartile);
  row.runs = timing.runs;
}

void set_time(Row& row, const Timing& timing, double factor) {
  row.speed = factor * timing.median;
  row.spread = 0.5 * factor * (timing.upper_quartile - timing.lower_quartile);
  row.runs = timing.runs;
}

int run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                double* peak_bytes) {
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int refused =
      posix_spawn(&child, words.front().c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (refused != 0) return -1;
  int status = 0;
  rusage usage{};
  if (wait4(child, &status, 0, &usage) != child) return -1;
  if (peak_bytes != nullptr) *peak_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace panwright::bench
