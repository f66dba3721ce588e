#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/text.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/frame_json.h"
#include "tools/plot.h"
#include "tools/print.h"
#include "tools/scenario_course.h"
#include "tools/scenario_options.h"

namespace panwright::tools {

namespace command_scenario {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  CommonOptions common;
  ScenarioInput input;
  std::vector<std::string> targets;
  std::string plot;  // SVG; empty: none
};

void declare_all(Arguments& arguments, Options& options) {
  declare(arguments, options.input);
  arguments
      .add("--target", options.targets,
           "Model of a target, for --plot and the names of joints, instead of the scenario's; may "
           "be "
           "repeated")
      .one_value()
      .type("NAME=FILE");
  arguments
      .add(
          "--plot", options.plot,
          "Write range and phase angle over time as SVG; where models are named also their pixels, "
          "their share in the image, and that of the Sun that bodies leave them")
      .type("FILE.svg");
  declare(arguments, options.common);
}

std::pair<double, double> extremes(const PlotPoints& points) {
  std::pair<double, double> out(HUGE_VAL, -HUGE_VAL);
  for (const auto& [time, value] : points)
    out = {std::min(out.first, value), std::max(out.second, value)};
  return out;
}

// A plot of one quantity of all courses; empty: none has it.
std::string plotted(const std::vector<Course>& courses, PlotPoints Course::*quantity,
                    const char* title, const char* unit, const char* x_name) {
  constexpr const char* kColors[] = {"#1f5fa8", "#c04a1e", "#2c8a4b", "#7b4ca0"};
  Plot plot{.title = title, .x_name = x_name, .y_name = unit};
  plot.left = HUGE_VAL, plot.right = -HUGE_VAL;
  double high = 0;
  for (const Course& course : courses) {
    const PlotPoints& points = course.*quantity;
    if (points.empty()) continue;
    plot.left = std::min(plot.left, points.front().first);
    plot.right = std::max(plot.right, points.back().first);
    high = std::max(high, extremes(points).second);
    plot.curves.push_back({points, kColors[plot.curves.size() % std::size(kColors)], course.name});
  }
  if (plot.curves.empty()) return {};
  if (!(plot.right > plot.left)) plot.right = plot.left + 1;
  plot.top = high > 0 ? 1.05 * high : 1;
  return svg_of(plot);
}

// One drawing above the other.
std::string stacked(const std::vector<std::string>& plots) {
  constexpr int kWidth = 640, kHeight = 420;
  std::string out =
      fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\">\n", kWidth,
                  kHeight * plots.size());
  for (std::size_t k = 0; k < plots.size(); ++k) {
    const std::size_t begin = plots[k].find("<svg");
    out += fmt::format("<g transform=\"translate(0 {})\">\n", kHeight * k) +
           plots[k].substr(begin == std::string::npos ? 0 : begin) + "</g>\n";
  }
  return out + "</svg>\n";
}

void print_summary(const ScenarioInput& input, const ScenarioInput::Opened& opened,
                   const std::vector<Course>& courses) {
  const scenario::Sequence& sequence = opened.scenario.sequence;
  std::string line = fmt::format("{}: {}", input.file, counted(opened.times.size(), "frame"));
  if (!sequence.ordered())
    line += fmt::format(", {:.9g} s to {:.9g} s", opened.times.front(), opened.times.back());
  if (sequence.epoch())
    line += fmt::format(" after {} {}", epoch_text(*sequence.epoch(), sequence.system()),
                        time_system_name(sequence.system()));
  print("{}\n", line);
  for (const scenario::Channel& channel : sequence.channels())
    print("  {}\n", channel_text(channel));
  for (const Course& course : courses) {
    const auto [least, most] = extremes(course.range);
    std::string words =
        fmt::format("  range of {}: {:.6g} m to {:.6g} m", course.name, least, most);
    if (!course.phase.empty()) {
      const auto [from, to] = extremes(course.phase);
      words += fmt::format("; phase angle: {:.4g} deg to {:.4g} deg", from, to);
    }
    print("{}\n", words);
    if (course.pixels.empty()) continue;
    const auto seen =
        std::ranges::count_if(course.in_image, [](const auto& p) { return p.second > 0; });
    const auto [few, many] = extremes(course.pixels);
    words = fmt::format("    {:.4g} to {:.4g} pixels; in the image in {} of {} frames", few, many,
                        seen, course.in_image.size());
    if (!course.sun.empty()) {
      const auto [dark, light] = extremes(course.sun);
      words += fmt::format("; {:.3g} to {:.3g} of the Sun", dark, light);
    }
    print("{}\n", words);
  }
}

// Joints are known to models alone.
bool names_joints(const workspace::Scenario& scenario) {
  const auto of_joint = [](const scenario::Channel& channel) { return !channel.joint.empty(); };
  return scenario.settings.joint || std::ranges::any_of(scenario.sequence.channels(), of_joint);
}

int run(const Options& options, const Host& host) {
  CommandContext context("scenario", options.common, host);
  DiagnosticLog& log = context.log();
  if (!options.plot.empty() && !context.files().will_write(options.plot, "--plot", log))
    return context.finish();
  auto opened = options.input.open(log);
  if (!opened) return context.finish();
  workspace::check_stars(opened->scenario, log);
  const scenario::Sequence& sequence = opened->scenario.sequence;
  std::vector<Course> courses;
  if (!options.targets.empty()) opened->scenario.settings.targets = options.targets;
  std::optional<SeenTargets> seen;
  if (opened->scenario.settings.targets &&
      (!options.plot.empty() || names_joints(opened->scenario))) {
    auto made = SeenTargets::of(opened->scenario, log, context.job());
    if (!made) return context.finish();
    seen = *std::move(made);
  }
  Json frames = Json::array();
  for (std::size_t k = 0; k < opened->times.size(); ++k) {
    const double time = opened->times[k];
    const auto frame = workspace::frame_at(opened->scenario, time, log);
    if (!frame) return context.finish();
    add(*frame, time, courses);
    const std::uint64_t number = opened->first + k;
    // the first one for its mistakes, as `run` does
    if (seen && k == 0 && !seen->check(*frame, number, log)) return context.finish();
    if (seen && !options.plot.empty() && !seen->add(*frame, number, time, courses, log))
      return context.finish();
    if (options.common.json) frames.push_back(frame_json(*frame, number));
  }
  if (options.common.json) {
    Json& result = context.result();
    if (sequence.epoch()) {
      result["epoch"] = epoch_text(*sequence.epoch(), sequence.system());
      result["time_system"] = time_system_name(sequence.system());
    }
    result["channels"] = Json::array();
    for (const scenario::Channel& channel : sequence.channels())
      result["channels"].push_back(channel_text(channel));
    result["frames"] = std::move(frames);
  } else {
    print_summary(options.input, *opened, courses);
  }
  if (!options.plot.empty()) {
    const char* x_name = sequence.ordered() ? "frame" : "s";
    std::vector<std::string> plots;
    for (std::string plot : {plotted(courses, &Course::range, "Range", "m", x_name),
                             plotted(courses, &Course::phase, "Phase angle", "deg", x_name),
                             plotted(courses, &Course::pixels, "Convex outline", "pixels", x_name),
                             plotted(courses, &Course::in_image, "Share in the image", "", x_name),
                             plotted(courses, &Course::sun, "Share of the Sun", "", x_name)})
      if (!plot.empty()) plots.push_back(std::move(plot));
    if (write_file(options.plot, as_bytes(stacked(plots)), log)) context.wrote(options.plot);
  }
  return context.finish();
}

}  // namespace
}  // namespace command_scenario

Command scenario_command() {
  return command("scenario", "Print the frames of a scenario or trajectory, without images",
                 command_scenario::declare_all, command_scenario::run);
}

}  // namespace panwright::tools
