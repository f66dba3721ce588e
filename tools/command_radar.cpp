#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/file.h"
#include "base/text.h"
#include "instruments/radar.h"
#include "instruments/radar_files.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "workspace/record.h"
#include "workspace/scenario.h"
#include "workspace/session.h"

namespace panwright::tools {

namespace command_radar {
namespace {

using instruments::Radar;
using instruments::RadarHistogram;
using instruments::RadarMoment;
using instruments::RadarMotion;
using instruments::RadarOptions;
using workspace::SettingId;

constexpr std::uint64_t kMostRadarBytes = 1 << 20;

struct Options {
  CommonOptions common;
  ReadOptions read;
  ViewOptions view;
  std::vector<std::string> inputs;   // FILE or NAME=FILE, or one scenario
  std::vector<std::string> targets;  // of a scenario
  std::string radar;
  std::vector<std::string> outputs;
  std::optional<double> at;  // seconds
  bool ideal = false;
};

void declare_all(Arguments& arguments, Options& options) {
  arguments
      .add("input", options.inputs,
           "Targets: .pan, .pxn or CAD files; NAME=FILE names a target (default: the file's name). "
           "Or one scenario (.toml) or trajectory, from which speeds follow")
      .required()
      .type("[NAME=]FILE…");
  arguments.add("--radar", options.radar, "RADAR (docs/radar.md)").required().type("FILE.toml");
  arguments
      .add("-o,--output", options.outputs,
           "Histogram of range and speed: .npz, .csv, .png or .exr; may be repeated")
      .required()
      .one_value()
      .type("FILE");
  arguments.flag("--ideal", options.ideal, "Mean power: no speckle, no noise");
  arguments
      .add("--at", options.at,
           "Begin of the dwell in a scenario, seconds (default: its first frame)")
      .finite()
      .type("SECONDS");
  arguments
      .add(
          "--target", options.targets,
          "Model of a target, instead of the scenario's: a .pan, .pxn or CAD file; may be repeated")
      .type("NAME=FILE")
      .one_value();
  for (const SettingId id : {SettingId::camera, SettingId::look_at, SettingId::up, SettingId::quat,
                             SettingId::camera_frame, SettingId::pose, SettingId::joint,
                             SettingId::noise_seed, SettingId::frame_number})
    declare(arguments, options.view, id);
  declare(arguments, options.read);
  declare(arguments, options.read.open.cad);
  declare(arguments, options.common);
}

class RadarRun {
 public:
  RadarRun(const Options& options, CommandContext& context)
      : options_(options), context_(context), log_(context.log()) {}

  bool run() {
    if (!read_radar() || !open()) return false;
    auto frame = session_->frame(*view_, log_);
    if (!frame) return false;
    RadarMoment moment{*world_, {}};
    set(*frame, moment);
    RadarOptions how;
    how.ideal = options_.ideal;
    how.seed = *frame->settings.noise_seed;
    how.frame = *frame->settings.frame_number;
    std::optional<RadarMotion> motion;
    if (scenario_ && !scenario_->sequence.ordered()) {
      motion.emplace(RadarMotion{moment, moment});
      if (!move(0, motion->begin) || !move(radar_.dwell, motion->end)) return false;
    }
    context_.step("measure");
    const auto histogram = instruments::measure(radar_, moment, motion ? &*motion : nullptr, how,
                                                log_, context_.job());
    if (!histogram) return false;
    report(*histogram, how);
    context_.step("write");
    for (const std::string& output : options_.outputs) {
      if (!instruments::write_histogram(*histogram, output, record_, log_)) return false;
      context_.wrote(output, fmt::format("{} x {} cells", histogram->ranges, histogram->speeds));
    }
    return true;
  }

 private:
  bool read_radar() {
    for (const std::string& output : options_.outputs) {
      if (!instruments::is_histogram_file(output)) {
        log_.report(Code::E0202, {},
                    fmt::format("unknown format of {}, expected {}", in_quotes(output),
                                instruments::kHistogramFileTypes));
        return false;
      }
      if (!context_.files().will_write(output, "-o", log_)) return false;
    }
    const auto text = read_file(options_.radar, kMostRadarBytes, log_);
    if (!text) return false;
    auto radar = instruments::read_radar(*text, options_.radar, log_);
    if (radar) radar_ = *std::move(radar);
    return bool(radar);
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
    const double middle = scenario_->sequence.ordered() ? 0 : 0.5 * radar_.dwell;
    auto view = view_at(begin_ + middle);
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

  Result<workspace::View> view_at(double time) {
    const auto frame = workspace::frame_at(*scenario_, time, log_);
    if (!frame) return failed;
    return workspace::view_of(*scenario_, *frame, 0, *world_, log_);
  }

  void set(const workspace::Frame& frame, RadarMoment& moment) const {
    workspace::show(frame, *world_, moment.world);
    moment.pose = {frame.camera().position, frame.camera().world_from_camera};
  }

  bool move(double time, RadarMoment& moment) {
    const auto view = view_at(begin_ + time);
    if (!view) return false;
    const auto frame = session_->frame(*view, log_);
    if (!frame) return false;
    set(*frame, moment);
    return true;
  }

  void report(const RadarHistogram& found, const RadarOptions& how) {
    auto& out = context_.result();
    out["radar"] = radar_.name;
    out["ranges"] = {
        {"count", found.ranges}, {"first_m", found.first_range}, {"step_m", found.range_step}};
    out["speeds"] = {
        {"count", found.speeds}, {"first_m_s", found.first_speed}, {"step_m_s", found.speed_step}};
    out["gain"] = found.gain;
    out["echo_power_w"] = found.echo_power;
    out["outside"] = found.outside;
    out["noise_w"] = found.noise;
    out["response_sum"] = found.response_sum;
    out["rays"] = found.rays;
    out["hits"] = found.hits;
    out["ray_spacing_rad"] = found.spacing;
    auto& targets = out["targets"] = nlohmann::ordered_json::array();
    for (const auto& each : found.targets) {
      auto& target = targets.emplace_back(
          nlohmann::ordered_json{{"name", each.name}, {"cross_section_m2", each.cross_section}});
      if (std::isnan(each.range)) continue;
      target["range_m"] = each.range;
      target["speed_m_s"] = each.speed;
    }
    if (found.altitude) out["altitude_m"] = *found.altitude;
    nlohmann::ordered_json record{
        {"program", workspace::recorded_program()},
        {"command", "radar"},
        {"radar_file", std::filesystem::path(options_.radar).filename().string()},
        {"ideal", how.ideal},
        {"noise_seed", how.seed},
        {"frame_number", how.frame}};
    for (const char* name : {"radar", "ranges", "speeds", "gain", "echo_power_w", "outside",
                             "noise_w", "response_sum", "targets", "altitude_m"})
      if (out.contains(name)) record[name] = out[name];
    record_ = record.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
    if (!options_.common.json && !options_.common.quiet) say(found);
  }

  void say(const RadarHistogram& found) const {
    fmt::print(stderr,
               "{}: {} ranges from {:.6g} m, {:.4g} m apart; {} speeds from {:.4g} m/s, {:.4g} m/s "
               "apart\n",
               radar_.name.empty() ? "radar" : radar_.name, found.ranges, found.first_range,
               found.range_step, found.speeds, found.first_speed, found.speed_step);
    for (const auto& each : found.targets)
      fmt::print(stderr, "{}: {}\n", each.name,
                 std::isnan(each.range)
                     ? "no echo"
                     : fmt::format("cross-section {:.4g} m2 at {:.6g} m and {:.4g} m/s",
                                   each.cross_section, each.range, each.speed));
    if (found.outside > 0.01)
      fmt::print(stderr, "{:.0f} % of the power is outside of the histogram\n",
                 100 * found.outside);
    if (found.altitude)
      fmt::print(stderr, "altitude {:.6g} m\n", *found.altitude);
    else if (radar_.altimeter > 0)
      fmt::print(stderr, "no altitude: no echo stands out of the noise\n");
  }

  const Options& options_;
  CommandContext& context_;
  DiagnosticLog& log_;
  Radar radar_;
  std::string record_;
  std::optional<workspace::Scenario> scenario_;
  std::optional<workspace::ViewSession> session_;
  std::optional<workspace::View> view_;  // in the middle of the dwell
  const world::World* world_ = nullptr;
  double begin_ = 0;
};

int run(const Options& options, const Host& host) {
  CommandContext context("radar", options.common, host);
  (void)RadarRun(options, context).run();
  return context.finish();
}

}  // namespace
}  // namespace command_radar

Command radar_command() {
  return command("radar", "Measure models with a RADAR: histograms of range and speed",
                 command_radar::declare_all, command_radar::run);
}

}  // namespace panwright::tools
