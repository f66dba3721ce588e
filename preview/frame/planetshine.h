// Light of planets and terrain on the targets of a view. Private to preview.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/stamp.h"
#include "preview/frame/block_stream.h"
#include "preview/frame/frame_scene.h"
#include "preview/frame/lamp_maps.h"
#include "preview/gl/gl_objects.h"
#include "preview/gl/uniforms.h"
#include "preview/renderer.h"
#include "sky/planetshine.h"
#include "sky/shine_table.h"

namespace panwright::preview {

// Parts of it, each a distant disc, light diffuse surfaces; lobes read a table of directions
// (sky/shine_table.h). Groups of parts have shadow maps. Shading adds it in the Sun's pass
// (shaders/planets.glsl). Targets so close that the light is the same have it once. Terrain sends
// each target its own.
class Planetshine {
 public:
  // Begins another image.
  void begin_image(const world::World& world, const RenderOptions& options);

  // Finds the light on each receiver of a scene.
  void begin_scene(const FrameScene& scene);
  bool any() const { return any_; }

  // Draws the missing maps and uploads what changed.
  //
  //   side, bytes  of maps, as of Lamps::update(); side 0: no shadows
  // Reports, fails: as ShadowMaps::update().
  bool update(Device::Impl& device, const FrameScene& scene, const std::vector<Mat4>& samples,
              unsigned side, std::uint64_t bytes, DiagnosticLog& log, const Job& job);

  // Expects: any(); update() of the same scene.
  void bind(const GladGLContext& gl, std::size_t receiver) const;

  void forget() { maps_.forget(); }
  std::uint64_t maps_drawn() const { return maps_.drawn(); }

 private:
  // Light at a place and near it.
  struct Light {
    Vec3 point;
    double reach = 0;  // metres
    std::vector<materials::Incidence> groups;
    std::vector<materials::Incidence> parts;  // those of a group together
    std::vector<std::size_t> ends;            // of each group's parts
    Stamp ground = 0;                         // light::GroundShine::stamp
    std::vector<light::ShineShadow> shadows;  // on the ground, those of a group together
    std::vector<std::size_t> shadow_ends;
    sky::ShineTable table;
    GlTexture texture;  // none: the table is yet to be uploaded
  };
  struct Receiver {
    std::size_t light = 0;  // in lights_
    std::size_t first_map = 0;
    std::size_t maps = 0;
  };
  // ground: null: none
  std::size_t light_at(const world::World& world, const Vec3& point,
                       const light::GroundShine* ground);
  static Light found(const sky::Sky& sky, const Vec3& point, const light::GroundShine* ground,
                     std::size_t groups);
  void upload(const GladGLContext& gl, Light& light);
  void fill(const FrameScene& scene, std::size_t receiver, const Mat4& model_from_sample,
            PlanetsBlock& block) const;

  std::size_t groups_ = 0;  // at most
  std::shared_ptr<const std::vector<light::GroundShine>> ground_;
  Stamp sky_stamp_ = 0;
  Stamp sun_stamp_ = 0;
  std::vector<Light> lights_;
  std::vector<GlTexture> spare_;  // textures of former lights
  bool any_ = false;
  std::vector<Receiver> receivers_;
  std::vector<LampMap> wanted_;
  LampMaps maps_;
  BlockStream<PlanetsBlock> blocks_;
};

}  // namespace panwright::preview
