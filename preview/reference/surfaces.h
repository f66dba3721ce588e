// Surfaces of a world with their materials, for instruments that bring their own light. No OpenGL.
//
// Materials, maps and decals are those of the reference renderer: in double, at full resolution.
// So is terrain, with its finest triangles.
#pragma once

#include <array>
#include <memory>

#include "base/job.h"
#include "base/math.h"
#include "trace/scene.h"
#include "world/world.h"

namespace panwright::preview {

// Mirror of a surface: the direction in which it shows the world to a viewer.
struct SurfaceMirror {
  Vec3 direction{0};    // unit, frame of the target's model
  Vec3 reflectance{0};  // RGB, of radiance
};

// Surface at a hit, as a viewer at the origin of the ray sees it. Frame: the target's model.
struct ViewedSurface {
  Vec3 start{0};      // metres: origin of further rays, past the chord error of the mesh
  Vec3 normal{0};     // as shaded, unit, on the visible side; 0: none
  double cosine = 0;  // of the viewer, to that normal
  // f·cos for light from the viewer, 1/sr, RGB, at zero phase; without mirrors.
  Vec3 returned{0};
  std::array<SurfaceMirror, 2> mirrors;
  int mirror_count = 0;
};

// Copies are cheap: they share models and placements, and may be updated apart.
class SurfaceScene {
 public:
  SurfaceScene();
  ~SurfaceScene();
  SurfaceScene(const SurfaceScene& other);
  SurfaceScene& operator=(const SurfaceScene& other);

  // Builds what is missing, by stamps. Throws Cancelled. Cost: as trace::Scene.
  void update(const world::World& world, const Job& job = {});
  // Sets the frame of rays; after update().
  void place_observer(const world::Pose& world_from_observer);

  const trace::Scene& rays() const;

  // Expects, all of these: a hit of these rays.

  // Returns the light at zero phase alone, without start and normal. Of plain materials without
  // narrow lobes from tables, to a relative 1e-4: some 30 ns, and else as viewed().
  ViewedSurface returned(const trace::Hit& hit) const;
  // Light at zero phase of one band, as returned() has it.
  struct BandLight {
    double cosine = 0, returned = 0;
  };
  // The same for one band, faster; false: not from tables, which returned() answers.
  bool returned_from_table(const trace::Hit& hit, int band, BandLight& out) const;
  // Cost: an evaluation of the BRDF.
  ViewedSurface viewed(const trace::Hit& hit) const;
  // Returns f·cos of light from a direction towards the viewer of a hit, 1/sr, RGB; 0 below the
  // horizon.
  //
  //   to_light  unit, frame of the target's model
  //   start     set: as ViewedSurface::start
  Vec3 lit(const trace::Hit& hit, const Vec3& to_light, Vec3& start) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::preview
