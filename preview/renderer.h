// World → pixels.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "preview/device.h"
#include "preview/image.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::preview {

// An imposter of an image: targets that were drawn by themselves.
struct ImposterReport {
  std::vector<std::uint32_t> targets;  // of the world
  double extent = 0;                   // of a square that holds them, pixels
  std::uint32_t width = 0;             // texels
  std::uint32_t height = 0;            // texels
  double flux_error = 0;               // as estimated from the texels, relative
  double seconds = 0;                  // from the first draw to the last texel added
};

// How an image was sampled.
struct SamplingReport {
  double samples = 0;  // points a pixel, the mean over the image
  // What is left of the error, as estimated from the samples; 0 where N was given.
  double rmse = 0;  // RMS over the target's pixels, in parts of the RMS of their radiance
  double flux = 0;  // relative, of the sum of all pixels
  // Of the edges of shadows, pixels: 99 of 100 are nearer than that; 0 without shadow maps.
  double shadow_edge = 0;
  // The widest penumbra that what may throw shadows can have, pixels, and the points of the Sun's
  // disc that stand for it, where they are fewest; 1: shadows have hard edges.
  double penumbra = 0;
  unsigned sun_points = 1;
  double sun_error = 0;  // of so many points: what an edge leaves of the disc's light, rms
  std::vector<ImposterReport> imposters;  // from the largest to the smallest
  // Shader programs that this image was the first to need, and what they took of its time; some
  // drivers go on with their work at the first drawing.
  std::uint64_t programs = 0;
  double program_seconds = 0;
};

// Whether targets are drawn by themselves, finer than pixels, and added by exact areas
// (docs/imposters.md).
enum class Imposters {
  automatic,  // small ones
  off,
  always,  // all that a framebuffer holds at four texels a pixel
};

// What shadows the Sun's disc casts.
enum class Shadows {
  automatic,  // those of several points of it where a penumbra may be wider than half a pixel and
              // samples = 0; hard ones elsewhere
  hard,       // those of its centre
  soft,       // those of as many points of it as options.sun_points
};

struct RenderOptions {
  // N: every pixel is the mean of N×N point samples; 1 to 64. 0: as many as pixel_error asks for,
  // pixel by pixel, up to 64×64.
  unsigned samples = 1;
  // Of samples = 0: the error that is aimed at, of the pixels that show a target (RMSE over RMS
  // radiance) and of the flux; > 0. docs/sampling.md
  double pixel_error = 0.05;
  Imposters imposters = Imposters::automatic;
  // Of automatic ones: the largest side, pixels, whatever the samples; none: small ones, and only
  // where samples = 0.
  std::optional<double> imposter_pixels;
  // The error of an imposter's flux that is aimed at, relative, > 0: as estimated from its texels
  // (SamplingReport).
  double flux_error = 5e-4;
  // Of the camera: the RMS width of a Gaussian that the image plane is folded with before pixels
  // integrate it, pixels; 0: none. Exact in imposters; elsewhere the pixels are folded with the
  // discrete kernel of that variance. Truth layers have none.
  double psf_sigma = 0;
  // Of N > 1: one sample where it is predicted to do (docs/sampling.md), N×N elsewhere.
  bool adaptive = false;
  // Of models with levels of detail (docs/mli.md): the finest, or those that a pixel of the image
  // asks for, which fade into each other as it grows.
  bool levels = true;
  // In place of what a pixel of the image sees: metres, ≥ 0.
  std::optional<double> level_pixel;
  bool flat = false;            // shade by the triangles' own normals
  // Of N > 0 without `adaptive`, imposters apart: where the normals of a curved surface turn by more from
  // sample to sample than a lobe is wide, the mean of the lobe over that turn, not its value at a point
  // (docs/sampling.md).
  bool specular_filter = true;
  // Texels a side of the maps of what the Sun sees, 16 to 16384 (or what the context takes); 0:
  // nothing casts shadows. None: 2048; where samples = 0, 2896; of imposters five for each of the
  // texels along their longer side, 256 to 2896; 2048 at most where the Sun has more than 8 points
  // (docs/shadows.md).
  std::optional<unsigned> shadow_side;
  Shadows shadows = Shadows::automatic;
  // 2 to 256. Of automatic ones at most: as many as pixel_error asks for, half as many where no
  // penumbra is wider than two pixels
  unsigned sun_points = 64;
  bool ground_truth = false;    // also depth, range, normal (without bumps) and ids, at the
                                // pixels' centres
  std::uint32_t tile_side = 2048;         // samples that are drawn at once, a side; ≥ samples
  std::uint64_t max_bytes = 12ull << 30;  // of the image in memory
  // of shadow maps, 8 a texel, and four times that where the Sun has several points: 16 maps of 2048,
  // which targets that are wide beside what is seen of
  // them have several of; targets that are seen share maps beyond, and one map there is always
  std::uint64_t max_shadow_bytes = 1ull << 29;
};

// Draws worlds into images of linear radiance, one after the other. What it derives from a world
// is kept from frame to frame, keyed by the world's stamps: a target that moves uploads nothing,
// and a shadow map is drawn again only where it would be another one.
//
// What a pixel is (docs/conventions.md): the mean over its square of the radiance towards the
// camera, one directional Sun; a point is lit where its shading normal faces the Sun and nothing
// of any target stands in between. The edges of shadows are hard, or the mean of those of several points of the
// Sun's disc (Shadows), and right to a texel of the shadow map, which spans the target that is lit
// as the Sun sees it, or, where its texels would be wider than two pixels, consists of tiles that
// follow the view; a point of a smooth mesh is moved out past the mesh's error before it is asked, so
// that facets cast no shadows on the shape they stand for. The back faces of closed meshes are not drawn; open meshes have two sides, and so have
// those with holes (a cutout map), through which one sees what is behind: alike, or each of a
// material of its own (pan::Model::back_of). A decal lies on the side
// that is seen: its z must point out of that side. Bumps are an instance's own: mirrored and
// stretched with it. Whatever decides
// where something is, is formed in double and camera-relative and rounded to float once, so the
// distance of the camera costs no precision; targets that stand apart in depth cost each other
// none. Same world, camera and options on the same context kind: the same bits, whatever was drawn
// before.
class Renderer {
 public:
  // Expects: not null. Cost: nothing; models are uploaded when a world with them is drawn first.
  explicit Renderer(std::shared_ptr<Device> device);
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  // Renders one view. A world without targets, or with hidden ones only, gives the background.
  //
  // Expects: options as documented; a camera of 1 pixel or more, finite and with unit rotations;
  // no view under way.
  // Reports: W5006 when every pixel stays empty, W5012 when a shadow map is too coarse for the
  // image. Fails: E5001 when the context is lost or cannot be
  // made current; E0001, between tiles; E5003 when the image, a model or the shadows do not fit.
  // After E0001 and E5003 the renderer and what was on the device before stay usable.
  // Cost: about one draw of what lies in view per tile of tile_side² samples.
  Result<Image> render(const world::World& world, const world::Camera& camera,
                       const RenderOptions& options, DiagnosticLog& log, const Job& job = {});

  // The two halves of render(), so that one view is drawn while the one before is copied: submit()
  // returns as soon as the context has been told what to draw, collect() waits for the oldest view
  // that was submitted. A view is the same whichever way it is made.
  //
  // Expects: as render(); fewer than kMostInFlight views under way. World and camera are not needed
  // afterwards.
  // Fails: as render(). What was under way stays so, but after E0001 and E5001, when all is
  // dropped.
  static constexpr std::size_t kMostInFlight = 2;
  bool submit(const world::World& world, const world::Camera& camera, const RenderOptions& options,
              DiagnosticLog& log, const Job& job = {});
  // Expects: a view under way, which is not any longer. Reports: W5006. Fails: E0001, E5001, E5003;
  // all is dropped then, unless the context is another thread's for the moment.
  Result<Image> collect(DiagnosticLog& log, const Job& job = {});
  std::size_t in_flight() const;
  void drop();  // all that is under way

  // Takes an image that nobody needs any longer: a later view is written into its memory, which is
  // faster than fresh memory.
  void recycle(Image image);

  const std::shared_ptr<Device>& device() const;

  // Of the last image.
  SamplingReport sampling() const;

  // What was done so far; what frames from caches leave as it is.
  struct Counts {
    std::uint64_t targets_placed = 0;  // targets whose items were placed in their model's frame
    std::uint64_t shadow_maps = 0;     // drawn
  };
  Counts counts() const;

  // Draws what render() would draw for one sample a pixel, with the shortest shader there is, into
  // the same kind of framebuffer, and waits. Returns seconds: what the context needs at least; 0
  // when it cannot be done.
  //
  // Expects: an image that the context can hold in one framebuffer.
  double seconds_of_bare_draw(const world::World& world, const world::Camera& camera);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::preview
