// Lights of a view: what each gives the visible targets. Private to preview.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "preview/frame/light_view.h"
#include "preview/frame/shadow.h"
#include "preview/renderer.h"

namespace panwright::preview {

// The Sun, its shadow maps, and the blocks of its light. Shading adds one light after the other.
class Lights {
 public:
  // Begins another image, of one or several scenes.
  void begin_image(const world::Sun& sun, const RenderOptions& options);

  // Chooses the shadow maps of a scene; none: shadows() is false.
  void begin_scene(const FrameScene& scene, const RenderOptions& options);
  bool shadows() const { return limits_.side > 0; }

  // Draws the missing maps and uploads the views of a scene. Adds to a report.
  //
  // Expects: begin_scene() of the same scene, with targets in view.
  // Reports, fails: as ShadowMaps::update().
  bool update(Device::Impl& device, const FrameScene& scene, SamplingReport& report,
              DiagnosticLog& log, const Job& job);

  // Of the scene of the last update().
  std::size_t count() const { return 1; }
  const Mat4& model_from_sample(std::size_t receiver) const { return samples_[receiver]; }
  // Binds a light's block and map for shading a receiver.
  void bind(const GladGLContext& gl, std::size_t light, std::size_t receiver) const;

  const SunDisc& disc() const { return limits_.disc; }
  void forget() { maps_.forget(); }  // frees all maps: the next update redraws them
  std::uint64_t maps_drawn() const { return maps_.drawn(); }

 private:
  ShadowMaps maps_;
  ShadowMaps::Limits limits_{0, 0, 0, {}};
  std::vector<Mat4> samples_;        // of the receivers
  std::vector<LightView> views_;     // of the receivers, light by light
  std::vector<std::byte> uploaded_;  // blocks of these, in stream_
  std::vector<std::byte> blocks_;    // those of the next update()
  std::optional<StreamBuffer> stream_;
  std::size_t stride_ = 0;  // bytes, of blocks_
  std::size_t first_ = 0;   // bytes, in stream_
};

}  // namespace panwright::preview
