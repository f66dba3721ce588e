#include "studio/video.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/text.h"
#include "studio/project.h"
#include "workspace/run.h"
#include "workspace/views.h"

extern char** environ;

namespace panwright::studio {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kExtensions[] = {".mp4", ".mkv", ".mov", ".webm", ".avi", ".gif"};

// Runs a program without input and output. Whether it ended well; a job that is cancelled ends it.
bool run_program(const std::vector<std::string>& words, const Job& job) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  for (const int file : {0, 1, 2})
    ::posix_spawn_file_actions_addopen(&actions, file, "/dev/null", O_RDWR, 0);
  pid_t child = 0;
  const int failed =
      ::posix_spawn(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return false;
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (job.cancelled()) ::kill(child, SIGTERM);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return !job.cancelled() && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

std::vector<Eye> video_eyes(const Eye& eye, const VideoPlan& plan, double ev) {
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(plan.frames)));
  std::vector<Eye> out(count, eye);
  for (std::size_t i = 0; i < count; ++i) {
    out[i].auto_ev = false;
    out[i].ev = ev;
    if (plan.kind == kVideoKinds[0]) {
      out[i].azimuth = std::remainder(
          eye.azimuth + 360.0 * static_cast<double>(i) / static_cast<double>(count), 360.0);
    } else {
      const double share = count > 1 ? static_cast<double>(i) / static_cast<double>(count - 1) : 0;
      out[i].range =
          std::clamp(eye.range * std::pow(plan.range / eye.range, share), kNearest, kFarthest);
    }
  }
  return out;
}

fs::path find_program(const std::string& name) {
  const char* folders = std::getenv("PATH");
  std::string_view rest = folders == nullptr ? "" : folders;
  while (!rest.empty()) {
    const auto end = std::min(rest.find(':'), rest.size());
    const fs::path path = fs::path(rest.substr(0, end)) / name;
    std::error_code ignored;
    if (end > 0 && ::access(path.c_str(), X_OK) == 0 && fs::is_regular_file(path, ignored))
      return path;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return {};
}

Video::~Video() {
  cancel();
  if (thread_.joinable()) thread_.join();
}

void Video::cancel() {
  const std::lock_guard lock(mutex_);
  if (status_.busy && job_.state()) job_.cancel();
}

Video::Status Video::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void Video::say(const std::string& words) {
  const std::lock_guard lock(mutex_);
  status_.words = words;
}

void Video::make(const VideoPlan& plan, const fs::path& output,
                 std::shared_ptr<const world::World> world, std::vector<Eye> eyes,
                 std::uint32_t width, std::uint32_t height, preview::ContextKind context) {
  if (thread_.joinable()) thread_.join();
  {
    const std::lock_guard lock(mutex_);
    status_ = {true, 0, eyes.size(), "drawing frames"};
    job_ = Job(JobOptions{});
  }
  thread_ = std::thread([=, this, eyes = std::move(eyes), job = job_] {
    work(plan, output, *world, eyes, width, height, context, job);
    const std::lock_guard lock(mutex_);
    status_.busy = false;
  });
}

bool Video::draw(const VideoPlan& plan, const std::vector<fs::path>& frames,
                 const world::World& world, const std::vector<Eye>& eyes, std::uint32_t width,
                 std::uint32_t height, preview::ContextKind context, const Job& job) {
  DiagnosticLog log;
  workspace::ViewMaker maker(world);
  std::vector<workspace::View> views;
  std::optional<workspace::DrawOptions> options;
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    workspace::ViewText text = view_text(eyes[i], width, height);
    text.output = frames[i].string();
    auto view = maker.view(text, log);
    if (!options) {
      auto made = workspace::draw_options(text, context, log);
      if (made) options = *std::move(made);
    }
    if (!view || !options) break;
    views.push_back(*std::move(view));
  }
  bool good = views.size() == eyes.size();
  if (good) {
    if (plan.frame != kVideoFrames[0]) options->samples = 1;
    workspace::RunOptions run{*options, {}, {}};
    run.listener.written = [&](const workspace::Written&) {
      const std::lock_guard lock(mutex_);
      ++status_.done;
    };
    good = static_cast<bool>(workspace::run_views(world, views, run, log, job));
  }
  if (good) return true;
  if (job.cancelled()) return say("cancelled"), false;
  std::string why = "no frames could be drawn";
  for (const Message& each : messages_of(log))
    if (each.severity == Severity::error) {
      why = each.text;
      break;
    }
  say(why);
  return false;
}

void Video::work(const VideoPlan& plan, const fs::path& output, const world::World& world,
                 const std::vector<Eye>& eyes, std::uint32_t width, std::uint32_t height,
                 preview::ContextKind context, const Job& job) {
  const fs::path program = find_program("ffmpeg");
  const std::string extension = output.extension().string();
  if (!program.empty() &&
      std::find(std::begin(kExtensions), std::end(kExtensions), extension) == std::end(kExtensions))
    return say(
        fmt::format("videos are .mp4, .mkv, .mov, .webm, .avi or .gif, not '{}'", extension));
  fs::path folder = output;
  folder.replace_extension();
  folder += "-frames";
  std::error_code error;
  const bool made = fs::create_directories(folder, error);
  if (error) return say(fmt::format("{} cannot be made: {}", folder.string(), error.message()));
  std::vector<fs::path> frames;
  for (std::size_t i = 0; i < eyes.size(); ++i)
    frames.push_back(folder / fmt::format("{:05}.png", i + 1));
  const auto remove_frames = [&] {
    for (const fs::path& frame : frames) fs::remove(frame, error);
    if (made) fs::remove(folder, error);  // unless there is something else
  };
  if (!draw(plan, frames, world, eyes, width, height, context, job)) return remove_frames();
  const std::string count = counted(frames.size(), "frame");
  if (program.empty())
    return say(fmt::format("{} in {}; ffmpeg, which joins them, is not installed", count,
                           folder.string()));
  say("ffmpeg joins " + count);
  // widths and heights of most players are even
  const std::vector<std::string> words = {program.string(),
                                          "-y",
                                          "-loglevel",
                                          "error",
                                          "-framerate",
                                          fmt::format("{:g}", plan.rate),
                                          "-i",
                                          (folder / "%05d.png").string(),
                                          "-vf",
                                          "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                          "-pix_fmt",
                                          "yuv420p",
                                          output.string()};
  if (run_program(words, job)) {
    remove_frames();
    return say(fmt::format("saved {}: {}, {}", output.string(), count,
                           plan.frame == kVideoFrames[0] ? "each exact" : "with " + plan.frame));
  }
  if (job.cancelled()) {
    fs::remove(output, error);
    remove_frames();
    return say("cancelled");
  }
  say(fmt::format("ffmpeg could not join them; {} in {}", count, folder.string()));
}

}  // namespace panwright::studio
