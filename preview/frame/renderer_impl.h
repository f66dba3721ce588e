// State of a renderer. Private to preview.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "preview/device.h"
#include "preview/frame/ground_truth.h"
#include "preview/frame/imposters.h"
#include "preview/frame/level_states.h"
#include "preview/frame/lights.h"
#include "preview/frame/outline.h"
#include "preview/frame/passes.h"
#include "preview/frame/read_back.h"
#include "preview/frame/samples.h"
#include "preview/frame/sampling.h"
#include "preview/frame/texel_areas.h"
#include "preview/renderer.h"

namespace panwright::preview {

// Resets an image to the camera's size. Radiance and coverage keep their old values; the rest is
// background.
void reset(image::Image& image, const world::Camera& camera, bool ground_truth);

struct Renderer::Impl {
  explicit Impl(std::shared_ptr<Device> device_in)
      : device(std::move(device_in)), shared(device->impl()), gl(shared.context->gl()) {
    spare.reserve(kMostInFlight);
  }
  ~Impl() { shared.context->make_current(); }  // the members delete their objects

  // View under way, or a finished one, whose memory is reused.
  struct Frame {
    image::Image image;
    world::Camera camera;
    bool flat = false;
    std::vector<GroundTruthTarget> targets;
    std::size_t tiles = 0;  // submitted and not collected
    SamplingReport report;
    const char* why_empty = nullptr;  // of W5006
    std::vector<std::string> thin;    // names of targets that samples may miss
    // If levels of detail fade: the weight of `image`, and the weighted sum of the others.
    double weight = 1;
    std::vector<float> other_radiance, other_coverage;
    double psf_sigma = 0;
    std::vector<ImposterPatch> patches;  // of imposters
  };
  // Part of an image under way.
  struct TileUnderWay {
    std::size_t frame = 0;
    Tile whole;  // the rest of it is background
    Tile tile;
  };
  // Ring of one kind, with the tile of each slot.
  struct Ring {
    Ring(const GladGLContext& gl, const PixelFormat& format, bool through_buffers)
        : pixels(gl, format, through_buffers) {}
    ReadBack pixels;
    std::array<TileUnderWay, ReadBack::kSlots> tiles;
  };

  void set_state() const;
  bool ensure_target(RenderTarget& target, std::span<const GLenum> formats, bool depth,
                     std::uint32_t width, std::uint32_t height, DiagnosticLog& log);
  bool fits(const world::World& world, const world::Camera& camera, const RenderOptions& options,
            DiagnosticLog& log) const;
  void make_passes();
  bool update(const world::World& world, const world::Camera& camera, const RenderOptions& options,
              DiagnosticLog& log);
  const VisibleSet* look(const world::World& world, const world::Camera& camera,
                         const LevelState& levels, VisibleSetFinder& finder, DiagnosticLog& log);
  bool submit(const world::World& world, const world::Camera& camera, const RenderOptions& options,
              DiagnosticLog& log);
  bool submit_state(const world::World& world, const world::Camera& camera,
                    const RenderOptions& options, const LevelState& levels, DiagnosticLog& log);
  bool draw_imposters(const world::World& world, const world::Camera& camera,
                      const RenderOptions& options, const LevelState& levels,
                      std::span<Imposter> imposters, std::size_t frame, DiagnosticLog& log);
  bool draw_to_error(const world::World& world, const world::Camera& camera, RenderOptions& options,
                     const LevelState& levels, Imposter& imposter, std::uint32_t most_side,
                     std::size_t frame, double& flux_error, DiagnosticLog& log);
  bool draw_texels(const world::World& world, const RenderOptions& options,
                   const LevelState& levels, const Imposter& imposter, std::size_t frame,
                   DiagnosticLog& log);
  std::uint32_t most_texels() const;
  static void finish(Frame& frame);
  bool take_all(std::size_t frame, DiagnosticLog& log);
  bool submit_radiance(FrameScene scene, const RenderOptions& options, std::size_t frame,
                       DiagnosticLog& log);
  bool sampled(const FrameScene& scene, const RenderOptions& options,
               std::span<const GLenum> formats, std::size_t frame, DiagnosticLog& log);
  bool submit_truth(const FrameScene& scene, const RenderOptions& options, std::size_t frame,
                    DiagnosticLog& log);
  bool make_room(Ring& ring, DiagnosticLog& log);
  bool submit_tile(Ring& ring, const TileUnderWay& tile, DiagnosticLog& log);
  bool take_tile(Ring& ring, DiagnosticLog& log);
  void use_tile(const Ring& ring, const TileUnderWay& tile, const void* pixels);
  bool is_cancelled(DiagnosticLog& log) const;  // reports E0001 then
  bool fail(ReadBack::Wait why, DiagnosticLog& log);
  const char* why_empty(const world::World& world, const VisibleSet& visible) const;
  void abandon(std::size_t frame);
  void drop();

  std::shared_ptr<Device> device;
  Device::Impl& shared;
  const GladGLContext& gl;
  TargetStates states;
  Lights lights;
  std::unique_ptr<Passes> passes;      // made when the context is first current
  std::unique_ptr<Sampling> sampling;  // the same
  std::optional<Ring> radiance;        // the same
  std::optional<Ring> ids;             // triangles
  RenderTarget g_buffer;               // layers as of Layer
  RenderTarget color_target;           // radiance of samples, if pixels have several
  RenderTarget bare_target;            // of seconds_of_bare_draw
  // one more than are under way, for partial images
  static constexpr std::size_t kFrames = kMostInFlight + 1;
  std::array<Frame, kFrames> frames;
  std::size_t first_frame = 0;
  std::size_t used_frames = 0;
  std::vector<image::Image> spare;  // at most the number of frames
  SamplingReport report;            // of the image collected last
  Job job;                          // of the call under way
  // of one frame, kept for the next one
  std::vector<TargetShape> shapes;
  std::vector<LeveledTarget> leveled;
  LevelStateFinder level_states;
  std::span<const LevelState> level_choices;      // of level_states
  std::vector<float> sum_radiance, sum_coverage;  // of partial images
  VisibleSetFinder visible_sets;
  ImposterFinder imposter_finder;
  Outline outline;
  double relief = 0;                 // of the last draw_texels(): of shadows, relative to the flux
  image::Image other_texels;         // of targets without imposters
  VisibleSetFinder drawn_sets;       // of partial draws, without some targets
  std::vector<std::uint8_t> hidden;  // of the world's targets: 1 to leave out
  TileScene on_tile;
};

}  // namespace panwright::preview
