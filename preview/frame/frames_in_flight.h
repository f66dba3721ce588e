// Frames under way: their images, and the tiles of these that the context still draws. Private to
// preview.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "image/image.h"
#include "preview/frame/ground_truth.h"
#include "preview/frame/projection.h"
#include "preview/frame/read_back.h"
#include "preview/frame/texel_areas.h"
#include "preview/model/device_impl.h"
#include "preview/renderer.h"
#include "world/camera.h"

namespace panwright::preview {

// Resets an image to the camera's size. Radiance and coverage keep their old values; the rest is
// background.
void reset(image::Image& image, const world::Camera& camera, bool ground_truth);

// Enlarges a framebuffer that images of several shapes share, or keeps it. Fails: E5003.
bool ensure_target(const GladGLContext& gl, RenderTarget& target, std::span<const GLenum> formats,
                   std::uint32_t width, std::uint32_t height, DiagnosticLog& log);

// Reports why the context's pixels did not come. Returns false.
bool report_failure(Device::Impl& device, ReadBack::Wait why, DiagnosticLog& log);

// Frame under way, or a finished one, whose memory is reused.
struct FrameUnderWay {
  image::Image image;
  world::Camera camera;
  bool flat = false;
  std::vector<GroundTruthTarget> targets;
  std::size_t tiles = 0;  // submitted and not taken
  SamplingReport report;
  const char* why_empty = nullptr;  // of W5006
  std::vector<std::string> thin;    // names of targets that samples may miss
  // If levels of detail fade: the weight of `image`, and the weighted sum of the others.
  double weight = 1;
  std::vector<float> other_radiance, other_coverage;
  double psf_sigma = 0;
  std::vector<ImposterPatch> patches;  // of imposters

  // Adds what imposters show to the pixels. Expects: no tile is under way.
  void finish();
  // Adds the finished image to the sum of the others.
  void add_to_others(double share);
  // Finishes and takes the image. Reports: W5006.
  image::Image take(DiagnosticLog& log);
};

// Kind of the pixels of a tile.
enum class TileKind { radiance, ids };

// Ring of frames, and one of the tiles of each kind. Tiles are taken in the order in which they
// were submitted, by whoever needs their place or their frame.
class FramesInFlight {
 public:
  static constexpr std::size_t kMost = Renderer::kMostInFlight;

  // Cost: nothing. The context is current whenever something is drawn or freed.
  explicit FramesInFlight(Device::Impl& device);
  FramesInFlight(const FramesInFlight&) = delete;
  FramesInFlight& operator=(const FramesInFlight&) = delete;

  std::size_t size() const { return used_; }
  // The frame after those under way; its image has used memory, if any. Expects: size() < kMost.
  FrameUnderWay& next();
  void add_next() { ++used_; }
  FrameUnderWay& oldest() { return frames_[first_]; }  // Expects: size() > 0
  void remove_oldest();

  // Returns the framebuffer of the next tile; waits for the oldest one if all are used. Null:
  // fails, E0001, E5001, E5003.
  RenderTarget* target(TileKind kind, std::uint32_t width, std::uint32_t height, DiagnosticLog& log,
                       const Job& job);
  // Submits the tile drawn into target(): a part of `whole`, the rest of which is background.
  // Fails: E0001, E5001, E5003.
  bool submit(TileKind kind, FrameUnderWay& frame, const Tile& whole, const Tile& tile,
              DiagnosticLog& log);
  // Waits for all tiles of a frame, and those before them. Fails: E0001, E5001, E5003.
  bool take_all(const FrameUnderWay& frame, DiagnosticLog& log, const Job& job);

  void abandon(FrameUnderWay& frame);  // forgets the tiles of the newest frame
  void drop();                         // forgets all frames
  void recycle(image::Image image);    // memory for a later frame

 private:
  struct TileUnderWay {
    FrameUnderWay* frame = nullptr;
    Tile whole;
    Tile tile;
  };
  // Ring of one kind, with the tile of each slot.
  struct Ring {
    ReadBack pixels;
    std::array<TileUnderWay, ReadBack::kSlots> tiles;
  };
  Ring& ring(TileKind kind) { return kind == TileKind::radiance ? radiance_ : ids_; }
  bool take_tile(TileKind kind, DiagnosticLog& log, const Job& job);
  static void use_tile(TileKind kind, const TileUnderWay& tile, const void* pixels);

  Device::Impl& device_;
  Ring radiance_;
  Ring ids_;
  std::array<FrameUnderWay, kMost> frames_;
  std::size_t first_ = 0;
  std::size_t used_ = 0;
  std::vector<image::Image> spare_;  // at most kMost
};

}  // namespace panwright::preview
