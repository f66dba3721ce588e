// Draws images on a thread of its own, with the renderer of `panwright render`.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/job.h"
#include "preview/context.h"
#include "preview/image.h"
#include "preview/renderer.h"
#include "studio/details.h"
#include "studio/eye.h"
#include "studio/layers.h"
#include "studio/project.h"
#include "world/world.h"

namespace panwright::studio {

// What is to be drawn.
struct Order {
  std::shared_ptr<const world::World> world;
  Eye eye;
  std::uint32_t width = 0;   // pixels
  std::uint32_t height = 0;  // pixels
  // nodes that are not shown: target, node
  std::vector<std::pair<std::size_t, std::uint32_t>> hidden;
  // where the exact image is compared with the reference renderer's: its bounces of light
  std::optional<std::uint32_t> reference_bounces = {};
  bool edges = false;  // of triangles, over the exact image
  bool operator==(const Order&) const = default;
};

// What was drawn.
struct DrawnImage {
  Order order;
  enum class Stage {
    following,  // pixels with one sample each, and fewer of them
    whole,      // one sample in each pixel
    exact,      // what `panwright render` makes of the same options, and its truth layers
  };
  Stage stage = Stage::following;
  bool exact = false;
  double coarser =
      1;  // of one that follows: its levels of detail are those of pixels so many times as wide
  preview::Image image;            // of radiance
  std::vector<std::uint8_t> rgba;  // 4*H*W of the image, sRGB
  double ev = 0;                   // that these are shown with
  std::vector<std::uint8_t> edges;  // edges_of(), where the order asks for them
  std::vector<Detail> details;      // of an exact image
  preview::SamplingReport sampling;
  double seconds = 0;
  std::vector<Message> messages;
  bool failed = false;  // there is no image
  // of an exact image that is compared: the same view by the reference renderer, ever finer
  std::shared_ptr<const preview::ReferenceImage> reference;
  std::uint32_t reference_samples = 0;  // of a pixel
  double reference_seconds = 0;
  Comparison comparison;
};

// While orders come one after the other, each is drawn quickly, with fewer pixels where that takes
// too long. As soon as they stop the last one is drawn with all pixels, then as it will be saved, then, where it
// asks for that, by the reference renderer, with four times as many samples each time.
class Artist {
 public:
  // news: called by its thread when take() has something
  explicit Artist(preview::ContextKind context, std::function<void()> news = {});
  ~Artist();
  Artist(const Artist&) = delete;
  Artist& operator=(const Artist&) = delete;

  // The newest order; those before it are given up. One that is being drawn exactly stops.
  void draw(Order order);
  // What was drawn last; null: nothing new.
  std::shared_ptr<const DrawnImage> take();

  struct Status {
    bool drawing = false;  // or about to
    bool exact = false;    // what is being drawn
    bool comparing = false;  // the reference is being drawn, or about to
    std::string renderer;  // of the OpenGL context
    double frame_seconds = 0;  // of images that follow the mouse, a running mean
    double scale = 1;          // their pixels, in parts of the exact one's, a side
    double coarser = 1;        // their levels of detail are those of pixels so many times as wide
    double rate = 0;           // of them, a second, while one follows the other
    std::uint64_t quick = 0;   // drawn so far
    std::uint64_t exact_count = 0;
    std::string problem;  // no OpenGL
  };
  Status status() const;

 private:
  struct Easel;
  void work();
  bool paint(Easel& easel, const Order& order, DrawnImage::Stage stage, const Job& job);
  void trace(Easel& easel, const Order& order, const Job& job);
  void adapt(double seconds);
  void count_follower();

  preview::ContextKind context_;
  std::function<void()> news_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<Order> wanted_;  // newer than what was drawn
  std::optional<Order> drawn_;   // the last one, up to `stage_`
  DrawnImage::Stage stage_ = DrawnImage::Stage::exact;
  std::size_t traced_ = 0;  // passes of the reference over the last exact image
  std::shared_ptr<const DrawnImage> done_;
  Status status_;
  std::size_t effort_ = 0;                          // of images that follow
  std::chrono::steady_clock::time_point followed_;  // the last image that follows came then, or 0
  double following_seconds_ = 0;                    // from one of them to the next, in all
  std::uint64_t followers_ = 0;
  Job job_;  // of what is being drawn
  bool ending_ = false;
  std::thread thread_;
};

// 4·W·H bytes as write_image() has them in a PNG, with alpha 255. ev: stops
std::vector<std::uint8_t> shown_pixels(const preview::Image& image, double ev);

}  // namespace panwright::studio
