// Terrain in images that another engine has drawn of its targets. No OpenGL.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "image/image.h"
#include "light/ground_shine.h"
#include "materials/material.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::preview {

struct GroundOptions {
  std::uint32_t samples = 2;  // N x N rays a pixel, each with one to the Sun
  bool sun_disc = true;       // false: a point at infinity, no penumbra
  double psf_sigma = 0;       // pixels, of a Gaussian; 0: none
  bool flat = false;          // shade by the triangles' own normals
  bool truth = true;          // ground truth layers become those of both; else they stay
};

// Returns whether a target, or one of a world, has terrain.
bool has_ground(const world::Instance& target);
bool has_ground(const world::World& world);

// Material of terrain: Hapke's law with the parameters of the Moon at 643 nm
// (docs/terrain-images.md).
materials::Material lunar_regolith();

// Terrain by rays, lit by the Sun, lamps and bodies, with the shadows of terrain and targets on it.
// Its shadow and its light on targets.
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
  // each pixel; pixels without have the largest around them. Coverage becomes that of both.
  //
  // Expects: ground truth layers. Lets Cancelled pass. The same bits for any number of threads.
  // Cost: N² rays and as many to the Sun a pixel, a microsecond each.
  void add(const world::World& world, const world::Camera& camera, const GroundOptions& options,
           image::Image& image, const Job& job = {});
  // Reports damaged tiles that were left out: W9615.
  void report_damaged(DiagnosticLog& log) const;
  // Shares of the Sun that terrain leaves to targets, of each pixel of their image: of the surface
  // at its middle; of pixels without, the mean of those beside it, or that of the middle of a
  // target. Empty: they have all of it.
  //
  // Expects: ground truth layers, of targets alone or with terrain. Lets Cancelled pass. Cost: 9
  // rays a pixel of targets, 73 in penumbrae; none where terrain cannot reach their light.
  std::vector<float> sun_shares(const world::World& world, const world::Camera& camera,
                                bool sun_disc, const image::Image& image, const Job& job = {});
  // The Sun's light that terrain sends to each target of a world, for RenderOptions::ground_shine;
  // null: there is no terrain. Kept until anything but the camera changes.
  //
  // Lets Cancelled pass. The same bits for any number of threads, but for stamps. Cost: for each
  // target 4,096 rays, and as many to the Sun at most.
  std::shared_ptr<const std::vector<light::GroundShine>> shine(const world::World& world,
                                                               const Job& job = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Shades an image of targets: rest is the same without the Sun (RenderOptions::sunlight).
void shade(std::span<const float> shares, const image::Image& rest, image::Image& image);

}  // namespace panwright::preview
