// Sampler of imposters: targets drawn separately, finer than pixels. Private to preview.
#pragma once

#include <cstdint>
#include <span>

#include "base/diagnostic.h"
#include "base/job.h"
#include "image/image.h"
#include "preview/frame/frames_in_flight.h"
#include "preview/frame/imposters.h"
#include "preview/frame/samplers.h"
#include "preview/frame/scene_state.h"
#include "preview/renderer.h"

namespace panwright::preview {

// Draws imposters one after the other through the image of a frame, from the largest to the
// smallest. Each is drawn once more if its estimated error is too large.
class ImposterSampler {
 public:
  // Inputs and state of one image.
  struct Draw {
    const world::World& world;
    const world::Camera& camera;
    const RenderOptions& options;
    const LevelState& levels;
    SceneState& scene;
    Samplers& samplers;
    FramesInFlight& frames;
    FrameUnderWay& frame;
    DiagnosticLog& log;
    const Job& job;
  };

  // Finds imposters among SceneState::all(), adds their patches and reports to the frame, and hides
  // their targets. Returns true with *found = false if there are none.
  //
  //   most_side  texels that a side may have
  // Expects: nothing is hidden. Fails: E0001, E5001, E5003.
  bool draw_all(const Draw& draw, std::uint32_t most_side, bool& found);

 private:
  bool add_patch(const Draw& draw, std::size_t index, std::uint32_t most_side);
  bool draw_to_error(const Draw& draw, Imposter& imposter, std::uint32_t most_side,
                     double& flux_error);
  bool draw_texels(const Draw& draw, const Imposter& imposter);

  ImposterFinder finder_;
  std::span<Imposter> imposters_;  // of finder_
  RenderOptions options_;          // of texels
  double relief_ = 0;              // of the last draw_texels(): of shadows, relative to the flux
  image::Image other_texels_;      // of targets without imposters
};

}  // namespace panwright::preview
