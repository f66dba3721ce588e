// Targets and pose of an instrument: what commands that measure by rays share.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/command_context.h"
#include "workspace/scenario.h"
#include "workspace/session.h"
#include "workspace/targets.h"

namespace panwright::tools {

struct InstrumentInput {
  ReadOptions read;
  ViewOptions view;
  std::vector<std::string> inputs;   // FILE or NAME=FILE, or one scenario
  std::vector<std::string> targets;  // of a scenario
  std::optional<double> at;          // seconds
};

void declare_inputs(Arguments& arguments, InstrumentInput& input, const char* help);
// Declares --at with its help, --target, the pose, `more`, seed and frame number.
void declare_moment(Arguments& arguments, InstrumentInput& input, const char* help,
                    std::span<const workspace::SettingId> more = {});

// World of models, or of a scenario, and the instrument's pose as that of a camera.
class InstrumentWorld {
 public:
  InstrumentWorld(const InstrumentInput& input, CommandContext& context)
      : input_(input), context_(context) {}

  // after  seconds from the begin to the frame of a scenario that moves
  bool open(double after = 0);
  // Expects: open(), as the others.
  const world::World& world() const { return *world_; }
  bool moves() const { return scenario_ && !scenario_->sequence.ordered(); }
  double begin() const { return begin_; }  // seconds
  Result<workspace::Frame> frame(DiagnosticLog& log) { return session_->frame(*view_, log); }

  // Sets the world and the pose of a frame; of a time in seconds from the begin.
  template <class Moment>
  void set(const workspace::Frame& frame, Moment& moment) const {
    workspace::show(frame, *world_, moment.world);
    moment.pose = {frame.camera().position, frame.camera().world_from_camera};
  }
  template <class Moment>
  bool move(double time, Moment& moment, DiagnosticLog& log) {
    const auto view = view_at(begin_ + time, log);
    const auto frame = view ? session_->frame(*view, log) : Result<workspace::Frame>(failed);
    if (frame) set(*frame, moment);
    return bool(frame);
  }

 private:
  bool take_models(workspace::Settings settings);
  bool open_scenario(workspace::Settings settings);
  Result<workspace::View> view_at(double time, DiagnosticLog& log) const;

  const InstrumentInput& input_;
  CommandContext& context_;
  std::optional<workspace::Scenario> scenario_;
  std::optional<workspace::ViewSession> session_;
  std::optional<workspace::View> view_;
  const world::World* world_ = nullptr;
  double begin_ = 0;
};

}  // namespace panwright::tools
