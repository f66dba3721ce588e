// Views → images in files.
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
#include "workspace/drawer.h"
#include "workspace/open.h"
#include "workspace/record.h"
#include "workspace/views.h"
#include "world/world.h"

namespace panwright::workspace {

// One image that is written.
struct Written {
  std::size_t view = 0;  // its index
  std::string output;
  std::uint32_t width = 0;  // pixels
  std::uint32_t height = 0;
  std::string unit;                       // of radiance: "1/sr" or "W/(m^2 sr)"
  std::vector<std::string> more_outputs;  // further files of it
  Engine engine = Engine::gl;
  unsigned samples = 0;       // N×N that were asked for; 0: auto
  double ev = 0;              // stops, of a PNG
  bool orthographic = false;  // the camera
  double seconds = 0;         // spent on drawing it
  std::string record;         // JSON: see record_text()
  std::vector<std::string> targets;  // of the world, by name

  std::optional<Measured> measured;                 // by the reference alone
  std::optional<preview::SamplingReport> sampling;  // of OpenGL alone
};

// Called one at a time, on the thread that called run_views; each may be empty.
struct RunListener {
  std::function<void(const EngineInfo&)> ready;  // before the first image
  std::function<void(const Written&)> written;
  std::function<void(const Step&)> step;  // after it
};

struct RunOptions {
  DrawOptions draw;  // of views that have none of their own
  RunListener listener;
  RecordSource source;
};

// Renders views of a world and writes them, in order, each whole or not at all. Models are uploaded
// once; what does not change from view to view is reused. While one image is drawn,
// the one before is copied and the one before that is written.
//
//   returns  the number of images that were written: all of them
// Expects: cameras, Suns and options as the engines want them; targets of unit rotation.
// Fails, before anything is drawn: E0202 for an output of another kind, E0206 for one that is an
// input or that of another view, E5011 for a pose of no target, E5030 for a world without targets,
// E5001 and E5007 without OpenGL. Then: E0001, E0103, E5003; what was written before stays.
// Reports: W5006, W5008, W5012, N5002.
Result<std::size_t> run_views(const world::World& world, std::span<const View> views,
                              const RunOptions& options, DiagnosticLog& log, const Job& job = {});

// Runs of views that share contexts and uploaded models, one run after the other.
class Runner {
 public:
  Runner();
  ~Runner();
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  // As run_views(); may be called again after a failure.
  Result<std::size_t> run(const world::World& world, std::span<const View> views,
                          const RunOptions& options, DiagnosticLog& log, const Job& job = {});

  struct Drawers;

 private:
  std::unique_ptr<Drawers> drawers_;
};

}  // namespace panwright::workspace
