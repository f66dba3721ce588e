#include "tools/instrument_world.h"

#include <fmt/format.h>

#include <utility>

namespace panwright::tools {

using workspace::SettingId;

void declare_inputs(Arguments& arguments, InstrumentInput& input, const char* help) {
  arguments.add("input", input.inputs, help).required().type("[NAME=]FILE…");
}

void declare_moment(Arguments& arguments, InstrumentInput& input, const char* help,
                    std::span<const SettingId> more) {
  arguments.add("--at", input.at, help).finite().type("SECONDS");
  arguments
      .add(
          "--target", input.targets,
          "Model of a target, instead of the scenario's: a .pan, .pxn or CAD file; may be repeated")
      .type("NAME=FILE")
      .one_value();
  for (const SettingId id : {SettingId::camera, SettingId::look_at, SettingId::up, SettingId::quat,
                             SettingId::camera_frame, SettingId::pose, SettingId::joint})
    declare(arguments, input.view, id);
  for (const SettingId id : more) declare(arguments, input.view, id);
  for (const SettingId id : {SettingId::noise_seed, SettingId::frame_number})
    declare(arguments, input.view, id);
  declare(arguments, input.read);
  declare(arguments, input.read.open.cad);
}

bool InstrumentWorld::open(double after) {
  DiagnosticLog& log = context_.log();
  auto read = input_.read.opening(log);
  auto settings = input_.view.settings(log);
  if (!read || !settings) return false;
  if (!read->parameters.empty()) settings->define = std::exchange(read->parameters, {});
  read->prune = false;  // as `render`
  const bool scenario = input_.inputs.size() == 1 && workspace::is_scenario(input_.inputs.front());
  if (scenario ? !open_scenario(*std::move(settings)) : !take_models(*std::move(settings)))
    return false;
  session_.emplace(*std::move(read), preview::ContextKind::automatic);
  const workspace::View any(scenario ? scenario_->settings : view_->settings);
  if (!workspace::check(any, log)) return false;
  world_ = session_->world(any, {}, log, context_.job());
  if (world_ == nullptr || log.has_errors()) return false;
  if (!scenario) return true;
  auto view = view_at(begin_ + (moves() ? after : 0), log);
  if (view) view_ = *std::move(view);
  return bool(view);
}

bool InstrumentWorld::take_models(workspace::Settings settings) {
  if (input_.at || !input_.targets.empty()) {
    context_.log().report(
        Code("E0201"), {},
        fmt::format("{} needs a scenario, and models are given", input_.at ? "--at" : "--target"));
    return false;
  }
  settings.targets = input_.inputs;
  view_ = workspace::View(std::move(settings));
  return true;
}

bool InstrumentWorld::open_scenario(workspace::Settings settings) {
  DiagnosticLog& log = context_.log();
  auto scenario = workspace::open_scenario(input_.inputs.front(), {}, log);
  if (!scenario) return false;
  if (!input_.targets.empty()) settings.targets = input_.targets;
  scenario->settings = workspace::with_defaults(std::move(settings), scenario->settings);
  scenario_ = *std::move(scenario);
  if (!scenario_->settings.targets) {
    log.report_file(Code("E8013"), input_.inputs.front(), "the scenario names no model of a target",
                    "[targets] in the scenario, or --target NAME=FILE");
    return false;
  }
  if (input_.at) {
    begin_ = *input_.at;
    return true;
  }
  workspace::FrameChoice choice;
  choice.numbers = std::pair<std::uint64_t, std::uint64_t>(0, 0);
  const auto times = workspace::frame_times(*scenario_, choice, log);
  if (times) begin_ = times->front();
  return bool(times);
}

Result<workspace::View> InstrumentWorld::view_at(double time, DiagnosticLog& log) const {
  const auto frame = workspace::frame_at(*scenario_, time, log);
  if (!frame) return failed;
  auto view = workspace::view_of(*scenario_, *frame, 0, *world_, log);
  // no frame of a run: its noise is that of --frame-number
  if (view) view->settings.frame_number = scenario_->settings.frame_number;
  return view;
}

}  // namespace panwright::tools
