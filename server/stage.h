// Models, contexts and rays that sessions share: what draws their worlds and answers look-ups.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "image/image.h"
#include "preview/context.h"
#include "server/state.h"
#include "trace/scene.h"
#include "workspace/frame.h"
#include "workspace/open.h"
#include "workspace/run.h"
#include "workspace/settings.h"

namespace panwright::server {

struct StageOptions {
  std::vector<std::string> targets;  // FILE or NAME=FILE
  workspace::OpenOptions open;
  workspace::Settings defaults;  // of images; also a session's first state
  preview::ContextKind context = preview::ContextKind::automatic;
};

// A frame of an object, which cameras may be placed in.
struct ObjectFrame {
  std::size_t target = 0;   // index in the world
  std::uint32_t frame = 0;  // index in its model
};

// Drawn image, before it is encoded.
struct Drawing {
  image::Image image;
  double white = 1;  // irradiance whose white Lambert plate is white, 2^EV included
};

// Takes a drawn image that is no longer needed, what it shows at a time in seconds, and the seconds
// that the answer took.
using ShownImage = std::function<void(Drawing&& drawing, const world::Camera& camera,
                                      const world::World& world, double time, double seconds)>;

// It belongs to one thread at a time, that of its context.
class Stage {
 public:
  // Opens the targets. Fails: as workspace::open_world(), FrameMaker::frame(); E0201 for --ev auto.
  static Result<std::unique_ptr<Stage>> open(const StageOptions& options, DiagnosticLog& log,
                                             const Job& job);

  // Returns the state in which sessions begin.
  const State& initial() const { return initial_; }

  // Returns the target of an object: one whose name is the number, else by the order of the command
  // line from 0.
  std::optional<std::size_t> target_of(const State& state, std::uint32_t object) const;
  // Returns the frame of a camera that is not the session's own.
  std::optional<ObjectFrame> frame_of(const State& state, std::uint32_t camera) const;
  // Returns world_from_frame, unit rotation, x right, y down, z forward. Expects: of the world.
  world::Pose pose_of(const State& state, const ObjectFrame& frame) const;
  // Returns a camera with its pose and lens; nothing: there is none of this number.
  std::optional<world::Camera> camera_of(const State& state, std::uint32_t camera) const;

  // Draws an image and calls `use` with it, which may take it; the memory of one that stays is that
  // of the next.
  //
  //   camera  as of camera_of()
  //   lens    of it; null: without motion
  //   ranges  true: the image has its layer of ranges
  // Fails: as workspace::Runner.
  bool draw(const State& state, const world::Camera& camera, const Lens* lens, bool ranges,
            const std::function<void(Drawing& drawing)>& use, DiagnosticLog& log, const Job& job);

  // Returns rays over the world of a state, until the next call. Throws Cancelled.
  trace::Scene& rays(const State& state, const Job& job);
  // Reports damaged tiles of terrain that rays have met, once each: W9615.
  void report_damaged(DiagnosticLog& log) const { rays_.report_damaged(log); }

 private:
  Stage(const StageOptions& options, world::World world)
      : options_(options), maker_world_(std::move(world)), maker_(maker_world_) {}
  bool begin(DiagnosticLog& log);
  void light_world(const State& state, const world::Camera& camera, world::World& world) const;
  bool add_motion(const State& state, const world::Camera& camera, const Lens& lens,
                  workspace::Frame& frame, DiagnosticLog& log);
  workspace::View view_at(const world::Pose& pose) const;

  StageOptions options_;
  const world::World maker_world_;
  workspace::FrameMaker maker_;
  workspace::Frame base_;
  State initial_;
  std::shared_ptr<const light::StarCatalogue> catalogue_;
  workspace::Runner runner_;
  trace::Scene rays_{{0, true}};
};

}  // namespace panwright::server
