#include <fmt/core.h>
#include <imgui.h>

#include <chrono>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "base/program.h"
#include "base/text.h"
#include "studio/panels.h"
#include "workspace/run.h"

namespace panwright::studio {

void SavePanel::draw() {
  Widgets& widgets = state_.widgets;
  widgets.text("save/file", output_, "image.png", ".png, .exr, .npy or .npz");
  ImGui::BeginDisabled(saving_.valid() || !state_.models.world);
  if (widgets.button("save/save", "Save the image of the command below")) save();
  ImGui::EndDisabled();
  ImGui::TextWrapped("%s", saving_.valid() ? "saving" : message_.c_str());
  if (!state_.parts.hidden.empty())
    ImGui::TextWrapped("%s hidden in the window only: files and the command include them.",
                       counted(state_.parts.hidden.size(), "part").c_str());
  ImGui::Separator();
  const std::string command = this->command();
  if (widgets.button("save/copy the command")) ImGui::SetClipboardText(command.c_str());
  ImGui::TextWrapped("%s", command.c_str());
  ImGui::Separator();
  video();
}

void SavePanel::poll() {
  if (saving_.valid() && saving_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
    message_ = saving_.get();
}

std::string SavePanel::command() const {
  std::string out =
      command_line(state_.view, static_cast<std::uint32_t>(state_.image_size.x),
                   static_cast<std::uint32_t>(state_.image_size.y), state_.models.targets, output_);
  // the context is recorded in the file
  if (state_.options.context == preview::ContextKind::egl) out += " --gl egl";
  if (state_.options.context == preview::ContextKind::osmesa) out += " --gl osmesa";
  return out;
}

void SavePanel::save() {
  const std::filesystem::path path = state_.output_path(output_);
  workspace::Settings settings = state_.settings();
  settings.outputs = {path.string()};
  std::vector<std::string> files;
  for (const std::string& each : state_.models.targets)
    files.push_back(workspace::target_file(each).file.string());
  saving_ = std::async(std::launch::async,
                       [settings, world = state_.models.world, path, files = std::move(files),
                        inputs = state_.project.inputs(), open = state_.options.open,
                        context = state_.options.context]() -> std::string {
                         DiagnosticLog log;
                         log.set_files(inputs);
                         const auto frame = workspace::FrameMaker(*world).frame(settings, log);
                         if (frame) {
                           workspace::RunOptions options{context, {}, {files, open}};
                           if (workspace::run_frames(*world, std::span(&*frame, 1), options, log))
                             return "saved " + path.string();
                         }
                         for (const Message& each : messages_of(log))
                           if (each.severity == Severity::error) return each.text;
                         return "not saved";
                       });
}

void SavePanel::video() {
  const Video::Status status = video_.status();
  const bool encodes = !find_program("ffmpeg").empty();
  ImGui::TextUnformatted("Video");
  ImGui::BeginDisabled(status.busy);
  video_settings();
  ImGui::EndDisabled();
  if (status.busy) {
    if (state_.widgets.button("video/cancel")) video_.cancel();
    ImGui::SameLine();
    ImGui::ProgressBar(
        status.of > 0 ? static_cast<float>(status.done) / static_cast<float>(status.of) : 0,
        {-1, 0}, fmt::format("{} of {}", status.done, status.of).c_str());
  } else {
    const bool orbits = state_.view.camera.frame.empty() && state_.view.own() == nullptr;
    ImGui::BeginDisabled(!state_.models.world || !state_.result || !orbits ||
                         video_settings_.output.empty());
    if (state_.widgets.button(encodes ? "video/make=make video" : "video/make=draw frames",
                              "With the exposure of the displayed image"))
      start_video();
    ImGui::EndDisabled();
    if (!orbits)
      ImGui::TextWrapped("%s", state_.view.own() != nullptr
                                   ? "Of the scenario: panwright run --video. Or switch to the "
                                     "view from outside."
                                   : "Leave the camera frame to make a video.");
  }
  if (!encodes)
    ImGui::TextWrapped("Install ffmpeg for a video; without it, frames are written as PNG files.");
  ImGui::TextWrapped("%s", status.message.c_str());
}

void SavePanel::video_settings() {
  Widgets& widgets = state_.widgets;
  VideoSettings& settings = video_settings_;
  widgets.choice("video", settings.kind, kVideoKinds, std::size(kVideoKinds),
                 "Once around the centre, or to another range in equal ratios");
  widgets.slider("video/frames", settings.frames, 2, 5000, "%.0f");
  widgets.slider("video/frames a second=frames per second", settings.rate, 1, 120, "%.0f");
  if (settings.kind == kVideoKinds[1])
    widgets.slider("video/to range", settings.range, kNearest, kFarthest, "%.6g m", true,
                   "Range of the last frame");
  ImGui::TextUnformatted("Quality of each frame");
  widgets.choice("video frame", settings.frame, kVideoFrames, std::size(kVideoFrames),
                 "As the exact image, or faster with one sample per pixel");
  widgets.text("video/output", settings.output, "video.mp4",
               ".mp4, .mkv, .mov, .webm, .avi or .gif");
}

void SavePanel::start_video() {
  video_settings_.frames = std::round(video_settings_.frames);
  const ViewState& view = state_.view;
  const double ev = view.auto_ev ? state_.result->ev : view.ev;
  video_.start({video_settings_, state_.output_path(video_settings_.output), state_.models.world,
                video_views(view, video_settings_, ev),
                static_cast<std::uint32_t>(state_.image_size.x),
                static_cast<std::uint32_t>(state_.image_size.y), state_.options.context,
                state_.project.inputs()});
}

}  // namespace panwright::studio
