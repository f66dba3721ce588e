// Samplers of a scene: radiance and ids, tile by tile. Private to preview.
#pragma once

#include <span>

#include "base/diagnostic.h"
#include "base/job.h"
#include "preview/frame/frame_scene.h"
#include "preview/frame/frames_in_flight.h"
#include "preview/frame/lights.h"
#include "preview/frame/passes.h"
#include "preview/frame/sampling.h"
#include "preview/gl/gl_objects.h"
#include "preview/renderer.h"

namespace panwright::preview {

// Samplers share the passes, the lights and the framebuffers of samples. Nothing of a scene is kept
// between calls but what is derived from it, as shadow maps.
class Samplers {
 public:
  // Expects: a current context, also for each call.
  explicit Samplers(Device::Impl& device);
  Samplers(const Samplers&) = delete;
  Samplers& operator=(const Samplers&) = delete;

  // Begins another image, of one or several scenes.
  void begin_image(const world::World& world, const world::Camera& camera,
                   const RenderOptions& options);

  // Each submits the tiles of a frame's image, reset() to the scene's camera. After a failure tiles
  // may be under way.
  // Reports: W5012. Fails: E0001, E5001, E5003.
  bool radiance(FrameScene scene, const RenderOptions& options, FramesInFlight& frames,
                FrameUnderWay& frame, DiagnosticLog& log, const Job& job);
  bool truth(const FrameScene& scene, const RenderOptions& options, FramesInFlight& frames,
             FrameUnderWay& frame, DiagnosticLog& log, const Job& job);

  // Renderer::seconds_of_bare_draw().
  double seconds_of_bare_draw(const FrameScene& scene, DiagnosticLog& log);

  const Lights& lights() const { return lights_; }

 private:
  // Resolution of the tiles of an image.
  struct TileSize {
    std::uint32_t side = 0, width = 0, height = 0;  // pixels
  };
  TileSize tile_size(const RenderOptions& options, unsigned samples,
                     const image::Image& image) const;
  bool in_full(const FrameScene& scene, const RenderOptions& options, Pass pass,
               const TileSize& size, FramesInFlight& frames, FrameUnderWay& frame,
               DiagnosticLog& log, const Job& job);
  bool adaptive(const FrameScene& scene, const RenderOptions& options,
                std::span<const GLenum> formats, FrameUnderWay& frame, DiagnosticLog& log,
                const Job& job);

  Device::Impl& device_;
  const GladGLContext& gl_;
  Passes passes_;
  Lights lights_;
  RenderTarget g_buffer_;  // layers as of Layer
  RenderTarget color_;     // radiance of samples, if pixels have several
  RenderTarget bare_;      // of seconds_of_bare_draw()
  Sampling sampling_;
  TileScene on_tile_;
};

}  // namespace panwright::preview
