#include "studio/video.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <system_error>
#include <utility>

#include "base/program.h"
#include "base/text.h"
#include "image/video.h"
#include "studio/project.h"
#include "workspace/run.h"
#include "workspace/views.h"

namespace panwright::studio {
namespace {

namespace fs = std::filesystem;

}  // namespace

std::vector<ViewState> video_views(const ViewState& view, const VideoSettings& settings,
                                   double ev) {
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(settings.frames)));
  std::vector<ViewState> out(count, view);
  for (std::size_t i = 0; i < count; ++i) {
    out[i].auto_ev = false;
    out[i].ev = ev;
    OrbitCamera& camera = out[i].camera;
    if (settings.kind == kVideoKinds[0]) {
      camera.azimuth = wrapped_degrees(view.camera.azimuth +
                                       360.0 * static_cast<double>(i) / static_cast<double>(count));
    } else {
      const double share = count > 1 ? static_cast<double>(i) / static_cast<double>(count - 1) : 0;
      camera.range =
          std::clamp(view.camera.range * std::pow(settings.range / view.camera.range, share),
                     kNearest, kFarthest);
    }
  }
  return out;
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

void Video::set_message(const std::string& message) {
  const std::lock_guard lock(mutex_);
  status_.message = message;
}

void Video::start(VideoRequest request) {
  if (thread_.joinable()) thread_.join();
  {
    const std::lock_guard lock(mutex_);
    status_ = {true, 0, request.views.size(), "drawing frames"};
    job_ = Job(JobOptions{});
  }
  thread_ = std::thread([this, request = std::move(request), job = job_] {
    try {
      work(request, job);
    } catch (const std::exception&) {
      DiagnosticLog log;
      report_exception(log);
      set_message(log.entries()[0].message);
    }
    const std::lock_guard lock(mutex_);
    status_.busy = false;
  });
}

bool Video::draw(const VideoRequest& request, const std::vector<fs::path>& frames, const Job& job) {
  DiagnosticLog log;
  log.set_files(request.files);
  workspace::FrameMaker maker(*request.world);
  std::vector<workspace::Frame> made;
  for (std::size_t i = 0; i < request.views.size(); ++i) {
    workspace::Settings settings = settings_of(request.views[i], request.width, request.height);
    settings.outputs = {frames[i].string()};
    if (request.settings.frame != kVideoFrames[0]) settings.samples = 1;
    auto frame = maker.frame(settings, log);
    if (!frame) break;
    made.push_back(*std::move(frame));
  }
  bool good = made.size() == request.views.size();
  if (good) {
    workspace::RunOptions run{request.context, {}, {}};
    run.listener.written = [&](const workspace::Written&) {
      const std::lock_guard lock(mutex_);
      ++status_.done;
    };
    good = static_cast<bool>(workspace::run_frames(*request.world, made, run, log, job));
  }
  if (good) return true;
  if (job.cancelled()) return set_message("cancelled"), false;
  std::string why = "no frames could be drawn";
  for (const Message& each : messages_of(log))
    if (each.severity == Severity::error) {
      why = each.text;
      break;
    }
  set_message(why);
  return false;
}

void Video::work(const VideoRequest& request, const Job& job) {
  const fs::path program = find_program("ffmpeg");
  const std::string extension = request.output.extension().string();
  if (!program.empty() &&
      std::ranges::find(image::kVideoExtensions, extension) == std::end(image::kVideoExtensions))
    return set_message(
        fmt::format("videos are .mp4, .mkv, .mov, .webm, .avi or .gif, not '{}'", extension));
  DiagnosticLog log;
  if (!program.empty() && !request.files->may_write(request.output, log))
    return set_message(log.entries()[0].message);
  fs::path folder = request.output;
  folder.replace_extension();
  folder += "-frames";
  std::error_code error;
  const bool made = fs::create_directories(folder, error);
  if (error)
    return set_message(fmt::format("{} cannot be made: {}", folder.string(), error.message()));
  std::vector<fs::path> frames;
  for (std::size_t i = 0; i < request.views.size(); ++i)
    frames.push_back(folder / fmt::format("{:05}.png", i + 1));
  const bool drawn = draw(request, frames, job);
  if (drawn && program.empty())
    return set_message(fmt::format("{} in {}; ffmpeg, which joins them, is not installed",
                                   counted(frames.size(), "frame"), folder.string()));
  if (drawn && !encode(request, program, folder, job)) return;
  for (const fs::path& frame : frames) fs::remove(frame, error);
  if (made) fs::remove(folder, error);  // unless it holds other files
}

// Returns whether the frames are to be removed.
bool Video::encode(const VideoRequest& request, const fs::path& program, const fs::path& folder,
                   const Job& job) {
  const std::string count = counted(request.views.size(), "frame");
  set_message("ffmpeg joins " + count);
  const bool encoded = image::encode_video(program, (folder / "%05d.png").string(),
                                           request.settings.rate, request.output, job);
  if (encoded) {
    const std::string& frame = request.settings.frame;
    set_message(fmt::format("saved {}: {}, {}", request.output.string(), count,
                            frame == kVideoFrames[0] ? "each exact" : "with " + frame));
    return true;
  }
  if (job.cancelled()) {
    std::error_code ignored;
    fs::remove(request.output, ignored);
    set_message("cancelled");
    return true;
  }
  set_message(fmt::format("ffmpeg could not join them; {} in {}", count, folder.string()));
  return false;
}

}  // namespace panwright::studio
