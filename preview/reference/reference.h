// Pan → pixels by path tracing on the CPU: what the preview is measured against. No OpenGL.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/math.h"
#include "base/result.h"
#include "pan/model.h"
#include "preview/image.h"
#include "preview/view.h"

namespace panwright::preview {

struct ReferenceOptions {
  // Points for each pixel, spent on the part of it where the model may be; 8 or more. They come in
  // 32 independent rounds, or one for each point if those are fewer, on jittered grids.
  std::uint32_t samples = 64;
  // Relative standard error of the total flux, in its worst channel, that further rounds are added
  // for; 0: none are.
  double until_error = 0;
  std::uint32_t max_samples = 1u << 26;  // for each pixel, with until_error
  std::uint64_t seed = 0;

  // Interreflections; 0: light that comes straight from the Sun, as the preview shows.
  std::uint32_t bounces = 3;
  bool sun_disc = true;       // false: a point at infinity, no penumbra
  double limb_darkening = 0;  // u of I = 1 − u·(1 − μ), 0 to 1
  double psf_sigma = 0;  // pixels: the image is blurred by this Gaussian before pixels average it
  bool flat = false;     // shade by the triangles' own normals
  bool truth = false;    // also the truth layers of the image
  std::uint64_t max_bytes = 12ull << 30;  // of the image and its sums in memory
};

// One view with what is known about its error. H = height, W = width of the image.
struct ReferenceImage {
  Image image;
  // 3*H*W one standard error of the radiance, in its unit. Widened for the few rounds it is found
  // from, so that true errors divided by it have an RMS of 1.
  std::vector<float> standard_error;

  // Sum of radiance × solid angle of the pixel, the irradiance at a perspective camera; × area,
  // the radiant intensity, for an orthographic one.
  Vec3 flux{0};
  Vec3 flux_error{0};  // one standard error, widened likewise

  std::uint32_t rounds = 0;
  std::uint64_t samples = 0;      // of the whole image
  std::uint64_t camera_rays = 0;  // rays that left the camera and came near the model
  std::uint64_t shadow_rays = 0;
  std::uint64_t bounce_rays = 0;
  double seconds = 0;
};

// A model, ready to be traced from many views.
//
// Always what was authored: materials in double, textures at full resolution (bilinear), the
// finest meshes; the rays' geometry in double, so that the camera may stand anywhere from inside
// the model to 1e8 m away. Light comes from the Sun's disc, whole, whose irradiance on a plane that
// faces it is that of the view, from what emits, and by `bounces` interreflections. A point is lit
// where its shading normal faces the Sun and a ray to it, started past the chord error of the mesh
// towards the smooth surface, is free (docs/conventions.md 14). Sides, maps, decals and truth
// layers as in renderer.h, but that holes are always sharp.
//
// Same model, view and options: the same bits, whatever the number of threads.
class Reference {
 public:
  // Expects: model.checked(); it outlives the reference. Never fails for sound models.
  // Cost: about 400 bytes a triangle and 16 a texel.
  static Result<Reference> create(const pan::Model& model, DiagnosticLog& log);

  Reference(Reference&&) noexcept;
  Reference& operator=(Reference&&) noexcept;
  ~Reference();

  // Expects: options as documented; a camera of 1 pixel or more, finite and with unit rotations; a
  // Sun direction that is not 0, a Sun distance above 0.
  // Reports: W5006 when every pixel stays empty, W5008 when until_error was not reached.
  // Fails: E0001; E5003 over max_bytes.
  // Cost: O(samples · (bounces + 1)) rays; pixels that the model cannot reach cost nothing.
  Result<ReferenceImage> render(const View& view, const ReferenceOptions& options,
                                DiagnosticLog& log, const Job& job = {}) const;

 private:
  Result<ReferenceImage> rendered(const View& view, const ReferenceOptions& options,
                                  DiagnosticLog& log, const Job& job) const;
  struct Impl;
  explicit Reference(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::preview
