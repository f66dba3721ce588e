#include "studio/play.h"

#include <algorithm>
#include <map>
#include <utility>

#include "scenario/time.h"
#include "workspace/targets.h"

namespace panwright::studio {
namespace {

constexpr std::uint64_t kTrackSteps = 2000;
constexpr std::uint64_t kMadeSteps = 200;  // where the camera's position follows from the models

// Moments of a camera that is open for a while, and the path tracer, are not for a window.
void leave_out(workspace::View& view) {
  const workspace::Settings standard;
  workspace::Settings& settings = view.settings;
  view.motion = {};
  settings.exposure = standard.exposure;
  settings.line_time = standard.line_time;
  settings.engine = standard.engine;
}

}  // namespace

bool Play::is_reduced() const {
  const workspace::Settings standard;
  const workspace::Settings& settings = scenario.settings;
  return *settings.exposure != *standard.exposure || *settings.line_time != *standard.line_time ||
         *settings.engine != *standard.engine;
}

Result<Play> open_play(const std::string& file, const std::string& owner,
                       const std::vector<std::string>& models, const std::string& camera,
                       DiagnosticLog& log) {
  auto scenario = workspace::open_scenario(file, {owner, false}, log);
  if (!scenario) return failed;
  if (!camera.empty()) {
    workspace::Settings own;
    own.camera_file = camera;
    scenario->settings = workspace::with_defaults(std::move(own), scenario->settings);
  }
  auto times = workspace::frame_times(*scenario, {}, log);
  if (!times) return failed;
  std::vector<std::string> targets;
  if (scenario->settings.targets) targets = *scenario->settings.targets;
  for (const std::string& model : models) {
    const std::string name = workspace::target_file(model).name;
    const auto same = std::ranges::find_if(targets, [&](const std::string& target) {
      return workspace::target_file(target).name == name;
    });
    if (same == targets.end())
      targets.push_back(model);
    else
      *same = model;
  }
  if (targets.empty()) {
    log.report_file(Code("E8013"), file, "the scenario names no model of a target",
                    "[targets] in the scenario, or NAME=FILE beside it");
    return failed;
  }
  scenario->settings.targets = targets;
  return Play{file, *std::move(scenario), *std::move(times), std::move(targets), {}};
}

Result<std::shared_ptr<const Moment>> moment_of(const Play& play, std::uint64_t number,
                                                const world::World& world,
                                                workspace::FrameMaker& maker, DiagnosticLog& log) {
  auto out = std::make_shared<Moment>();
  out->number = number;
  out->time = play.times[number];
  const auto frame = workspace::frame_at(play.scenario, out->time, log);
  if (!frame) return failed;
  auto view = workspace::view_of(play.scenario, *frame, number, world, log);
  if (!view) return failed;
  auto exposure = view->settings.exposure;
  if (!view->settings.ev->number && !exposure) exposure = workspace::Settings::Exposure::automatic;
  leave_out(*view);
  auto made = maker.frame(*view, log);
  if (!made) return failed;
  if (made->imager != nullptr) view->settings.exposure = made->settings.exposure = exposure;
  if (const auto& epoch = frame->epoch)
    out->date = scenario::epoch_text(scenario::later(*epoch, out->time), frame->system) + " " +
                std::string(scenario::time_system_name(frame->system));
  out->view = *std::move(view);
  out->frame = *std::move(made);
  return std::shared_ptr<const Moment>(std::move(out));
}

bool find_tracks(Play& play, const world::World& world, DiagnosticLog& log) {
  workspace::FrameMaker maker(world);
  workspace::check_stars(play.scenario, log);
  // also checks the lens, and the names of joints
  const auto first = moment_of(play, 0, world, maker, log);
  if (!first) return false;
  const bool made = bool((*first)->view.settings.camera_frame);
  std::map<std::string, Track> tracks;
  const std::uint64_t last = play.times.size() - 1,
                      steps = std::min(last, made ? kMadeSteps : kTrackSteps);
  const auto add = [&](const std::string& target, std::uint64_t number, const Vec3& point) {
    Track& track = tracks[target];
    track.target = target;
    track.numbers.push_back(number);
    track.points.push_back(point);
  };
  for (std::uint64_t k = 0; k <= steps; ++k) {
    const std::uint64_t number = steps == last ? k : k * last / steps;
    const auto frame = workspace::frame_at(play.scenario, play.times[number], log);
    if (!frame) return false;
    if (made) {
      const auto moment = moment_of(play, number, world, maker, log);
      if (!moment) return false;
      add({}, number, (*moment)->frame.camera().position);
    } else if (frame->camera.position) {
      add({}, number, *frame->camera.position);
    } else if (play.scenario.settings.camera) {
      add({}, number, *play.scenario.settings.camera);
    }
    for (const scenario::TargetState& target : frame->targets)
      if (target.placement.position && !target.name.empty())
        add(target.name, number, *target.placement.position);
  }
  play.tracks.clear();
  for (auto& each : tracks) {
    Track& track = each.second;
    const auto moves = [&](const Vec3& point) { return point != track.points.front(); };
    if (track.target.empty() || std::ranges::any_of(track.points, moves))
      play.tracks.push_back(std::move(track));
  }
  return true;
}

}  // namespace panwright::studio
