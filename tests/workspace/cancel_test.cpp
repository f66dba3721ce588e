// Whatever is cancelled, at any point, leaves whole files or none, and says E0001.

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <random>
#include <set>
#include <thread>

#include "tests/support/paths.h"
#include "tests/support/process.h"
#include "workspace/workspace.h"

namespace panwright::workspace::cancel_test {
namespace {

namespace fs = std::filesystem;
using support::TemporaryFolder;

const std::string kExamples = PANWRIGHT_SOURCE_DIR "/examples/";

std::set<std::string> files_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename());
  return names;
}

using Work = std::function<bool(DiagnosticLog&, const Job&)>;

// Runs work to its end, then again and again, cancelled after more and more of its progress, and at
// random times. `look` is called after each time that it was cancelled.
void cancel_everywhere(const Work& work, const std::function<void()>& look, std::size_t times = 8) {
  std::atomic<std::size_t> events = 0;
  const auto start = std::chrono::steady_clock::now();
  {
    DiagnosticLog log;
    ASSERT_TRUE(work(log, Job({0, [&](const Progress&) { ++events; }}))) << to_text(log);
  }
  const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - start;
  const auto check = [&](bool done, const DiagnosticLog& log, const Job& job) {
    // what was asked to stop may have come to its end just then
    EXPECT_NE(done, log.contains(Code("E0001"))) << to_text(log);
    if (!job.cancelled()) {
      EXPECT_TRUE(done);
    }
    if (!done) look();
  };
  for (std::size_t i = 0; i < times; ++i) {
    const std::size_t at = 1 + i * events / times;
    std::atomic<std::size_t> seen = 0;
    Job job;
    const Job cancelling({0, [&](const Progress&) {
                            if (++seen == at) job.cancel();
                          }});
    job = cancelling;
    DiagnosticLog log;
    const bool done = work(log, job);
    check(done, log, job);
  }
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(0, 1);
  for (std::size_t i = 0; i < times; ++i) {
    const Job job(JobOptions{});
    const std::chrono::duration<double> wait(part(random) * whole);
    std::thread other([&] {
      std::this_thread::sleep_for(wait);
      job.cancel();
    });
    DiagnosticLog log;
    const bool done = work(log, job);
    other.join();
    check(done, log, job);
  }
}

TEST(Cancel, ACompilationWritesAWholeFileOrNone) {
  const TemporaryFolder folder;
  const std::string output = folder / "cubesat.pan";
  std::string whole;
  cancel_everywhere(
      [&](DiagnosticLog& log, const Job& job) {
        auto scene = read_scene(kExamples + "cubesat/cubesat.pxn", {}, log, job);
        if (!scene) return false;
        if (!write_pan(*scene, {},
                       {.output = output, .strip_sources = false, .storage = {}, .origin = {}}, log,
                       job))
          return false;
        if (whole.empty()) whole = support::contents(output);
        EXPECT_TRUE(support::contents(output) == whole);
        fs::remove(output);
        return true;
      },
      [&] { EXPECT_TRUE(files_in(folder.path()).empty()); });
}

TEST(Cancel, AnImportThatLosesHiddenPartsStops) {
  const TemporaryFolder folder;
  cancel_everywhere(
      [&](DiagnosticLog& log, const Job& job) {
        return open(kExamples + "cad/relay.pxn", {}, log, job).ok();
      },
      [] {}, 3);
}

TEST(Cancel, ViewsAreWholeOrNotThere) {
  const TemporaryFolder folder;
  DiagnosticLog log;
  const TargetFile file{"figure8", kExamples + "paper/figure8.pxn"};
  const auto world = open_world({&file, 1}, {}, log);
  ASSERT_TRUE(world) << to_text(log);
  std::vector<Frame> views;
  FrameMaker maker(*world);
  for (int i = 0; i < 6; ++i) {
    Settings settings;
    settings.size = ImageSize{64, 64};
    settings.camera = Vec3(i, -6, 1);
    settings.outputs = {folder / (std::to_string(i) + ".exr")};
    settings.engine = Engine::reference;
    settings.samples = 6;
    const auto view = maker.frame(settings, log);
    ASSERT_TRUE(view);
    views.push_back(*view);
  }
  RunOptions options;
  std::vector<std::string> whole;
  std::set<std::string> names;
  const auto clear = [&] {
    for (const auto& entry : fs::directory_iterator(folder.path())) fs::remove(entry.path());
  };
  cancel_everywhere(
      [&](DiagnosticLog& said, const Job& job) {
        if (!run_frames(*world, views, options, said, job)) return false;
        if (whole.empty())
          for (const Frame& view : views) whole.push_back(support::contents(view.outputs[0]));
        names = files_in(folder.path());
        EXPECT_EQ(names.size(), views.size());
        clear();
        return true;
      },
      [&] {
        for (std::size_t i = 0; i < views.size(); ++i)
          if (fs::exists(views[i].outputs[0])) {
            EXPECT_TRUE(support::contents(views[i].outputs[0]) == whole[i]);
          }
        for (const std::string& name : files_in(folder.path())) EXPECT_TRUE(names.contains(name));
        clear();
      });
}

}  // namespace
}  // namespace panwright::workspace::cancel_test
