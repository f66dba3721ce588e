// Exposures of frames: moments in which the image moves, and lamps with pulses.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/text.h"
#include "workspace/frame.h"
#include "workspace/internal/forward.h"
#include "workspace/internal/image_motion.h"
#include "world/lamps.h"

namespace panwright::workspace {

namespace {

// With a detector's own time, where the frame is one of a sequence.
Shutter shutter_of(const View& view, const Frame& frame) {
  const Settings& settings = frame.settings;
  const bool own = frame.imager != nullptr && settings.exposure->number == 0.0 &&
                   !frame.imager->auto_exposure && view.motion;
  return {own ? frame.imager->detector.exposure_s : settings.exposure->number.value_or(0),
          *settings.line_time, frame.camera().height, static_cast<std::uint32_t>(*settings.tdi)};
}

// Exposures of frames without a before and an after: those of detectors.
bool stands_still(const Frame& frame, const Shutter& shutter, DiagnosticLog& log) {
  if (frame.imager != nullptr && shutter.line_time == 0 && shutter.stages == 0) return true;
  const SettingId id = shutter.exposure != 0 ? SettingId::exposure : SettingId::line_time;
  log.report(Code("E0201"), {},
             fmt::format("--{} is {}, expected 0 where nothing is known of other times",
                         info_of(id).name, in_quotes(setting_text(id, frame.settings))),
             "scenarios with times have a before and an after (`panwright run`); a camera file "
             "with a [detector] exposes what stands still");
  return false;
}

}  // namespace

// Adds the moments of an exposure over time, if the image moves in it.
bool FrameMaker::expose(const View& view, Frame& frame, DiagnosticLog& log) {
  const Settings& settings = frame.settings;
  const Shutter shutter = shutter_of(view, frame);
  if (shutter.stages > 0 && shutter.line_time == 0) {
    log.report(Code("E0201"), {}, "--tdi needs --line-time: rows are exposed one after the other");
    return false;
  }
  if (shutter.instant()) return true;
  if (!view.motion) return stands_still(frame, shutter, log);
  if (DiagnosticLog ignored;
      settings.exposure->number == 0.0 && *settings.line_time == 0 &&
      !(view.motion(shutter.begin(), ignored) && view.motion(shutter.end(), ignored)))
    return true;  // a detector's own time, at an end of the sequence
  const bool placed = settings.camera || settings.look_at || settings.quat || settings.camera_frame;
  const auto moment_at = [&](double seconds) -> std::optional<Moment> {
    DiagnosticLog apart = log.apart();
    View then;
    if (auto at = view.motion(seconds, apart)) {
      then.settings = *std::move(at);
      if (const auto made = at_once(then, apart)) {
        const world::Camera& camera = placed ? made->camera() : frame.camera();
        return Moment{static_cast<const WorldState&>(*made), camera.position,
                      camera.world_from_camera};
      }
    }
    // what is a little after the end may be unknown
    if (seconds <= shutter.end()) forward(apart, {}, {}, log);
    return std::nullopt;
  };
  // speed of the image, measured at times so close that it moves little in between
  constexpr std::size_t kLeastTimes = 4, kMostTimes = 64;
  constexpr double kLittle = 4;  // pixels
  const double length = shutter.end() - shutter.begin();
  double speed = 0;
  for (std::size_t times = kLeastTimes; times <= kMostTimes; times *= 4) {
    ImageMotion motion(world_);
    double most = 0;
    for (std::size_t k = 0; k <= times; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(times);
      const auto moment = moment_at(shutter.begin() + share * length);
      if (!moment) return false;
      world::Camera camera = frame.camera();
      camera.position = moment->position;
      camera.world_from_camera = moment->world_from_camera;
      most = std::max(most, motion.add(*moment, camera));
    }
    speed = most * static_cast<double>(times) / length;
    if (most <= kLittle) break;
  }
  constexpr double kStep = 0.5, kDraftStep = 1;  // pixels
  const double step = *settings.quality == Settings::Quality::draft ? kDraftStep : kStep;
  std::vector<double> cuts;
  for (const world::Lamp& lamp : *frame.lamps)
    if (lamp.on && lamp.pulse) cuts.insert(cuts.end(), {lamp.pulse->begin, lamp.pulse->end});
  const ShutterMoments moments(shutter, speed, step, cuts);
  if (moments.count() == 1 && !moments.is_scanner()) return true;
  if (moments.count() > ShutterMoments::kMostOfScanner) {
    log.report(
        Code("E0201"), {},
        fmt::format("--tdi of {} stages and an image of {} rows are {} moments, expected at "
                    "most {}",
                    shutter.stages, shutter.rows, moments.count(), ShutterMoments::kMostOfScanner));
    return false;
  }
  constexpr double kMuchMore = 1.01;
  if (moments.step() > kMuchMore * step)
    log.report_file(Code("W5008"), {},
                    fmt::format("the image moves by {:.3g} pixels between {} moments of its "
                                "exposure, expected at most {} pixels",
                                moments.step(), moments.count(), step));
  for (std::size_t k = 0; k < moments.count(); ++k) {
    auto moment = moment_at(moments.time(k));
    if (!moment && moments.time(k) > shutter.end()) moment = moment_at(shutter.end());
    if (!moment) return false;
    frame.moments.push_back(*std::move(moment));
  }
  frame.shutter = moments;
  return true;
}

// Lamps with pulses, as the image and its moments have them.
bool FrameMaker::switch_lamps(const View& view, Frame& frame, DiagnosticLog& log) {
  const auto pulsed = [](const world::Lamp& lamp) { return lamp.on && lamp.pulse.has_value(); };
  if (!frame.lamps || std::ranges::none_of(*frame.lamps, pulsed)) return true;
  Shutter shutter = shutter_of(view, frame);
  if (frame.imager != nullptr && shutter.exposure == 0) {
    if (frame.imager->auto_exposure || !frame.settings.exposure->number) {
      log.report(Code("E0201"), {},
                 "a lamp has a pulse, and the detector finds its exposure time by the image, "
                 "expected one in seconds",
                 "--exposure SECONDS");
      return false;
    }
    shutter.exposure = frame.imager->detector.exposure_s;
  }
  for (const world::Lamp& lamp : *frame.lamps)
    if (pulsed(lamp) && (shutter.end() < lamp.pulse->begin || shutter.begin() >= lamp.pulse->end))
      log.report_file(
          Code("W5019"), {},
          fmt::format("a lamp is dark: its pulse, {:.6g} to {:.6g} s, lies outside of "
                      "the exposure, {:.6g} to {:.6g} s after the frame's time",
                      lamp.pulse->begin, lamp.pulse->end, shutter.begin() + 0.0, shutter.end()));
  for (std::size_t k = 0; k < frame.moments.size(); ++k) {
    auto& lamps = frame.moments[k].lamps;
    lamps = world::lamps_during(*std::move(lamps), frame.shutter->begin(k), frame.shutter->end(k));
  }
  frame.lamps =
      world::lamps_during(*std::move(frame.lamps), -0.5 * shutter.exposure, 0.5 * shutter.exposure);
  return true;
}

}  // namespace panwright::workspace
