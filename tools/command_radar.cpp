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
#include "tools/instrument_world.h"
#include "tools/radar_json.h"

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
  InstrumentInput input;
  std::string radar;
  std::vector<std::string> outputs;
  bool ideal = false;
};

void declare_all(Arguments& arguments, Options& options) {
  declare_inputs(
      arguments, options.input,
      "Targets: .pan, .pxn or CAD files; NAME=FILE names a target (default: the file's name). "
      "Or one scenario (.toml) or trajectory, from which speeds follow");
  arguments.add("--radar", options.radar, "RADAR (docs/radar.md)").required().type("FILE.toml");
  arguments
      .add("-o,--output", options.outputs,
           "Histogram of range and speed: .npz, .csv, .png or .exr; may be repeated")
      .required()
      .one_value()
      .type("FILE");
  arguments.flag("--ideal", options.ideal, "Mean power: no speckle, no noise");
  declare_moment(arguments, options.input,
                 "Begin of the dwell in a scenario, seconds (default: its first frame)");
  declare(arguments, options.common);
}

class RadarRun {
 public:
  RadarRun(const Options& options, CommandContext& context)
      : options_(options), context_(context), log_(context.log()), world_(options.input, context) {}

  bool run() {
    if (!read_radar() || !world_.open(0.5 * radar_.dwell)) return false;
    auto frame = world_.frame(log_);
    if (!frame) return false;
    RadarMoment moment{world_.world(), {}};
    world_.set(*frame, moment);
    RadarOptions how;
    how.ideal = options_.ideal;
    how.seed = *frame->settings.noise_seed;
    how.frame = *frame->settings.frame_number;
    std::optional<RadarMotion> motion;
    if (world_.moves()) {
      motion.emplace(RadarMotion{moment, moment});
      if (!world_.move(0, motion->begin, log_) || !world_.move(radar_.dwell, motion->end, log_))
        return false;
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
        log_.report(Code("E0202"), {},
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

  void report(const RadarHistogram& found, const RadarOptions& how) {
    const auto facts = radar_json(radar_, found);
    context_.result().update(facts);
    record_ = radar_record("radar", options_.radar, how, facts);
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
  InstrumentWorld world_;
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
