#include "workspace/scenario.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "base/text.h"
#include "workspace/orbit_text.h"
#include "workspace/sky_settings.h"

namespace panwright::workspace {

namespace {

// Times from `begin` in steps, without the sum of their roundings.
bool add_steps(double begin, double end, double step, std::vector<double>& times) {
  // what a quotient of seconds may be off
  constexpr double kSlack = 1e-9;
  const double count = std::floor((end - begin) / step + kSlack);
  if (!(count < static_cast<double>(kMostFrames))) return false;
  for (std::size_t k = 0; k <= static_cast<std::size_t>(count); ++k)
    times.push_back(std::min(begin + static_cast<double>(k) * step, end));
  return true;
}

}  // namespace

Result<std::vector<double>> frame_times(const Scenario& scenario, const FrameChoice& choice,
                                        DiagnosticLog& log) {
  const auto fail = [&](const std::string& message, const std::string& hint = {}) {
    log.report(Code("E0201"), {}, message, hint);
    return failed;
  };
  const scenario::Sequence& sequence = scenario.sequence;
  if (!choice.at.empty()) {
    if (sequence.ordered()) return fail("--at needs frames with times; these have an order alone");
    return choice.at;
  }
  std::vector<double> times;
  const auto step = choice.every ? choice.every : scenario.step;
  if (sequence.ordered()) {
    if (step) return fail("steps of time need frames with times; these have an order alone");
    for (std::size_t k = 0; k < sequence.frames(); ++k) times.push_back(static_cast<double>(k));
  } else {
    const std::vector<scenario::TimeSpan>& spans = sequence.spans();
    if (spans.empty()) return fail("the sources have no time in common");
    const scenario::TimeSpan whole{spans.front().begin, spans.back().end};
    const double begin = scenario.begin.value_or(whole.begin),
                 end = scenario.end.value_or(whole.end);
    if (step) {
      if (!std::isfinite(begin) || !std::isfinite(end))
        return fail("steps of time need a begin and an end", "begin and end in the scenario");
      if (!add_steps(begin, end, *step, times))
        return fail(fmt::format("more than {} frames", kMostFrames));
    } else {
      for (const double time : sequence.times())
        if (time >= begin && time <= end) times.push_back(time);
      if (sequence.times().empty())
        return fail("no times of frames are given", "--every SECONDS, or step in the scenario");
    }
  }
  if (times.size() > kMostFrames) return fail(fmt::format("more than {} frames", kMostFrames));
  if (choice.numbers) {
    const auto [first, last] = *choice.numbers;
    constexpr std::uint64_t kToTheEnd = ~std::uint64_t{0};
    if (first >= times.size() || (last != kToTheEnd && last >= times.size()))
      return fail(fmt::format("--frames asks for frame {}; there are {}, from 0",
                              first >= times.size() ? first : last,
                              counted(times.size(), "frame")));
    times.erase(times.begin() + static_cast<std::ptrdiff_t>(
                                    std::min<std::uint64_t>(last, times.size() - 1) + 1),
                times.end());
    times.erase(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(first));
  }
  if (times.empty()) return fail("there is no frame between begin and end");
  return times;
}

Result<scenario::Frame> frame_at(const Scenario& scenario, double time, DiagnosticLog& log) {
  if (scenario.sequence.ordered())
    return scenario.sequence.frame(static_cast<std::size_t>(time), log);
  return scenario.sequence.at(time, log);
}

namespace {

// The date of a frame and the orbit of its origin, where its sky depends on them.
bool set_date(const Scenario& scenario, const scenario::Frame& frame, Settings& own,
              DiagnosticLog& log) {
  const Settings& settings = scenario.settings;
  if (!uses_date(settings)) return true;
  std::optional<scenario::Epoch> begin = frame.epoch;
  std::string problem;
  if (!begin && settings.date)
    begin = scenario::parse_epoch(*settings.date, scenario::TimeSystem::utc, problem);
  if (!begin) return true;
  if (frame.time)
    own.date =
        scenario::epoch_text(scenario::later(*begin, *frame.time), scenario::TimeSystem::utc);
  const std::string& axes = scenario.sequence.axes();
  const std::string& centre = scenario.sequence.centre();
  const bool rotating = axes == scenario::kRtnFrame;
  const bool centred = centre == "EARTH" || centre == "MOON";
  const auto fail = [&](std::string message, const char* hint) {
    log.report_file(Code("E8009"), scenario.files.front(), std::move(message), hint);
    return false;
  };
  if (!rotating && !axes.empty() && !scenario::is_inertial_j2000(axes) &&
      (settings.orbit || needs_orbit(settings)))
    return fail(
        fmt::format("the sources have the axes {}; bodies by their date need those of J2000 "
                    "or ICRF",
                    in_quotes(axes)),
        "docs/sky-by-date.md");
  if (!settings.orbit) {
    if (rotating && !frame.sun_direction && shows_dated_sun(settings))
      return fail("the Sun of the date needs the orbit whose axes clohessy_wiltshire has",
                  "orbit in [view], or sun");
    if (centred && needs_orbit(settings)) own.orbit = centre == "EARTH" ? "earth" : "moon";
    return true;
  }
  scenario::Orbit orbit;
  if (!read_orbit(*settings.orbit, orbit).empty()) return true;  // check() reports it
  if (!centre.empty() && !(centred && orbit.at_centre &&
                           (orbit.about == scenario::Centre::earth) == (centre == "EARTH")))
    return fail(fmt::format("the sources have their origin in {}, and orbit gives it another place",
                            in_quotes(centre)),
                "leave out orbit, or give positions relative to it");
  const bool says_j2000 = settings.orbit->find("axes=j2000") != std::string::npos;
  if (rotating && (says_j2000 || orbit.at_centre))
    return fail("clohessy_wiltshire has axes that turn with its orbit",
                "orbit = \"a=… e=… i=… raan=… aop=… nu=… axes=rtn\"");
  if (!orbit.at_centre)
    own.orbit = completed_orbit(*settings.orbit, *begin, rotating ? "rtn" : "j2000");
  return true;
}

}  // namespace

void check_stars(const Scenario& scenario, DiagnosticLog& log) {
  if (scenario.sequence.axes() != scenario::kRtnFrame || scenario.settings.orbit ||
      !shows_stars(scenario.settings))
    return;
  log.report_file(Code("W8019"), scenario.files.front(),
                  "clohessy_wiltshire has axes that turn with its orbit, which is not given: stars "
                  "are drawn as if these were the axes of J2000",
                  "orbit = \"a=… e=… i=… raan=… aop=… nu=…\" in [view]");
}

Result<View> view_of(const Scenario& scenario, const scenario::Frame& frame, std::size_t number,
                     const world::World& world, DiagnosticLog& log) {
  Settings own;
  if (!frame.name.empty()) own.name = frame.name;
  if (frame.seed) own.seed = *frame.seed;
  own.frame_number = static_cast<std::uint32_t>(number);
  std::vector<PoseSetting> poses;
  std::vector<JointText> joints;
  for (const scenario::TargetState& target : frame.targets) {
    if (target.placement.position || target.placement.rotation)
      poses.push_back({target.name, target.placement.pose()});
    for (const scenario::JointValue& joint : target.joints) {
      const std::string name = target.name.empty() ? joint.joint : target.name + "/" + joint.joint;
      const auto place = find_joint(name, world, log);
      if (!place) return failed;
      const pan::Model& model = *world[place->target].model();
      joints.push_back(
          {name, exact_value(static_cast<geometry::JointKind>(model.joints()[place->joint].kind),
                             joint.values)});
    }
  }
  if (!poses.empty()) own.pose = std::move(poses);
  if (!joints.empty()) own.joint = std::move(joints);
  if (frame.camera.position) own.camera = *frame.camera.position;
  if (frame.camera.rotation) own.quat = *frame.camera.rotation;
  if (frame.lens.fov) own.fov = *frame.lens.fov;
  if (frame.lens.focal) {
    const ImageSize size = *scenario.settings.size;
    const Vec2 centre = frame.lens.principal.value_or(Vec2(size.width, size.height) / 2.0);
    own.intrinsics = Vec4(*frame.lens.focal, centre);
  }
  if (frame.sun_direction) own.sun = *frame.sun_direction;
  if (!set_date(scenario, frame, own, log)) return failed;
  if (frame.sun_distance) own.sun_distance = *frame.sun_distance;
  View view(with_defaults(std::move(own), scenario.settings));
  view.label = frame.name.empty() ? fmt::format("frame {}", number)
                                  : fmt::format("frame {} ('{}')", number, frame.name);
  view.file = scenario.files.front();
  if (frame.time && !scenario.sequence.ordered())
    view.motion = [&scenario, &world, number, time = *frame.time](
                      double seconds, DiagnosticLog& reports) -> std::optional<Settings> {
      const auto then = frame_at(scenario, time + seconds, reports);
      if (!then) return std::nullopt;
      const auto seen = view_of(scenario, *then, number, world, reports);
      if (!seen) return std::nullopt;
      return seen->settings;
    };
  return view;
}

}  // namespace panwright::workspace
