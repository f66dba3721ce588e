// Videos of a view, drawn frame by frame and encoded by ffmpeg: turntables and range sweeps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/file_uses.h"
#include "base/job.h"
#include "preview/context.h"
#include "studio/view_state.h"
#include "world/world.h"

namespace panwright::studio {

inline constexpr const char* kVideoKinds[] = {"turntable", "range sweep"};
inline constexpr const char* kVideoFrames[] = {"exact", "one sample a pixel=one sample per pixel"};

struct VideoSettings {
  std::string kind = kVideoKinds[0];
  std::string frame = kVideoFrames[0];  // quality of each frame
  double frames = 120;                  // number of frames
  double rate = 25;                     // frames per second
  double range = 100;                   // metres, of the last frame of a sweep
  std::string output = "video.mp4";
};

// Views of the frames. A turntable goes once around with growing azimuth, beginning at `view`; a
// sweep goes from the range of `view` to that of the settings in equal ratios. ev: exposure of all,
// stops
std::vector<ViewState> video_views(const ViewState& view, const VideoSettings& settings, double ev);

// Frames to draw, and their video.
struct VideoRequest {
  VideoSettings settings;
  std::filesystem::path output;
  std::shared_ptr<const world::World> world;
  std::vector<ViewState> views;
  std::uint32_t width = 0, height = 0;  // pixels
  preview::ContextKind context = preview::ContextKind::automatic;
  std::shared_ptr<FileUses> files = std::make_shared<FileUses>();  // of the models
};

// Makes one video at a time, on a thread of its own.
class Video {
 public:
  Video() = default;
  ~Video();
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  // Draws OUTPUT-frames/00001.png and so on; removes them once ffmpeg has encoded a video. Errors
  // are in the status.
  //
  // Expects: no video in progress.
  void start(VideoRequest request);
  void cancel();

  struct Status {
    bool busy = false;
    std::size_t done = 0, of = 0;  // frames
    std::string message;           // progress, or the last result
  };
  Status status() const;

 private:
  void work(const VideoRequest& request, const Job& job);
  bool draw(const VideoRequest& request, const std::vector<std::filesystem::path>& frames,
            const Job& job);
  bool encode(const VideoRequest& request, const std::filesystem::path& program,
              const std::filesystem::path& folder, const Job& job);
  void set_message(const std::string& message);

  mutable std::mutex mutex_;
  Status status_;
  Job job_;
  std::thread thread_;
};

}  // namespace panwright::studio
