// Videos of a view: around the target, or towards it. Frames are drawn one by one, then ffmpeg
// joins them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/job.h"
#include "preview/context.h"
#include "studio/eye.h"
#include "world/world.h"

namespace panwright::studio {

inline constexpr const char* kVideoKinds[] = {"turntable", "range sweep"};
inline constexpr const char* kVideoFrames[] = {"exact", "one sample a pixel"};

struct VideoPlan {
  std::string kind = kVideoKinds[0];
  std::string frame = kVideoFrames[0];  // how each frame is drawn
  double frames = 120;                  // in all
  double rate = 25;                     // of them, a second
  double range = 100;                   // metres, of a sweep's last frame
  std::string output = "video.mp4";
};

// The eyes of the frames. A turntable goes once around, the first frame being `eye`, its azimuth
// growing; a sweep goes from the range of `eye` to that of the plan in even ratios. Exposure stays
// at `ev`, stops, for all.
std::vector<Eye> video_eyes(const Eye& eye, const VideoPlan& plan, double ev);

// Where an executable file of that name is, of the folders of $PATH; empty: nowhere.
std::filesystem::path find_program(const std::string& name);

// Makes one video at a time, on a thread of its own.
class Video {
 public:
  Video() = default;
  ~Video();
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  // Frames are OUTPUT-frames/00001.png and so on; where ffmpeg makes a video of them they are
  // removed again. Expects: none under way; a folder that can be written is not needed: it is said.
  void make(const VideoPlan& plan, const std::filesystem::path& output,
            std::shared_ptr<const world::World> world, std::vector<Eye> eyes, std::uint32_t width,
            std::uint32_t height, preview::ContextKind context);
  void cancel();

  struct Status {
    bool busy = false;
    std::size_t done = 0, of = 0;  // frames
    std::string words;             // what came of the last one, or what is under way
  };
  Status status() const;

 private:
  void work(const VideoPlan& plan, const std::filesystem::path& output, const world::World& world,
            const std::vector<Eye>& eyes, std::uint32_t width, std::uint32_t height,
            preview::ContextKind context, const Job& job);
  bool draw(const VideoPlan& plan, const std::vector<std::filesystem::path>& frames,
            const world::World& world, const std::vector<Eye>& eyes, std::uint32_t width,
            std::uint32_t height, preview::ContextKind context, const Job& job);
  void say(const std::string& words);

  mutable std::mutex mutex_;
  Status status_;
  Job job_;
  std::thread thread_;
};

}  // namespace panwright::studio
