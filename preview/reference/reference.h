// Reference renderer: world → image by path tracing on the CPU, to validate the preview. No OpenGL.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/math.h"
#include "base/result.h"
#include "image/image.h"
#include "light/surfels.h"
#include "trace/scene.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::preview {

struct ReferenceOptions {
  // Points for each pixel, spent on the part of it with possible targets; 8 or more. They come in
  // 32 independent batches, or one per point if those are fewer, on jittered grids.
  std::uint32_t samples = 64;
  // Target of the relative standard error of the total flux, in its worst channel, for further
  // batches; 0: none.
  double until_error = 0;
  std::uint32_t max_samples = 1u << 26;  // for each pixel, with until_error
  std::uint64_t seed = 0;

  // Interreflections; 0: only direct sunlight, as in the preview.
  std::uint32_t bounces = 3;
  bool sun_disc = true;  // false: a point at infinity, no penumbra
  double psf_sigma =
      0;              // pixels: the image is convolved with this Gaussian before pixels average it
  bool flat = false;  // shade by the triangles' own normals
  bool ground_truth = false;              // also the ground truth layers of the image
  std::uint64_t max_bytes = 12ull << 30;  // of the image and its sums in memory
};

struct MirrorOptions {
  bool flat = false;     // shade by the triangles' own normals
  double psf_sigma = 0;  // pixels, of a Gaussian; 0: none
  // Light that other surfaces send each target; empty: none.
  std::span<const light::SurfelLight> indirect;
};

// View with its error estimates. H = height, W = width of the image.
struct ReferenceImage {
  image::Image image;
  // 3*H*W one standard error of the radiance, in its unit, from the pixel's samples and those
  // around it. 99 % of pixels with light lie within three of them, also with few samples
  // (docs/reference-renderer.md). Larger than the true error on average, at most by half; for sums
  // over pixels take flux_error.
  std::vector<float> standard_error;

  // Of targets, without bodies: sum of radiance × solid angle of the pixel, the irradiance at a
  // perspective camera; × area,
  // the radiant intensity, for an orthographic one.
  Vec3 flux{0};
  // One standard error, from independent images. Widened for their small number, so that true
  // errors divided by it have an RMS of 1.
  Vec3 flux_error{0};

  std::uint32_t batches = 0;
  std::uint64_t samples = 0;      // of the whole image
  std::uint64_t camera_rays = 0;  // rays from the camera that came near a target
  std::uint64_t shadow_rays = 0;
  std::uint64_t bounce_rays = 0;
  double seconds = 0;  // without preparation
};

// Returns whether a target of a world has mirrors or smooth coats.
bool has_mirrors(const world::World& world);

// Path tracer of worlds.
//
// Bodies of the sky light targets, with all BRDFs and at every bounce. They eclipse the Sun by the
// place on its disc, hide targets beyond them and stand behind others.
//
// Always as authored: materials in double, textures at full resolution (bilinear), the finest
// meshes. The rays' geometry is in double, each target in its own frame. Camera and targets may be
// from inside one another to 1e8 m apart. Light comes from the whole disc of the Sun, with the
// world's irradiance on a plane that faces it, and from emission. Places on lamps give theirs.
// `bounces` interreflections follow; targets shadow and light each other. A point is lit if its
// shading normal faces the Sun and a ray to it is free; the ray starts past the chord error of the
// mesh towards the smooth surface (docs/conventions.md 14). Sides, maps, decals and ground truth
// layers as in renderer.h, except that holes are always sharp.
//
// It shares the formulas of materials/ and the reader of pan files with the preview, and nothing
// else: rays, placement and textures are those of trace/, and decals, tangents, view rays and truth
// its own, so that each finds the other's mistakes.
//
// Its structures are cached by model and stamps: a model's meshes while another owner holds the
// model, a target's placements and pose while they are in the world of the last call. The image
// does not depend on the cache. Same world, camera and options: the same bits, whatever the number
// of threads.
class Reference {
 public:
  Reference();
  Reference(Reference&&) noexcept;
  Reference& operator=(Reference&&) noexcept;
  ~Reference();

  // Builds missing structures for render() of this world; render() does so itself. Cost: O(T log T)
  // for new models; O(parts) for targets whose nodes changed.
  void prepare(const world::World& world, const Job& job = {});

  // target_id of the image is the index in the world + 1; node_id and material_id are those of the
  // target's model. Not thread-safe.
  //
  // Expects: options as documented; a camera of 1 pixel or more, finite and with a unit rotation;
  // models kept alive by their pointers.
  // Reports: W5006 when every pixel stays empty, W5008 when until_error was not reached, W9615.
  // Fails: E0001; E5003 over max_bytes. Cost: O(samples · (bounces + 1)) rays; pixels without
  // targets cost nothing. Memory, for each model about 200 bytes a triangle.
  Result<ReferenceImage> render(const world::World& world, const world::Camera& camera,
                                const ReferenceOptions& options, DiagnosticLog& log,
                                const Job& job = {});

  // Sets the ground truth layers of an image of the camera's size, as render() does.
  //
  // Expects, fails: as render(), without a limit of memory. Cost: a ray a pixel.
  bool add_ground_truth(const world::World& world, const world::Camera& camera, bool flat,
                        image::Image& image, DiagnosticLog& log, const Job& job = {});

  // Adds what mirrors and smooth coats show of targets, terrain and bodies to an image that another
  // engine has drawn without (RenderOptions::mirrors_apart); the Sun, lamps and stars are its own.
  // What they show has the Sun's light, that of lamps and bodies, and its own mirrors, up to eight
  // one after the other. Pixels have a sample, and sixteen where they differ by a hundredth of
  // white from one beside them. The same bits for any number of threads.
  //
  // Fails: E0001. Cost: a ray and one from there a pixel under the outlines of such parts.
  bool add_mirrored(const world::World& world, const world::Camera& camera,
                    const MirrorOptions& options, image::Image& image, DiagnosticLog& log,
                    const Job& job = {});

  // Returns whether targets hide points from a camera: 1, or 0.
  //
  //   beside  metres in front of each point where surfaces do not count, its own among them
  // Expects: as many as points; a perspective camera. Throws Cancelled. Cost: a ray a point.
  std::vector<std::uint8_t> hidden(const world::World& world, const world::Camera& camera,
                                   std::span<const Vec3> points, std::span<const double> beside,
                                   const Job& job = {});

  // Counts of acceleration structures built so far.
  const trace::Work& work() const;

 private:
  Result<ReferenceImage> rendered(const world::World& world, const world::Camera& camera,
                                  const ReferenceOptions& options, DiagnosticLog& log,
                                  const Job& job);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::preview
