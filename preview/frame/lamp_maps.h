// Shadow maps of lamps. Private to preview.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "preview/frame/caster_draws.h"
#include "preview/frame/frame_scene.h"
#include "preview/frame/projection.h"
#include "world/camera.h"

namespace panwright::preview {

// A map to be drawn: a square view of a target from a lamp.
struct LampMap {
  world::Camera camera;      // set but for its size and focal length
  double extent = 1;         // half the width: tangent, or metres of an orthographic one
  double nearest = 0;        // metres; surfaces nearer to the lamp cast no shadow
  std::uint32_t target = 0;  // of the world
  // results
  DepthRange range;
  std::uint32_t layer = 0;
};

// Returns the map of a target from a light at infinity.
//
//   centre, radius  a sphere around it
LampMap parallel_map(const Vec3& centre, double radius, const Vec3& to_light, std::uint32_t target);
// Returns an attitude, world_from_camera, of that axis.
Quat looking_along(const Vec3& z);

// Layers of depths and slopes, as those of the Sun (shadow.h) but for the projection. Each holds
// the shadows of one lamp on one target, from all targets. Insides of closed meshes stop light.
// Where there are many maps, all of a target is one mesh, whose large parts are simplified within
// a quarter of a texel (model/caster_meshes.h).
class LampMaps {
 public:
  // Draws what is missing. A layer is kept while lamp, receiver and casters stay.
  //
  //   side   texels, at most; halved until all fit `bytes`
  // Reports, fails: as ShadowMaps::update().
  bool update(Device::Impl& device, const FrameScene& scene, std::vector<LampMap>& maps,
              unsigned side, std::uint64_t bytes, DiagnosticLog& log, const Job& job);

  unsigned side() const { return side_; }  // texels of a map
  const MapLayers& layers() const { return layers_; }
  std::uint64_t drawn() const { return drawn_; }
  void forget();

  static constexpr std::size_t kMost = 1024;

 private:
  struct Key {
    std::vector<double> numbers;        // of camera and range
    std::vector<std::uint64_t> stamps;  // of receiver and casters, and whether these are simplified
    bool operator==(const Key&) const = default;
  };
  struct Slot {
    Key key;
    std::uint64_t last_use = 0;
  };
  void place(const FrameScene& scene, LampMap& map);
  Key key_of(const FrameScene& scene, const LampMap& map) const;
  void add_draws(const GladGLContext& gl, const FrameScene& scene, const LampMap& map);

  MapLayers layers_;
  unsigned side_ = 0;
  std::vector<Slot> slots_;  // of the layers
  std::uint64_t update_ = 0;
  std::uint64_t drawn_ = 0;
  CasterDraws draws_;
  CasterMeshes meshes_;
  bool simplified_ = false;             // those of this update
  std::vector<std::uint32_t> casters_;  // of one map
  std::vector<std::uint32_t> touched_;  // items of one caster
};

}  // namespace panwright::preview
