// World → image by path tracing on the CPU: what the preview is measured against. No OpenGL.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/math.h"
#include "base/result.h"
#include "preview/image.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::preview {

struct ReferenceOptions {
  // Points for each pixel, spent on the part of it where a target may be; 8 or more. They come in
  // 32 independent batches, or one per point if those are fewer, on jittered grids.
  std::uint32_t samples = 64;
  // Relative standard error of the total flux, in its worst channel, that further batches are added
  // for; 0: none are.
  double until_error = 0;
  std::uint32_t max_samples = 1u << 26;  // for each pixel, with until_error
  std::uint64_t seed = 0;

  // Interreflections; 0: light that comes straight from the Sun, as the preview shows.
  std::uint32_t bounces = 3;
  bool sun_disc = true;  // false: a point at infinity, no penumbra
  double psf_sigma = 0;  // pixels: the image is blurred by this Gaussian before pixels average it
  bool flat = false;     // shade by the triangles' own normals
  bool ground_truth = false;              // also the ground truth layers of the image
  std::uint64_t max_bytes = 12ull << 30;  // of the image and its sums in memory
};

// One view with what is known about its error. H = height, W = width of the image.
struct ReferenceImage {
  Image image;
  // 3*H*W one standard error of the radiance, in its unit: what the pixel's samples and those
  // around it tell, so that 99 % of pixels with light lie within three of them, also with few
  // samples (docs/accuracy/reference-renderer.md). Larger than the true error on the average, at
  // most by half; for sums over pixels take flux_error.
  std::vector<float> standard_error;

  // Sum of radiance × solid angle of the pixel, the irradiance at a perspective camera; × area,
  // the radiant intensity, for an orthographic one.
  Vec3 flux{0};
  // One standard error, from independent images. Widened for the few that it is found from, so that
  // true errors divided by it have an RMS of 1.
  Vec3 flux_error{0};

  std::uint32_t batches = 0;
  std::uint64_t samples = 0;      // of the whole image
  std::uint64_t camera_rays = 0;  // rays that left the camera and came near a target
  std::uint64_t shadow_rays = 0;
  std::uint64_t bounce_rays = 0;
  double seconds = 0;  // without what was built first
};

// What a reference has built since it was made.
struct ReferenceWork {
  std::uint64_t models = 0;  // search trees of all meshes of a model, its materials and tangents
  std::uint64_t shapes = 0;  // placements of a target's meshes and the tree over them
  std::uint64_t poses = 0;   // a target's place in the world
};

// A path tracer of worlds, without a model of its own.
//
// Always what was authored: materials in double, textures at full resolution (bilinear), the
// finest meshes; the rays' geometry in double, each target in its own frame, so that the camera and
// the targets may stand anywhere from inside one another to 1e8 m away. Light comes from the Sun's
// disc, whole, whose irradiance on a plane that faces it is that of the world, from what emits, and
// by `bounces` interreflections; targets shadow and light each other. A point is lit where its
// shading normal faces the Sun and a ray to it, started past the chord error of the mesh towards
// the smooth surface, is free (docs/conventions-models.md 13). Sides, maps, decals and ground
// truth layers as in renderer.h, but that holes are always sharp.
//
// It shares the formulas of materials/, the reader of pan files and the ray caster with the
// preview, and nothing else: placement, textures, decals, tangents, view rays and truth are its
// own, so that each finds the other's mistakes.
//
// What it builds is kept, keyed by the model and by stamps: a model's meshes while anybody else
// holds the model, a target's placements and pose while they stand in the world of the last call.
// The image does not depend on what was kept. Same world, camera and options: the same bits,
// whatever the number of threads.
class Reference {
 public:
  Reference();
  Reference(Reference&&) noexcept;
  Reference& operator=(Reference&&) noexcept;
  ~Reference();

  // Builds what render() of this world needs and does not have; render() does so by itself.
  // Cost: O(T log T) for new models; O(parts) for targets whose nodes changed.
  void prepare(const world::World& world, const Job& job = {});

  // target_id of the image is the index in the world + 1; node_id and material_id are those of the
  // target's model. Not to be called from two threads at once.
  //
  // Expects: options as documented; a camera of 1 pixel or more, finite and with a unit rotation;
  // models that are owned by those who point to them.
  // Reports: W5006 when every pixel stays empty, W5008 when until_error was not reached.
  // Fails: E0001; E5003 over max_bytes.
  // Cost: O(samples · (bounces + 1)) rays; pixels that no target can reach cost nothing. Memory,
  // for each model about 200 bytes a triangle.
  Result<ReferenceImage> render(const world::World& world, const world::Camera& camera,
                                const ReferenceOptions& options, DiagnosticLog& log,
                                const Job& job = {});

  const ReferenceWork& work() const;

 private:
  Result<ReferenceImage> rendered(const world::World& world, const world::Camera& camera,
                                  const ReferenceOptions& options, DiagnosticLog& log,
                                  const Job& job);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::preview
