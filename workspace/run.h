// Rendering of frames into files of their products.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "labels/labels.h"
#include "workspace/drawer.h"
#include "workspace/frame.h"
#include "workspace/open.h"
#include "workspace/product.h"
#include "workspace/record.h"
#include "world/world.h"

namespace panwright::workspace {

// Written image.
struct Written {
  std::size_t frame = 0;             // its index
  std::vector<std::string> outputs;  // files of one image
  std::uint32_t width = 0;           // pixels
  std::uint32_t height = 0;
  std::string unit;  // of radiance: "1/sr" or "W/(m^2 sr)"
  Engine engine = Engine::gl;
  unsigned samples = 0;              // requested N×N; 0: auto
  double ev = 0;                     // stops, of a PNG
  bool orthographic = false;         // the camera
  double seconds = 0;                // spent on drawing it
  std::size_t moments = 1;           // of its exposure, drawn one by one
  double exposure_s = 0;             // of a detector; 0: there is none
  unsigned dn_bits = 0;              // of its numbers
  std::size_t saturated = 0;         // pixels
  std::string record;                // JSON of record_text()
  std::vector<std::string> targets;  // of the world, by name
  // Settings of the scene of a model, as "sun 1 0 0", and its target; lamps of models with their
  // state.
  std::vector<std::string> of_scene;
  std::string scene_target;
  std::vector<std::string> lamps_on, lamps_off;
  std::vector<std::string> sky;  // bodies and eclipses of the image, a text each

  std::optional<Measured> measured;                 // only by the reference
  std::optional<preview::SamplingReport> sampling;  // only by OpenGL
  std::optional<LightBetween> between;              // none: not asked for
  std::optional<GroundLight> ground_light;          // as Drawn::ground_light
  double ground_rays = 0;                           // as Drawn::ground_rays
};

// Product in memory.
struct Kept {
  Written what;
  Product product;
  std::optional<labels::FrameLabels> labels;  // of a frame that asks for them
};

// Called one at a time, on the thread that called run_frames; each may be empty.
struct RunListener {
  // before the first image of an engine; of OpenGL again when its context opens
  std::function<void(const EngineInfo&)> ready;
  std::function<void(const Written&)> written;
  std::function<void(const Step&)> step;  // after it
  // Sees each product of a frame of a world, before `written` or `kept`.
  std::function<void(const world::World&, const Frame&, const Product&)> seen;
  // Takes the products in place of files, in order. Frames need no outputs then, and have ground
  // truth as their setting `layers` says. The memory of an image that is left there is used again.
  std::function<void(Kept&)> kept;
};

struct RunOptions {
  preview::ContextKind context = preview::ContextKind::automatic;
  RunListener listener;
  RecordSource source;
};

struct Drawers;  // kept by a Runner

// Renders frames of a world and writes them, in order, each atomically. Models are uploaded once;
// unchanged state is reused between frames. Drawing of one image overlaps copying and writing of
// the two before.
//
//   returns  the number of written images: all of them
// Expects: cameras, Suns as the engines require; targets of unit rotation.
// Fails, before anything is drawn: E0201 for contradictory settings, E0202 for an output of another
// kind, E0206 for one that is an input or that of another frame; E5011 for a pose of no target;
// E5030 for a world without targets, E5001 and E5007 without OpenGL. Then: E0001, E0103, E5003;
// earlier outputs stay. Reports: W5006, W5008, W5012, W5016, N5002.
Result<std::size_t> run_frames(const world::World& world, std::span<const Frame> frames,
                               const RunOptions& options, DiagnosticLog& log, const Job& job = {});

// Runs of frames that share contexts and uploaded models, one run after the other.
class Runner {
 public:
  Runner();
  ~Runner();
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  // Runs as run_frames(); may be called again after a failure.
  Result<std::size_t> run(const world::World& world, std::span<const Frame> frames,
                          const RunOptions& options, DiagnosticLog& log, const Job& job = {});

 private:
  std::unique_ptr<Drawers> drawers_;
};

}  // namespace panwright::workspace
