// Lights of a view: what each gives the visible targets. Private to preview.
#pragma once

#include <cstddef>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "preview/frame/block_stream.h"
#include "preview/frame/indirect.h"
#include "preview/frame/lamps.h"
#include "preview/frame/light_view.h"
#include "preview/frame/planetshine.h"
#include "preview/frame/shadow.h"
#include "preview/renderer.h"

namespace panwright::preview {

// The Sun, its shadow maps, and the blocks of its light; planets (planetshine.h) and other surfaces
// (indirect.h), which are shaded with it; and lamps (lamps.h), which another pass adds.
class Lights {
 public:
  // Begins another image, of one or several scenes.
  void begin_image(const world::World& world, const world::Camera& camera,
                   const RenderOptions& options);

  // Chooses the lights and shadow maps of a scene; none: shadows() is false.
  void begin_scene(const FrameScene& scene, const RenderOptions& options);
  bool shadows() const { return limits_.side > 0; }
  // True if samples need positions.
  bool placed() const { return shadows() || lamps_.any() || indirect_.any(); }
  bool planets() const { return planets_.any(); }
  bool indirect() const { return indirect_.any(); }
  // True if shadows of bodies have no straight edge on a receiver.
  bool eclipsed() const { return eclipsed_; }

  // Draws the missing maps and uploads the views of a scene. Adds to a report. Where nothing of the
  // Sun arrives, it has no maps.
  //
  // Expects: begin_scene() of the same scene, with targets in view.
  // Reports, fails: as ShadowMaps::update().
  bool update(Device::Impl& device, const FrameScene& scene, SamplingReport& report,
              DiagnosticLog& log, const Job& job);

  // Of the scene of the last update().
  bool points() const { return lamps_.points(); }  // of passes after the first
  std::size_t passes() const { return lamps_.any() ? 2 : 1; }
  const Mat4& model_from_sample(std::size_t receiver) const { return samples_[receiver]; }
  bool lights(std::size_t pass, std::size_t receiver) const {
    return pass == 0 || lamps_.lights(receiver);
  }
  // Binds blocks and maps of a pass for shading a receiver that it lights.
  void bind(const GladGLContext& gl, std::size_t pass, std::size_t receiver) const;

  const SunDisc& disc() const { return limits_.disc; }
  // The next update redraws all maps.
  void forget() {
    maps_.forget();
    lamps_.forget();
    planets_.forget();
  }
  std::uint64_t maps_drawn() const {
    return maps_.drawn() + lamps_.maps_drawn() + planets_.maps_drawn();
  }

 private:
  Lamps lamps_;
  Planetshine planets_;
  Indirect indirect_;
  bool eclipsed_ = false;
  bool sunlight_ = true;          // RenderOptions
  std::uint64_t lamp_bytes_ = 0;  // of their maps, at most
  ShadowMaps maps_;
  ShadowMaps::Limits limits_{0, 0, 0, {}};
  std::vector<Mat4> samples_;     // of the receivers
  std::vector<LightView> views_;  // of the receivers
  BlockStream<LightBlock> blocks_;
};

}  // namespace panwright::preview
