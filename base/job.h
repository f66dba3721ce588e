// Long work under the control of a host: number of threads, progress, cancellation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <type_traits>
#include <utility>

#include "base/diagnostic.h"
#include "base/result.h"

namespace panwright {

// Progress of a phase of the work. Phases may be nested, as an image among many and its rows, and
// several may run at once.
struct Progress {
  std::string_view phase;   // "tessellating"
  std::uint64_t done = 0;   // ≤ total
  std::uint64_t total = 0;  // > 0
  std::size_t depth = 0;    // phases around this one
  bool finished = false;    // the phase is over, even if done is below total
  double work = 0;          // share of the time that is over, if known better; 0: done / total
};

// Called from any thread that works, one call at a time. It must not throw, and should be quick.
using ProgressListener = std::function<void(const Progress&)>;

struct JobOptions {
  std::size_t threads = 0;  // 0: all cores
  ProgressListener progress;
};

// The exception of poll(). It never leaves a function that takes a DiagnosticLog: such a function
// reports E0001 and returns failed. A function that takes a Job and no log lets it pass.
struct Cancelled {};

// The handle of one piece of work, kept by the host and passed to libraries as the last argument of
// long functions. The default one uses all cores, has no listener and cannot be cancelled. Copies
// are cheap and share the same work. Results never depend on it. Thread-safe.
class Job {
 public:
  Job() = default;
  explicit Job(JobOptions options);

  // The same work, cancelled together, with other threads and another listener.
  Job with(JobOptions options) const;

  // Asks the work to stop; it does so soon, with E0001, and leaves nothing half-written. May be
  // called from a signal handler. Expects: not a default Job.
  void cancel() const noexcept;
  bool cancelled() const noexcept;
  void poll() const {
    if (cancelled()) throw Cancelled();
  }

  // Returns the maximum number of threads of this process for this work.
  std::size_t threads() const;

  // For base/job.cpp and base/parallel.cpp.
  struct State;
  const std::shared_ptr<State>& state() const { return state_; }

 private:
  std::shared_ptr<State> state_;  // null: the default
};

// One phase of a job. It informs the listener when it begins, advances and ends.
class Phase {
 public:
  // name: outlives the phase. total: 0: no progress is reported.
  Phase(const Job& job, std::string_view name, std::uint64_t total);
  ~Phase();
  Phase(const Phase&) = delete;
  Phase& operator=(const Phase&) = delete;

  // May be called from several threads.
  //
  //   work  the share of the time that is over, where steps differ in theirs
  void advance(std::uint64_t steps = 1, double work = 0);

 private:
  void tell(std::uint64_t done, bool finished);
  const std::shared_ptr<Job::State> state_;
  const std::string_view name_;
  const std::uint64_t total_;
  std::uint64_t done_ = 0;
  std::size_t depth_ = 0;
  double work_ = 0;
};

// Calls work on the threads of a job: all that it runs in parallel uses no more, including
// parallel_for without a job and builders of acceleration structures. Lets exceptions pass. note:
// where two threads of the host share a job with a number of threads, one may do the other's work:
// keep out work bound to its thread, such as an OpenGL context
void run_on_threads(const Job& job, const std::function<void()>& work);

// Reports E0001, once for each log.
void report_cancelled(DiagnosticLog& log);

// Runs the work of a public function on the threads of its job. When cancelled, reports E0001 and
// returns failed, or false.
//
//   work  returns a Result or a bool
template <class Work>
auto run_job(const Job& job, DiagnosticLog& log, Work&& work) -> std::invoke_result_t<Work> {
  using Value = std::invoke_result_t<Work>;
  constexpr bool kIsBool = std::is_same_v<Value, bool>;
  using Store = std::conditional_t<kIsBool, Result<bool>, Value>;
  Store result = failed;
  try {
    job.poll();
    run_on_threads(job, [&] { result = std::forward<Work>(work)(); });
  } catch (const Cancelled&) {
    report_cancelled(log);
    result = failed;
  }
  if constexpr (kIsBool)
    return result && *result;
  else
    return result;
}

}  // namespace panwright
