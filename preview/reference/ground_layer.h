// Terrain in images that another engine has drawn of its targets. No OpenGL.
#pragma once

#include <cstdint>
#include <memory>

#include "base/diagnostic.h"
#include "base/job.h"
#include "image/image.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::preview {

struct GroundOptions {
  std::uint32_t samples = 2;  // N x N rays a pixel, each with one to the Sun
  bool sun_disc = true;       // false: a point at infinity, no penumbra
  double psf_sigma = 0;       // pixels, of a Gaussian; 0: none
  bool flat = false;          // shade by the triangles' own normals
};

// Returns whether a target, or one of a world, has terrain.
bool has_ground(const world::Instance& target);
bool has_ground(const world::World& world);

// Terrain by rays, lit by the Sun, lamps and bodies, with the shadows of terrain and targets on it.
// It throws no light on targets, and no shadow.
//
// Levels of detail are within half a pixel (terrain::Ground::levels()); those of an orthographic
// camera the finest.
class GroundLayer {
 public:
  GroundLayer();
  GroundLayer(GroundLayer&&) noexcept;
  GroundLayer& operator=(GroundLayer&&) noexcept;
  ~GroundLayer();

  // Adds the terrain of a world to an image of its targets, before and behind them by the depth of
  // each pixel; pixels without have the largest around them. Coverage and the ground truth become
  // those of both.
  //
  // Expects: ground truth layers. Lets Cancelled pass. The same bits for any number of threads.
  // Cost: N² rays and as many to the Sun a pixel, a microsecond each.
  void add(const world::World& world, const world::Camera& camera, const GroundOptions& options,
           image::Image& image, const Job& job = {});
  // Returns the first target without terrain whose middle is in its shadow, after add(); none: -1.
  std::ptrdiff_t shaded_target(const world::World& world) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::preview
