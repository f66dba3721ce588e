// Images of a view, rendered in the background with the renderer of `panwright render`.
#pragma once

#include <array>
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
#include "image/image.h"
#include "preview/context.h"
#include "preview/renderer.h"
#include "sensor/imager.h"
#include "studio/details.h"
#include "studio/layers.h"
#include "studio/project.h"
#include "studio/view_state.h"
#include "workspace/detecting.h"
#include "workspace/drawer.h"
#include "world/world.h"

namespace panwright::studio {

// Image to render.
struct RenderRequest {
  std::shared_ptr<const world::World> world;
  ViewState view;
  std::uint32_t width = 0;   // pixels
  std::uint32_t height = 0;  // pixels
  double shown_scale = 1;    // pixels of the screen per side, over those of the image, at most 1
  std::vector<std::pair<std::size_t, std::uint32_t>> hidden;  // nodes: target, node
  // bounces of light of the reference image that the exact image is compared with; none: no
  // comparison
  std::optional<std::uint32_t> reference_bounces = {};
  bool edges = false;  // of triangles, over the exact image
  bool operator==(const RenderRequest&) const = default;
};

// Rendered image.
struct RenderResult {
  RenderRequest request;
  enum class Quality {
    interactive,  // one sample per pixel, at a reduced resolution where needed
    full_size,    // one sample per pixel
    exact,        // the image of `panwright render` with the same options, and its ground truth
  };
  Quality quality = Quality::interactive;
  bool exact = false;
  double level_scale =
      1;               // of an interactive image: factor on the pixel footprint of levels of detail
  image::Image image;  // of radiance
  std::vector<std::uint8_t> rgba;  // 4*H*W of the image, sRGB; of a detector its numbers, grey
  double ev = 0;                   // exposure of `rgba`, as of --ev, stops
  image::PngExposure exposure{0};  // the same, of the image's unit
  std::shared_ptr<const sensor::Imager> imager;  // of its numbers; null: there are none
  workspace::Detected detected;                  // of an imager
  std::vector<std::uint8_t> edges;               // edges_of(), where requested
  std::vector<Detail> details;                   // of an exact image
  preview::SamplingReport sampling;
  std::optional<workspace::LightBetween> between;
  double seconds = 0;
  std::vector<Message> messages;
  bool failed = false;  // there is no image
  // of an exact image that is compared: the same view by the reference renderer, with more samples
  // each time
  std::shared_ptr<const preview::ReferenceImage> reference;
  std::uint32_t reference_samples = 0;  // per pixel
  double reference_seconds = 0;
  Comparison comparison;
};

// An imager as interactive images have it: without optics and noise.
//
//   share  pixels of the image over those of the detector: as much light falls on each
sensor::Imager interactive_imager(sensor::Imager imager, double share);

// While requests follow each other, each is rendered quickly, at a reduced resolution where that
// takes too long. Once they stop, the last one is rendered at full size, then exactly. Where
// requested, the reference renderer follows, with four times as many samples each time.
class RenderThread {
 public:
  // notify: called by the thread when take() has a new result
  explicit RenderThread(preview::ContextKind context, std::function<void()> notify = {});
  ~RenderThread();
  RenderThread(const RenderThread&) = delete;
  RenderThread& operator=(const RenderThread&) = delete;

  // Replaces earlier requests. An exact image in progress is cancelled.
  void request(RenderRequest request);
  // The newest result since the last call; null: none.
  std::shared_ptr<const RenderResult> take();

  struct Status {
    bool drawing = false;    // in progress or pending
    bool exact = false;      // the image in progress is an exact one
    bool comparing = false;  // a reference image is in progress or pending
    std::string renderer;    // of the OpenGL context
    // of interactive images
    double frame_seconds = 0;     // running mean
    double resolution_scale = 1;  // pixels per side, over those of the exact image
    double level_scale = 1;       // factor on the pixel footprint of levels of detail
    double rate = 0;              // images per second, while they follow each other
    std::uint64_t interactive_count = 0;
    std::uint64_t exact_count = 0;
    std::string problem;  // why there is no OpenGL
  };
  Status status() const;

 private:
  struct Resources;
  struct Effort;
  static const std::array<Effort, 7> kEfforts;
  void work();
  bool render(Resources& resources, const RenderRequest& request, RenderResult::Quality quality,
              const Job& job);
  std::optional<workspace::Drawn> draw(Resources& resources, const RenderRequest& request,
                                       bool exact, const Effort& effort, DiagnosticLog& log,
                                       const Job& job);
  void publish(Resources& resources, std::shared_ptr<RenderResult> result);
  void trace(Resources& resources, const RenderRequest& request, const Job& job);
  void adapt(double seconds);
  void count_interactive();

  preview::ContextKind context_;
  std::function<void()> notify_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<RenderRequest> pending_;  // newer than `current_`
  std::optional<RenderRequest> current_;  // rendered last, up to `quality_`
  RenderResult::Quality quality_ = RenderResult::Quality::exact;
  std::size_t traced_ = 0;  // passes of the reference renderer over the last exact image
  std::shared_ptr<const RenderResult> result_;
  Status status_;
  std::size_t effort_ = 0;                                  // of interactive images
  std::chrono::steady_clock::time_point last_interactive_;  // zero: none in this movement
  double interactive_seconds_ = 0;                          // sum of the times between two of them
  std::uint64_t interactive_intervals_ = 0;
  Job job_;  // of the image in progress
  bool ending_ = false;
  std::thread thread_;
};

// 4*H*W bytes, as write_image() writes them to a PNG, with alpha 255.
std::vector<std::uint8_t> srgb_pixels(const image::Image& image,
                                      const image::PngExposure& exposure);

}  // namespace panwright::studio
