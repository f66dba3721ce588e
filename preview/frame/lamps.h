// Lights after the Sun on the targets of a view. Private to preview.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "light/light.h"
#include "preview/frame/block_stream.h"
#include "preview/frame/frame_scene.h"
#include "preview/frame/lamp_maps.h"
#include "preview/frame/sun_points.h"
#include "preview/gl/uniforms.h"
#include "preview/renderer.h"

namespace panwright::preview {

// One pass of shading adds them all, up to kMostLamps on a target: of more the brightest there.
// Lamps with less than a thousandth of all lamps' light on a target, or a millionth of the Sun's,
// cast no shadows there. Nor does one at the camera, which sees no shadow of it.
class Lamps {
 public:
  // Begins another image: the lamps that are on, in world axes (world/lamps.h).
  void begin_image(std::vector<light::Source> sources) { sources_ = std::move(sources); }

  // Chooses the lights of each receiver of a scene.
  //
  //   softness  points of the Sun's disc, and whether time limits them: as many of a lamp's
  void begin_scene(const FrameScene& scene, const SunDisc& softness);
  bool any() const { return any_; }
  // True if none of them has a size.
  bool points() const { return points_; }

  // Draws the missing maps and uploads the blocks. Adds to a report.
  //
  //   model_from_sample  of the receivers (light_view.h)
  //   side               of maps, texels, at most; 0: no shadows
  // Reports, fails: as ShadowMaps::update().
  bool update(Device::Impl& device, const FrameScene& scene, const std::vector<Mat4>& samples,
              unsigned side, std::uint64_t bytes, SamplingReport& report, DiagnosticLog& log,
              const Job& job);

  bool lights(std::size_t receiver) const { return !receivers_[receiver].lamps.empty(); }
  // Expects: lights() of the receiver.
  void bind(const GladGLContext& gl, std::size_t receiver) const;

  void forget() { maps_.forget(); }
  std::uint64_t maps_drawn() const { return maps_.drawn(); }

 private:
  // Light on one receiver.
  struct Lamp {
    light::Source source;
    double irradiance = 0;     // at most, the strongest band
    std::uint32_t map = 0;     // first of its maps
    std::uint32_t maps = 0;    // of a point: none, 1, or 6
    std::uint32_t points = 1;  // of its disc
  };
  struct Receiver {
    std::vector<Lamp> lamps;
    std::uint32_t first_map = 0;  // into wanted_
    std::uint32_t maps = 0;       // in its block
  };
  void find_maps(const FrameScene& scene, std::size_t receiver, SamplingReport& report);
  unsigned points_of(const light::Source& source, const FrameScene& scene, std::size_t receiver,
                     double& penumbra) const;
  void fill(const FrameScene& scene, std::size_t receiver, const Mat4& model_from_sample,
            LampsBlock& block) const;

  std::vector<light::Source> sources_;
  bool any_ = false;
  bool points_ = true;
  unsigned left_out_ = 0;
  SunDisc softness_;
  std::vector<Receiver> receivers_;
  std::vector<LampMap> wanted_;  // of all receivers; extent 0: a face that nothing is in
  LampMaps maps_;
  BlockStream<LampsBlock> blocks_;
};

}  // namespace panwright::preview
