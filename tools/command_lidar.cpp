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
#include "tools/instrument_world.h"
#include "workspace/record.h"

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
  InstrumentInput input;
  std::string lidar;
  std::vector<std::string> outputs;
  std::string frame = "instrument";
  bool ideal = false;
};

void declare_all(Arguments& arguments, Options& options) {
  declare_inputs(
      arguments, options.input,
      "Targets: .pan, .pxn or CAD files; NAME=FILE names a target (default: the file's name). "
      "Or one scenario (.toml) or trajectory, by which targets and instrument move from pulse to "
      "pulse");
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
  constexpr SettingId kSun[] = {SettingId::sun, SettingId::sun_distance};
  declare_moment(arguments, options.input,
                 "Time of the first pulse in a scenario, seconds (default: its first frame)", kSun);
  declare(arguments, options.common);
}

class LidarRun {
 public:
  LidarRun(const Options& options, CommandContext& context)
      : options_(options), context_(context), log_(context.log()), world_(options.input, context) {}

  bool run() {
    if (!read_lidar() || !world_.open()) return false;
    auto frame = world_.frame(log_);
    if (!frame) return false;
    LidarMoment first{world_.world(), {}};
    world_.set(*frame, first);
    LidarOptions how;
    how.ideal = options_.ideal;
    how.seed = *frame->settings.noise_seed;
    how.frame = *frame->settings.frame_number;
    if (!choose_frame(first.world, how)) return false;
    if (world_.moves())
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
        log_.report(Code("E0202"), {},
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

  // Warnings are those of the first pulse.
  bool move(double time, LidarMoment& moment) {
    DiagnosticLog apart = log_.apart();
    if (world_.move(time, moment, apart)) return true;
    for (const Diagnostic& each : apart.entries()) {
      const FileId file = each.where.file;
      log_.report_file(
          each.code, file == kNoFile ? "" : apart.sources().file(file).name,
          fmt::format("the pulse at {:.9g} s: {}", world_.begin() + time, each.message), each.hint);
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
    if (2 * alarms > cloud.points.size())
      fmt::print(stderr,
                 "most points are false alarms: gate_m = [NEAR, FAR] in [detection] leaves "
                 "out those beyond the target, threshold_e weak ones\n");
    if (!options_.ideal && cloud.energy < lidar_.pulse_energy)
      fmt::print(stderr, "pulses have {:.3g} J, the eye-safe limit; [beam] asks for {:.3g} J\n",
                 cloud.energy, lidar_.pulse_energy);
  }

  const Options& options_;
  CommandContext& context_;
  DiagnosticLog& log_;
  Lidar lidar_;
  InstrumentWorld world_;
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
