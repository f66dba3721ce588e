// Renderer: world → pixels.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "image/image.h"
#include "light/ground_shine.h"
#include "light/surfels.h"
#include "preview/device.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::preview {

// Relative error of what shows targets and no light of theirs.
inline constexpr double kNothingLit = 1;

// Imposter of an image: targets drawn separately.
struct ImposterReport {
  std::vector<std::uint32_t> targets;  // of the world
  double extent = 0;                   // of their bounding square, pixels
  std::uint32_t width = 0;             // texels
  std::uint32_t height = 0;            // texels
  double flux_error = 0;               // as estimated from the texels, relative; or kNothingLit
  double seconds = 0;                  // from the first draw to the last texel added
  double flux_asked = 0;               // for flux_error
};

// Sampling of an image.
struct SamplingReport {
  double samples = 0;  // points a pixel, the mean over the image
  // Remaining error, as estimated from the samples, or kNothingLit; 0 for a given N in every pixel.
  double rmse = 0;       // RMS over the target's pixels, relative to the RMS of their radiance
  double flux = 0;       // relative, of the sum of all pixels
  bool limited = false;  // RenderOptions::work ended sampling
  // Error of shadow edges, pixels: 99 of 100 are nearer; 0 without shadow maps.
  double shadow_edge = 0;
  // The widest possible penumbra, pixels, and the fewest points of the Sun's disc used for it; 1:
  // shadows have hard edges.
  double penumbra = 0;
  unsigned sun_points = 1;
  double sun_error = 0;  // rms error of the disc's light beyond an edge, for these points
  std::vector<ImposterReport> imposters;  // from the largest to the smallest
  // Shader programs first needed by this image, and their build time; some drivers continue at the
  // first drawing.
  std::uint64_t programs = 0;
  double program_seconds = 0;
  // Lights beside the Sun, on the target that has most; those of them that cast no shadows, as they
  // bring a thousandth of the light or less; those left out, as there are more than 64.
  unsigned lamps = 0;
  unsigned lamps_without_shadow = 0;
  unsigned lamps_left_out = 0;
  // Most points of a lamp's disc that cast its shadows, 0: all shadows are hard; the widest
  // possible penumbra of lamps, pixels; and lamps whose shadows are hard for want of maps.
  unsigned lamps_soft = 0;
  double lamp_penumbra = 0;
  unsigned lamps_hard = 0;
};

// Use of imposters: targets drawn separately, finer than pixels, and added by exact areas
// (docs/imposters.md).
enum class Imposters {
  automatic,  // small ones
  off,
  always,  // all that fit a framebuffer at four texels a pixel
};

// Kind of the Sun's shadows.
enum class Shadows {
  automatic,  // of several points of the disc if a penumbra may be wider than half a pixel and
              // samples = 0; else hard
  hard,       // of its centre
  soft,       // of options.sun_points points
};

struct RenderOptions {
  // N: every pixel is the mean of N×N point samples; 1 to 64. 0: by pixel_error, pixel by pixel, up
  // to 64×64.
  unsigned samples = 1;
  // For samples = 0: target error of the pixels of targets (RMSE over RMS radiance) and of the
  // flux; > 0. docs/sampling.md
  double pixel_error = 0.05;
  // For samples = 0: where sampling ends before that, in samples beyond two a pixel, triangles
  // drawn for them included; 0: nowhere.
  double work = 0;
  Imposters imposters = Imposters::automatic;
  // For automatic ones: the largest side, pixels, whatever the samples; none: small ones, only for
  // samples = 0.
  std::optional<double> imposter_pixels;
  // Target error of an imposter's flux, relative, > 0: as estimated from its texels
  // (SamplingReport). Targets of more than 100 pixels are as right as pixel_error asks, by what
  // costs less, unless they have it too.
  double flux_error = 5e-4;
  bool flux_error_of_large = false;
  // PSF of the camera: the RMS width of a Gaussian convolved with the image plane before pixels
  // integrate it, pixels; 0: none. Exact in imposters; elsewhere the pixels are convolved with the
  // discrete kernel of that variance. Truth layers have none.
  double psf_sigma = 0;
  // For N > 1: one sample if predicted to suffice (docs/sampling.md), else N×N.
  bool adaptive = false;
  // Levels of detail of models (docs/mli.md): by pixel footprint, with fades; false: the finest.
  bool levels = true;
  // Replaces the pixel footprint of the image: metres, ≥ 0.
  std::optional<double> level_pixel;
  // Pixels of this image, along a side, to one whose footprint decides the levels: texels of
  // another image's pixels; > 0.
  double level_pixels = 1;
  bool flat = false;  // shade by the triangles' own normals
  // For N > 0 without `adaptive`, except imposters: averages a lobe over the turn of a curved
  // surface's normals between samples, if that exceeds the lobe's width (docs/sampling.md).
  bool specular_filter = true;
  // Shadow map resolution, texels, 16 to 16384 (or the context's limit); 0: no shadows. None: 2048;
  // for samples = 0, 2896; for imposters five for each of the texels along their longer side, 256
  // to 2896; at most 2048 if the Sun has more than 8 points, or several and work a limit
  // (docs/shadows.md).
  std::optional<unsigned> shadow_side;
  Shadows shadows = Shadows::automatic;
  // 2 to 256. Upper bound of automatic ones: by pixel_error, half as many if no penumbra is wider
  // than two pixels; with a limit of work 8, or 4 up to 16 pixels
  unsigned sun_points = 64;
  bool ground_truth = false;       // also depth, range, normal (without bumps) and ids, at the
                                   // pixels' centres
  std::uint32_t tile_side = 2048;  // samples drawn at once, a side; ≥ samples
  std::uint64_t max_bytes = 12ull << 30;  // of the image in memory
  // of shadow maps, 8 a texel, and four times that if the Sun has several points: 16 maps of 2048.
  // Targets wide relative to their visible part have several; beyond the limit visible targets
  // share maps, and there is always one map
  std::uint64_t max_shadow_bytes = 1ull << 29;
  // false: nothing of the Sun arrives from itself; planets, terrain, lamps and other surfaces give
  // theirs.
  bool sunlight = true;
  // Light that other surfaces send each target of the world (transport/transport.h); null: none.
  std::shared_ptr<const std::vector<light::SurfelLight>> indirect;
  // Light that terrain sends each target of the world (GroundLayer::shine()); null: none.
  std::shared_ptr<const std::vector<light::GroundShine>> ground_shine;
  // With `indirect`: mirrors and smooth coats show the Sun and lamps alone, as
  // Reference::add_mirrored() adds the rest.
  bool mirrors_apart = false;
};

// Renderer of worlds into images of linear radiance, one after the other. State derived from a
// world is kept between frames, keyed by the world's stamps: a moving target uploads nothing, and a
// shadow map is redrawn only if it would change.
//
// A pixel (docs/conventions.md) is the mean over its square of the radiance towards the camera,
// under one directional Sun. A point is lit if its shading normal faces a part of the Sun's disc
// and no target stands in between.
//
// Edges of shadows are hard, or the mean of those of several points of the Sun's disc (Shadows).
// They are right to a texel of the shadow map, which spans the lit target in light space. If its
// texels would be wider than two pixels, it consists of tiles that follow the view. Points of a
// smooth mesh are offset past the mesh's error before the test, so that facets cast no shadows on
// the shape they approximate.
//
// The back faces of closed meshes are not drawn. Open meshes, and those with holes (a cutout map),
// have two sides: alike, or with a material each (pan::Model::back_of). A decal lies on the side
// that its z points out of. Bumps are mirrored and stretched with their instance.
//
// All positions are formed in double, camera-relative, and rounded to float once, so the distance
// of the camera costs no precision; targets apart in depth cost each other none. Same world, camera
// and options on the same context kind: the same bits, whatever was drawn before.
class Renderer {
 public:
  // Expects: not null. Cost: nothing; models are uploaded with their first world.
  explicit Renderer(std::shared_ptr<Device> device);
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  // Renders one view. A world without targets, or with hidden ones only, gives the background.
  //
  // Expects: options as documented; a camera of 1 pixel or more, finite and with unit rotations;
  // no view under way.
  // Reports: W5006 when every pixel stays empty or samples may miss a thin target, W5012 when a
  // shadow map is too coarse for the image. Fails: E5001 when the context is lost or cannot be made
  // current; E0001, between tiles; E5003 when the image, a model or the shadows do not fit. After
  // E0001 and E5003 the renderer and earlier contents of the device stay usable. Cost: about one
  // draw of the visible set per tile of tile_side² samples.
  Result<image::Image> render(const world::World& world, const world::Camera& camera,
                              const RenderOptions& options, DiagnosticLog& log,
                              const Job& job = {});

  // The two halves of render(), so that one view is drawn while the one before is copied: submit()
  // returns as soon as its commands are queued, collect() waits for the oldest submitted view. Both
  // ways give the same view.
  //
  // Expects: as render(); fewer than kMostInFlight views under way. World and camera are not needed
  // afterwards.
  // Fails: as render(). Views under way stay, except after E0001 and E5001, when all are dropped.
  static constexpr std::size_t kMostInFlight = 2;
  bool submit(const world::World& world, const world::Camera& camera, const RenderOptions& options,
              DiagnosticLog& log, const Job& job = {});
  // Expects: a view under way, which it ends. Reports: W5006. Fails: E0001, E5001, E5003; all are
  // dropped then, unless another thread has the context.
  Result<image::Image> collect(DiagnosticLog& log, const Job& job = {});
  std::size_t in_flight() const;
  void drop();  // drops all views under way

  // Takes an unused image: a later view reuses its memory, which is faster than fresh memory.
  void recycle(image::Image image);

  const std::shared_ptr<Device>& device() const;

  // Of the last image.
  SamplingReport sampling() const;

  // Counts of work so far; unchanged by frames from caches.
  struct Counts {
    std::uint64_t targets_placed = 0;  // targets whose items were placed in their model's frame
    std::uint64_t shadow_maps = 0;     // drawn
  };
  Counts counts() const;

  // Draws the triangles of render() for one sample a pixel, with the shortest possible shader, into
  // the same kind of framebuffer, and waits. Returns seconds, a lower bound of the context's time;
  // 0 on failure.
  //
  // Expects: an image that fits one framebuffer of the context.
  double seconds_of_bare_draw(const world::World& world, const world::Camera& camera);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::preview
