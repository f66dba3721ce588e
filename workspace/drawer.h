// Drawer of worlds into images in memory, by one engine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/math.h"
#include "base/result.h"
#include "image/image.h"
#include "preview/context.h"
#include "preview/reference/reference.h"
#include "preview/renderer.h"
#include "workspace/settings.h"
#include "world/world.h"

namespace panwright::workspace {

// gl: the preview, OpenGL. reference: the path tracer, without OpenGL, slow, with error bars.
using Engine = Settings::Engine;

// Light between surfaces in OpenGL (transport/transport.h). automatic: in images that it changes by
// more than RenderOptions::pixel_error, as Transport::change_seen() estimates.
using Indirect = Settings::Indirect;

// Light between surfaces of an image.
struct LightBetween {
  bool drawn = false;    // false: it changes too little
  bool mirrors = false;  // targets have mirrors or smooth coats, which show others
  // Estimates of what it adds, in parts of the image's; of what mirrors show only where automatic
  // needs it.
  double rms = 0, flux = 0;
  std::uint64_t surfels = 0;
  double seconds = 0;  // spent on finding it; 0: known
};

struct DrawOptions {
  Engine engine = Engine::gl;
  preview::ContextKind context = preview::ContextKind::automatic;
  unsigned samples = 0;  // N: N×N in each pixel; 0: by the engine's own options, which may set an
                         // error (preview::RenderOptions)
  // `ground_truth` of both is that of the call.
  preview::RenderOptions gl;  // without `indirect` and `ground_shine`
  preview::ReferenceOptions reference;
  Indirect indirect = Indirect::off;
  std::filesystem::path cache;  // OpenOptions
  bool photo = false;           // tone curve of PNGs: image::PngExposure
  image::FileOptions files;     // of the image's .exr and .npz
};

// Returns the options of both engines for sound settings (check()), presets included.
DrawOptions draw_options(const Settings& settings, preview::ContextKind context);
image::FileOptions file_options(const Settings& settings);

// Engine in use.
struct EngineInfo {
  Engine engine = Engine::gl;
  // of the OpenGL context; empty and false: none, as of the reference and of terrain
  std::string renderer;
  std::string version;
  bool hardware = false;
};

// Statistics of the reference renderer: see preview::ReferenceImage.
struct Measured {
  Vec3 flux{0};
  Vec3 flux_error{0};
  std::uint64_t samples = 0;
  std::uint64_t rays = 0;
  double seconds = 0;
};

// Light that terrain sends to targets.
struct GroundLight {
  double share = 0;    // of the Sun's irradiance, on a plate that faces it, of the target with most
  double seconds = 0;  // 0: found before
};

struct Drawn {
  image::Image image;
  std::optional<Measured> measured;                 // only by the reference
  std::optional<preview::SamplingReport> sampling;  // only by OpenGL
  std::optional<LightBetween> between;              // none: not asked for
  std::optional<GroundLight> ground_light;          // only by OpenGL, of targets beside terrain
  double ground_rays = 0;  // a pixel, of terrain beside OpenGL; 0: it has none
};

// Drawer, with the state shared by images: the context, the models of the last world.
class Drawer {
 public:
  explicit Drawer(const DrawOptions& options);
  Drawer(Drawer&&) noexcept;
  Drawer& operator=(Drawer&&) noexcept;
  ~Drawer();

  EngineInfo info() const;

  // Opens an OpenGL context if the engine is OpenGL and a world is not of terrain alone.
  // draw() does so if needed.
  //
  // Fails: E5001, E5007. Reports: N5002.
  bool open(const world::World& world, DiagnosticLog& log);

  // Sets options for later images. Expects: the same engine and kind of context.
  void set_options(const DrawOptions& options);

  // Uploads the models of a world, or builds their acceleration structures. draw() does so if
  // needed.
  //
  // Expects: targets. Fails: E0001, E5003, as open().
  bool prepare(const world::World& world, DiagnosticLog& log, const Job& job = {});

  // The two halves of draw(): submit() begins an image, collect() ends the oldest one under way.
  // With OpenGL the next image can be drawn while one is copied; the reference completes in
  // submit().
  //
  // Expects: as draw(); fewer than kMostInFlight images under way. Fails: as draw(); images under
  // way stay, except after E0001 and E5001 and a failure of collect(), when all are dropped.
  static constexpr std::size_t kMostInFlight = preview::Renderer::kMostInFlight;
  bool submit(const world::World& world, const world::Camera& camera, bool ground_truth,
              DiagnosticLog& log, const Job& job = {});
  Result<Drawn> collect(DiagnosticLog& log, const Job& job = {});
  std::size_t in_flight() const;
  // Takes back an image, to reuse its memory.
  void recycle(image::Image image);

  // Draws a world.
  //
  //   ground_truth  true: also renders the ground truth layers
  // Expects: targets; camera, Sun and options as the engine requires.
  // Fails: E0001, E5003, as open(). Reports: W5006, W5008, W5012.
  Result<Drawn> draw(const world::World& world, const world::Camera& camera, bool ground_truth,
                     DiagnosticLog& log, const Job& job = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::workspace
