#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/file.h"
#include "base/text.h"
#include "instruments/lidar.h"
#include "instruments/point_files.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "workspace/record.h"
#include "workspace/scenario.h"
#include "workspace/session.h"

namespace panwright::tools {

namespace command_lidar {
namespace {

using instruments::Lidar;
using instruments::LidarCloud;
using instruments::LidarMoment;
using instruments::LidarOptions;
using instruments::PulseStatus;
using workspace::SettingId;

constexpr std::uint64_t kMostLidarBytes = 1 << 20;

struct Options {
  CommonOptions common;
  ReadOptions read;
  ViewOptions view;
  std::vector<std::string> inputs;   // FILE or NAME=FILE, or one scenario
  std::vector<std::string> targets;  // of a scenario
  std::string lidar;
  std::vector<std::string> outputs;
  std::string frame = "instrument";
  std::optional<double> at;  // seconds
  bool ideal = false;
};

void declare_all(Arguments& arguments, Options& options) {
  arguments
      .add("input", options.inputs,
           "Targets: .pan, .pxn or CAD files; NAME=FILE names a target (default: the file's name). "
           "Or one scenario (.toml) or trajectory, by which targets and instrument move from pulse "
           "to pulse")
      .required()
      .type("[NAME=]FILE…");
  arguments.add("--lidar", options.lidar, "LiDAR (docs/lidar.md)").required().type("FILE.toml");
  arguments
      .add("-o,--output", options.outputs,
           "Point cloud: .npz, .pcd, .ply, .csv or .las; may be repeated")
      .required()
      .one_value()
      .type("FILE");
  arguments
      .add("--frame", options.frame,
           "Axes of the points: instrument (default; x right, y down, z along the boresight, at "
           "each pulse), world, or a target's name")
      .type("NAME");
  arguments.flag("--ideal", options.ideal,
                 "Ranges of the axes of the pulses alone: no footprint, receiver or noise");
  arguments
      .add("--at", options.at,
           "Time of the first pulse in a scenario, seconds (default: its first frame)")
      .finite()
      .type("SECONDS");
  arguments
      .add(
          "--target", options.targets,
          "Model of a target, instead of the scenario's: a .pan, .pxn or CAD file; may be repeated")
      .type("NAME=FILE")
      .one_value();
  for (const SettingId id :
       {SettingId::camera, SettingId::look_at, SettingId::up, SettingId::quat,
        SettingId::camera_frame, SettingId::pose, SettingId::joint, SettingId::sun,
        SettingId::sun_distance, SettingId::noise_seed, SettingId::frame_number})
    declare(arguments, options.view, id);
  declare(arguments, options.read);
  declare(arguments, options.read.open.cad);
  declare(arguments, options.common);
}

class LidarRun {
 public:
  LidarRun(const Options& options, CommandContext& context)
      : options_(options), context_(context), log_(context.log()) {}

  bool run() {
    if (!read_lidar() || !open()) return false;
    auto frame = session_->frame(*view_, log_);
    if (!frame) return false;
    LidarMoment first{*world_, {}};
    set(*frame, first);
    LidarOptions how;
    how.ideal = options_.ideal;
    how.seed = *frame->settings.noise_seed;
    how.frame = *frame->settings.frame_number;
    if (!choose_frame(first.world, how)) return false;
    if (scenario_ && !scenario_->sequence.ordered())
      how.motion = [this](double time, LidarMoment& moment) { return move(time, moment); };
    context_.step("measure");
    const auto cloud =
        instruments::measure(lidar_, first.world, first.pose, how, log_, context_.job());
    if (!cloud) return false;
    context_.step("write");
    for (const std::string& output : options_.outputs) {
      if (!instruments::write_points(*cloud, output, workspace::recorded_program(), log_))
        return false;
      context_.wrote(output, counted(cloud->points.size(), "point"));
    }
    report(*cloud);
    return true;
  }

 private:
  bool read_lidar() {
    for (const std::string& output : options_.outputs) {
      if (!instruments::is_point_file(output)) {
        log_.report(Code::E0202, {},
                    fmt::format("unknown format of {}, expected {}", in_quotes(output),
                                instruments::kPointFileTypes));
        return false;
      }
      if (!context_.files().will_write(output, "-o", log_)) return false;
    }
    const auto text = read_file(options_.lidar, kMostLidarBytes, log_);
    if (!text) return false;
    const auto folder = std::filesystem::path(options_.lidar).parent_path();
    auto lidar = instruments::read_lidar(*text, options_.lidar, folder, log_);
    if (lidar) lidar_ = *std::move(lidar);
    return bool(lidar);
  }

  bool open() {
    auto read = options_.read.opening(log_);
    auto settings = options_.view.settings(log_);
    if (!read || !settings) return false;
    if (!read->parameters.empty()) settings->define = std::exchange(read->parameters, {});
    read->prune = false;  // as `render`
    const bool moves =
        options_.inputs.size() == 1 && workspace::is_scenario(options_.inputs.front());
    if (moves ? !open_scenario(*std::move(settings)) : !take_models(*std::move(settings)))
      return false;
    session_.emplace(*std::move(read), preview::ContextKind::automatic);
    if (!workspace::check(workspace::View(moves ? scenario_->settings : view_->settings), log_))
      return false;
    const workspace::View any(moves ? scenario_->settings : view_->settings);
    world_ = session_->world(any, {}, log_, context_.job());
    if (world_ == nullptr || log_.has_errors()) return false;
    if (!moves) return true;
    auto view = view_at(begin_, log_);
    if (view) view_ = *std::move(view);
    return bool(view);
  }

  bool take_models(workspace::Settings settings) {
    if (options_.at || !options_.targets.empty()) {
      log_.report(Code::E0201, {},
                  fmt::format("{} needs a scenario, and models are given",
                              options_.at ? "--at" : "--target"));
      return false;
    }
    settings.targets = options_.inputs;
    view_ = workspace::View(std::move(settings));
    return true;
  }

  bool open_scenario(workspace::Settings settings) {
    auto scenario = workspace::open_scenario(options_.inputs.front(), {}, log_);
    if (!scenario) return false;
    if (!options_.targets.empty()) settings.targets = options_.targets;
    scenario->settings = workspace::with_defaults(std::move(settings), scenario->settings);
    scenario_ = *std::move(scenario);
    if (!scenario_->settings.targets) {
      log_.report_file(Code::E8013, options_.inputs.front(),
                       "the scenario names no model of a target",
                       "[targets] in the scenario, or --target NAME=FILE");
      return false;
    }
    if (options_.at) {
      begin_ = *options_.at;
      return true;
    }
    workspace::FrameChoice choice;
    choice.numbers = std::pair<std::uint64_t, std::uint64_t>(0, 0);
    const auto times = workspace::frame_times(*scenario_, choice, log_);
    if (times) begin_ = times->front();
    return bool(times);
  }

  Result<workspace::View> view_at(double time, DiagnosticLog& log) {
    const auto frame = workspace::frame_at(*scenario_, time, log);
    if (!frame) return failed;
    return workspace::view_of(*scenario_, *frame, 0, *world_, log);
  }

  void set(const workspace::Frame& frame, LidarMoment& moment) const {
    workspace::show(frame, *world_, moment.world);
    moment.pose = {frame.camera().position, frame.camera().world_from_camera};
  }

  // Warnings are those of the first pulse.
  bool move(double time, LidarMoment& moment) {
    DiagnosticLog apart = log_.apart();
    const auto view = view_at(begin_ + time, apart);
    const auto frame = view ? session_->frame(*view, apart) : Result<workspace::Frame>(failed);
    if (frame) {
      set(*frame, moment);
      return true;
    }
    for (const Diagnostic& each : apart.entries()) {
      const FileId file = each.where.file;
      log_.report_file(each.code, file == kNoFile ? "" : apart.sources().file(file).name,
                       fmt::format("the pulse at {:.9g} s: {}", begin_ + time, each.message),
                       each.hint);
    }
    return false;
  }

  bool choose_frame(const world::World& world, LidarOptions& how) {
    if (options_.frame == "instrument") return true;
    how.frame_of = LidarOptions::kWorld;
    if (options_.frame == "world") return true;
    const auto target = world.require(options_.frame, log_);
    if (target) how.frame_of = static_cast<std::int32_t>(*target);
    return bool(target);
  }

  void report(const LidarCloud& cloud) {
    const auto pulses = [&](PulseStatus status) {
      return static_cast<std::size_t>(std::ranges::count(cloud.status, status));
    };
    double near = HUGE_VAL, far = 0;
    std::size_t alarms = 0;
    for (const auto& point : cloud.points) {
      near = std::min(near, point.range);
      far = std::max(far, point.range);
      alarms += (point.flags & instruments::kFalseAlarm) != 0;
    }
    auto& out = context_.result();
    out["lidar"] = lidar_.name;
    out["pulses"] = cloud.pulses.size();
    out["points"] = cloud.points.size();
    out["no_echo"] = pulses(PulseStatus::no_echo);
    out["out_of_gate"] = pulses(PulseStatus::out_of_gate);
    out["dropped"] = pulses(PulseStatus::dropped);
    out["false_alarms"] = alarms;
    out["pulse_energy_j"] = cloud.energy;
    if (cloud.power > 0) out["mean_power_w"] = cloud.power;
    if (!cloud.points.empty()) out["range"] = {near, far};
    if (options_.common.json || options_.common.quiet) return;
    std::string line =
        fmt::format("{}: {}, {}", lidar_.name.empty() ? "lidar" : lidar_.name,
                    counted(cloud.pulses.size(), "pulse"), counted(cloud.points.size(), "point"));
    if (!cloud.points.empty()) line += fmt::format(" from {:.6g} m to {:.6g} m", near, far);
    if (const std::size_t none = pulses(PulseStatus::no_echo))
      line += fmt::format(", {} without echo", none);
    if (const std::size_t out_of = pulses(PulseStatus::out_of_gate))
      line += fmt::format(", {} out of gate", out_of);
    if (alarms > 0) line += fmt::format(", {}", counted(alarms, "false alarm"));
    fmt::print(stderr, "{}\n", line);
    if (!options_.ideal && cloud.energy < lidar_.pulse_energy)
      fmt::print(stderr, "pulses have {:.3g} J, the eye-safe limit; [beam] asks for {:.3g} J\n",
                 cloud.energy, lidar_.pulse_energy);
  }

  const Options& options_;
  CommandContext& context_;
  DiagnosticLog& log_;
  Lidar lidar_;
  std::optional<workspace::Scenario> scenario_;
  std::optional<workspace::ViewSession> session_;
  std::optional<workspace::View> view_;  // of the first pulse
  const world::World* world_ = nullptr;
  double begin_ = 0;
};

int run(const Options& options, const Host& host) {
  CommandContext context("lidar", options.common, host);
  (void)LidarRun(options, context).run();
  return context.finish();
}

}  // namespace
}  // namespace command_lidar

Command lidar_command() {
  return command("lidar", "Measure models with a LiDAR and write point clouds",
                 command_lidar::declare_all, command_lidar::run);
}

}  // namespace panwright::tools
