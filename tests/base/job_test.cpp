#include "base/job.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "base/internal/job_state.h"
#include "base/parallel.h"

namespace panwright::job_test {
namespace {

TEST(Job, TheDefaultOneIsNeverCancelled) {
  const Job job;
  EXPECT_FALSE(job.cancelled());
  EXPECT_NO_THROW(job.poll());
  EXPECT_GE(job.threads(), 1u);
}

TEST(Job, CopiesAndThoseMadeWithItAreCancelledTogether) {
  const Job job(JobOptions{});
  const Job copy = job;
  const Job with = job.with({3, {}});
  const Job other(JobOptions{});
  EXPECT_EQ(with.threads(), 3u);
  with.cancel();
  EXPECT_TRUE(job.cancelled());
  EXPECT_TRUE(copy.cancelled());
  EXPECT_THROW(job.poll(), Cancelled);
  EXPECT_FALSE(other.cancelled());
}

TEST(RunJob, SaysOnceThatItWasCancelled) {
  const Job job(JobOptions{});
  job.cancel();
  DiagnosticLog log;
  int calls = 0;
  const auto work = [&]() -> Result<int> { return ++calls; };
  EXPECT_FALSE(run_job(job, log, work));
  EXPECT_FALSE(run_job(job, log, work));
  EXPECT_FALSE(run_job(job, log, [&] { return ++calls > 0; }));
  EXPECT_EQ(calls, 0);
  ASSERT_EQ(log.entries().size(), 1u);
  EXPECT_EQ(log.entries()[0].code, Code("E0001"));
  EXPECT_EQ(exit_code(log), 130);
}

TEST(RunJob, PassesOnWhatTheWorkReturnsAndCatchesNothingElse) {
  DiagnosticLog log;
  EXPECT_EQ(*run_job(Job(), log, []() -> Result<int> { return 5; }), 5);
  EXPECT_FALSE(run_job(Job(), log, []() -> Result<int> { return failed; }));
  EXPECT_TRUE(run_job(Job(), log, [] { return true; }));
  EXPECT_FALSE(run_job(Job(), log, [] { return false; }));
  EXPECT_TRUE(log.entries().empty());
  EXPECT_THROW(run_job(Job({2, {}}), log, []() -> bool { throw 1; }), int);
}

TEST(RunJob, WorkThatIsCancelledHalfWayIsLeft) {
  for (const std::size_t threads : {0u, 1u, 3u}) {
    const Job job({threads, {}});
    DiagnosticLog log;
    std::atomic<int> calls = 0;
    const bool done = run_job(job, log, [&] {
      parallel_for(
          1'000'000,
          [&](std::size_t) {
            if (++calls == 100) job.cancel();
          },
          job);
      return true;
    });
    EXPECT_FALSE(done);
    EXPECT_TRUE(log.contains(Code("E0001")));
    // those that ran when it was cancelled come to their end
    EXPECT_GE(calls, 100);
    EXPECT_LT(calls, 200);
  }
}

TEST(RunOnThreads, HoldsWhateverRunsInside) {
  for (const std::size_t threads : {1u, 2u, 3u}) {
    std::atomic<int> running = 0;
    std::atomic<int> most = 0;
    const auto body = [&](std::size_t) {
      const int now = ++running;
      int before = most;
      while (before < now && !most.compare_exchange_weak(before, now)) {
      }
      std::this_thread::sleep_for(std::chrono::microseconds(200));
      --running;
    };
    const Job job({threads, {}});
    run_on_threads(job, [&] {
      // neither a loop that is given no job, nor one within another, takes more
      parallel_for(8, [&](std::size_t) { parallel_for(8, body); });
    });
    EXPECT_GE(most, 1);
    EXPECT_LE(most, static_cast<int>(threads));
    most = 0;
    parallel_for(64, body, job);
    EXPECT_LE(most, static_cast<int>(threads));
  }
}

// A server has a job for each request: TBB kept 1 kB of each, 150 MB after two hours.
TEST(RunOnThreads, TheNextJobHasTheArenaOfTheLast) {
  const auto arena_of = [](const Job& job) {
    run_on_threads(job, [] {});
    return job.state()->arena.get();
  };
  const tbb::task_arena* last = nullptr;
  for (int i = 0; i < 3; ++i) {
    const tbb::task_arena* const arena = arena_of(Job({5, {}}));
    if (i > 0) EXPECT_EQ(arena, last);
    last = arena;
  }
  const Job one({5, {}}), beside({5, {}}), other({4, {}});
  EXPECT_NE(arena_of(one), arena_of(beside));
  EXPECT_EQ(arena_of(other)->max_concurrency(), 4);
}

TEST(Phase, TellsTheListenerFromBeginToEnd) {
  using Told = std::tuple<std::string, std::uint64_t, std::uint64_t, std::size_t, bool>;
  std::vector<Told> told;
  const Job job({0, [&](const Progress& p) {
                   told.emplace_back(p.phase, p.done, p.total, p.depth, p.finished);
                 }});
  {
    Phase outer(job, "outer", 2);
    {
      Phase inner(job, "inner", 3);
      inner.advance(2);
    }
    outer.advance();
    outer.advance(5);  // more than there is
    const Phase nothing(job, "nothing", 0);
  }
  const std::vector<Told> expected = {{"outer", 0, 2, 0, false}, {"inner", 0, 3, 1, false},
                                      {"inner", 2, 3, 1, false}, {"inner", 2, 3, 1, true},
                                      {"outer", 1, 2, 0, false}, {"outer", 2, 2, 0, false},
                                      {"outer", 2, 2, 0, true}};
  EXPECT_EQ(told, expected);
}

TEST(Phase, IsToldOneCallAtATime) {
  int inside = 0;
  bool overlapped = false;
  std::uint64_t last = 0;
  const Job job({0, [&](const Progress& p) {
                   overlapped |= ++inside != 1 || p.done < last;
                   last = p.done;
                   --inside;
                 }});
  {
    Phase phase(job, "many", 5000);
    parallel_for(
        5000, [&](std::size_t) { phase.advance(); }, job);
  }
  EXPECT_FALSE(overlapped);
  EXPECT_EQ(last, 5000u);
}

}  // namespace
}  // namespace panwright::job_test
